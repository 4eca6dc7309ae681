/* Lines where a plane cuts regions, meshes and grids. */
#include "core/render/visible/cut.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum { N_LABELS = 65536, MAX_SIDE = 2048 };

void cut_lines_finish(struct cut_lines *lines)
{
    free(lines->ends_lps_mm);
    *lines = (struct cut_lines){ 0 };
}

bool cut_lines_add(struct cut_lines *lines, struct vec3 a, struct vec3 b, struct error *err)
{
    if (lines->n == lines->capacity) {
        size_t capacity = 2 * lines->capacity + 256;
        double(*grown)[2][3] = realloc(lines->ends_lps_mm, capacity * sizeof *grown);
        if (!grown)
            return error_set(err, ERROR_MEMORY, "no memory for %zu lines on a slice", capacity);
        lines->ends_lps_mm = grown;
        lines->capacity = capacity;
    }
    const double ends[2][3] = { { a.x, a.y, a.z }, { b.x, b.y, b.z } };
    memcpy(lines->ends_lps_mm[lines->n++], ends, sizeof ends);
    return true;
}

/* ---- univels ---------------------------------------------------------------------------------------------------- */

static bool is_same_grid(const struct grid *a, const struct grid *b)
{
    return memcmp(a->size, b->size, sizeof a->size) == 0 &&
           memcmp(&a->lps_mm_from_ijk, &b->lps_mm_from_ijk, sizeof a->lps_mm_from_ijk) == 0;
}

static void add_bounds(struct box3 *box, const struct region *region, const struct grid *grid)
{
    for (int corner = 0; region->n_voxels > 0 && corner < 8; corner++)
        box3_add(box, affine_point(&grid->lps_mm_from_ijk,
                                   vec3(corner & 1 ? region->high_ijk[0] + 0.5 : region->low_ijk[0] - 0.5,
                                        corner & 2 ? region->high_ijk[1] + 0.5 : region->low_ijk[1] - 0.5,
                                        corner & 4 ? region->high_ijk[2] + 0.5 : region->low_ijk[2] - 0.5)));
}

bool cut_region_init(struct cut_region *cut, const struct region_set *set, size_t region, struct error *err)
{
    size_t *inside = mem_array(set->n_regions, sizeof *inside, UINT64_MAX, err);
    size_t n = inside ? region_with_descendants(set, region, inside) : 0;
    *cut = (struct cut_region){ .grid = &set->layers[set->regions[region].layer]->grid, .bounds_lps_mm = box3_empty() };
    cut->parts = inside ? mem_array(n, sizeof *cut->parts, UINT64_MAX, err) : NULL;
    bool is_good = cut->parts != NULL;
    for (size_t i = 0; is_good && i < n; i++) {
        const struct region *one = &set->regions[inside[i]];
        const struct volume *layer = set->layers[one->layer];
        size_t part = 0;
        if (!is_same_grid(&layer->grid,
                          cut->grid)) /* left out as in mask_from_region: its voxels lie inside the region's own */
            continue;
        while (part < cut->n_parts && cut->parts[part].layer != layer)
            part++;
        if (part == cut->n_parts) {
            cut->parts[part].layer = layer;
            cut->parts[part].is_inside = mem_array(N_LABELS, 1, UINT64_MAX, err);
            is_good = cut->parts[part].is_inside != NULL;
            if (!is_good)
                break;
            memset(cut->parts[part].is_inside, 0, N_LABELS);
            cut->n_parts++;
        }
        cut->parts[part].is_inside[one->label] = 1;
        add_bounds(&cut->bounds_lps_mm, one, cut->grid);
    }
    free(inside);
    if (!is_good)
        cut_region_finish(cut);
    return is_good;
}

void cut_region_finish(struct cut_region *cut)
{
    for (size_t i = 0; i < cut->n_parts; i++)
        free(cut->parts[i].is_inside);
    free(cut->parts);
    *cut = (struct cut_region){ 0 };
}

bool cut_region_holds(const struct cut_region *cut, struct vec3 point_lps_mm)
{
    uint32_t ijk[3];
    if (cut->n_parts == 0 ||
        !volume_voxel_at(cut->parts[0].layer, point_lps_mm, ijk)) /* all parts have the same grid */
        return false;
    for (size_t i = 0; i < cut->n_parts; i++)
        if (cut->parts[i].is_inside[volume_label(cut->parts[i].layer, ijk[0], ijk[1], ijk[2])])
            return true;
    return false;
}

/* True if the plane is one of the grid's own slices, that is if two of the grid's axes lie in it. index_axis: the
 * third. */
static bool find_slice_axis(const struct grid *grid, const struct plane *plane, int *index_axis)
{
    int n_in_plane = 0;
    for (int i = 0; i < 3; i++) {
        struct vec3 column = grid->lps_mm_from_ijk.columns[i];
        if (fabs(vec3_dot(column, plane->normal)) < 1e-6 * vec3_length(column))
            n_in_plane++;
        else
            *index_axis = i;
    }
    return n_in_plane == 2;
}

/* The pixels of the plane over the whole grid; columns[2] of the map is across the plane. False: the plane misses it.
 */
static bool pixel_map(const struct grid *grid, const struct plane *plane, struct affine *map, uint32_t size[2])
{
    int axis = 0;
    struct box3 box = grid_bounds_lps_mm(grid);
    struct plane upright = plane_upright(plane);
    struct plane_reach reach = plane_reach(&upright, &box);
    if (!plane_meets(&reach))
        return false;
    if (find_slice_axis(grid, plane, &axis)) {
        int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
        const struct affine *lps = &grid->lps_mm_from_ijk;
        double index = -plane_height_mm(plane, lps->origin) / vec3_dot(lps->columns[axis], plane->normal);
        *map = (struct affine){ { lps->columns[a], lps->columns[b], lps->columns[axis] },
                                vec3_add(lps->origin, vec3_scale(lps->columns[axis], index)) };
        size[0] = grid->size[a];
        size[1] = grid->size[b];
        return true;
    }
    struct vec3 spacing = grid_spacing_mm(grid);
    double extent[2] = { reach.high_right_mm - reach.low_right_mm, reach.high_up_mm - reach.low_up_mm };
    double side = fmax(fmin(fmin(spacing.x, spacing.y), spacing.z), fmax(extent[0], extent[1]) / MAX_SIDE);
    size[0] = (uint32_t)fmax(1, ceil(extent[0] / side));
    size[1] = (uint32_t)fmax(1, ceil(extent[1] / side));
    *map = (struct affine){ { vec3_scale(upright.right, side), vec3_scale(upright.up, side),
                              vec3_scale(upright.normal, side) },
                            plane_point(&upright, reach.low_right_mm + side / 2, reach.low_up_mm + side / 2) };
    return true;
}

/* Sets the bits of pixels first_u .. end_u - 1 of row v that hold univels. index: grid index from pixel. */
static void cut_row(const struct cut_region *cut, const struct affine *index, uint32_t v, uint32_t first_u,
                    uint32_t end_u, uint64_t *bits)
{
    struct vec3 step = index->columns[0], first = affine_point(index, vec3(0, v, 0));
    const uint32_t *size = cut->grid->size;
    for (uint32_t u = first_u; u < end_u; u++) {
        double i = floor(first.x + step.x * u + 0.5), j = floor(first.y + step.y * u + 0.5),
               k = floor(first.z + step.z * u + 0.5);
        if (!(i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2]))
            continue;
        bool is_inside = false;
        for (size_t part = 0; part < cut->n_parts; part++)
            is_inside |=
                cut->parts[part].is_inside[volume_label(cut->parts[part].layer, (uint32_t)i, (uint32_t)j, (uint32_t)k)];
        bits[u / 64] |= (uint64_t)is_inside << u % 64;
    }
}

/* The pixels that the region's box covers, and one more on each side. Most regions are much smaller than the grid. */
static void find_pixels(const struct cut_region *cut, const struct affine *map, const uint32_t size[2],
                        uint32_t first[2], uint32_t end[2])
{
    const struct box3 *box = &cut->bounds_lps_mm;
    struct affine pixel;
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
    bool is_inverted = affine_invert(map, &pixel);
    assert(is_inverted); /* its columns are a grid's axes, or at right angles */
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 p =
            affine_point(&pixel, vec3(corner & 1 ? box->high.x : box->low.x, corner & 2 ? box->high.y : box->low.y,
                                      corner & 4 ? box->high.z : box->low.z));
        const double at[2] = { p.x, p.y };
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
    for (int i = 0; i < 2; i++) {
        first[i] = (uint32_t)fmin(fmax(floor(low[i]) - 1, 0), size[i]);
        end[i] = (uint32_t)fmin(fmax(ceil(high[i]) + 2, 0), size[i]);
    }
}

bool cut_univels(const struct cut_region *cut, const struct plane *plane, struct mask **mask, struct error *err)
{
    struct affine map;
    uint32_t size[3] = { 0, 0, 1 };
    *mask = NULL;
    if (box3_is_empty(&cut->bounds_lps_mm))
        return true;
    struct plane_reach reach = plane_reach(plane, &cut->bounds_lps_mm);
    if (!plane_meets(&reach) || !pixel_map(cut->grid, plane, &map, size))
        return true;
    struct mask *made = mask_create(size, &map, err);
    if (!made)
        return false;
    memset(made->bits, 0, (size_t)made->words * size[1] * sizeof *made->bits);
    struct affine index = affine_compose(&cut->grid->ijk_from_lps_mm, &map);
    uint32_t first[2], end[2];
    find_pixels(cut, &map, size, first, end);
    for (uint32_t v = first[1]; v < end[1]; v++)
        cut_row(cut, &index, v, first[0], end[0], made->bits + (size_t)v * made->words);
    *mask = made;
    return true;
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

static bool add_diamond(struct cut_lines *lines, const struct affine *map, struct vec3 at, struct error *err)
{
    static const double corner[5][2] = { { 0.25, 0 }, { 0, 0.25 }, { -0.25, 0 }, { 0, -0.25 }, { 0.25, 0 } };
    for (int i = 0; i < 4; i++)
        if (!cut_lines_add(lines, affine_point(map, vec3(at.x + corner[i][0], at.y + corner[i][1], 0)),
                           affine_point(map, vec3(at.x + corner[i + 1][0], at.y + corner[i + 1][1], 0)), err))
            return false;
    return true;
}

static struct vec3 walk_point(const struct outline_set *set, uint32_t at)
{
    const float *p = &set->points_ijk[3 * (size_t)set->walk[at]];
    return vec3((double)p[0], (double)p[1], 0);
}

bool cut_outlines(const struct mask *slice, enum outline_method method, struct cut_lines *lines, struct error *err)
{
    struct outline_set *set = outline_slice(slice, 2, 0, method, err);
    bool is_good = set != NULL;
    for (size_t l = 0; is_good && l < set->n_lines; l++) {
        uint32_t first = set->line[l], end = set->line[l + 1];
        if (end - first == 1)
            is_good = add_diamond(lines, &slice->lps_mm_from_ijk, walk_point(set, first), err);
        for (uint32_t i = first; is_good && end - first > 1 && i < end; i++)
            is_good =
                cut_lines_add(lines, affine_point(&slice->lps_mm_from_ijk, walk_point(set, i)),
                              affine_point(&slice->lps_mm_from_ijk, walk_point(set, i + 1 < end ? i + 1 : first)), err);
    }
    outline_set_destroy(set);
    return is_good;
}

static bool has_pixel(const struct mask *slice, int64_t u, int64_t v)
{
    if (u < 0 || v < 0 || u >= slice->size[0] || v >= slice->size[1])
        return false;
    return slice->bits[(size_t)v * slice->words + (size_t)u / 64] >> u % 64 & 1;
}

bool cut_borders(const struct mask *slice, struct cut_lines *lines, struct error *err)
{
    const struct affine *map = &slice->lps_mm_from_ijk;
    for (int64_t v = 0; v <= slice->size[1]; v++)
        for (int64_t u = 0; u <= slice->size[0]; u++) {
            double left = (double)u - 0.5, low = (double)v - 0.5;
            bool is_inside = has_pixel(slice, u, v);
            if (is_inside != has_pixel(slice, u - 1, v) &&
                !cut_lines_add(lines, affine_point(map, vec3(left, low, 0)), affine_point(map, vec3(left, low + 1, 0)),
                               err))
                return false;
            if (is_inside != has_pixel(slice, u, v - 1) &&
                !cut_lines_add(lines, affine_point(map, vec3(left, low, 0)), affine_point(map, vec3(left + 1, low, 0)),
                               err))
                return false;
        }
    return true;
}

/* A corner of a polygon, and its position along the plane's normal: above the plane if that is at least the plane's. */
struct corner {
    struct vec3 lps_mm;
    double position_mm;
};

static struct vec3 meet(const struct corner *below, const struct corner *above, double position_mm)
{
    return cut_between(below->lps_mm, above->lps_mm, cut_share(below->position_mm, above->position_mm, position_mm));
}

/* Adds the segment where the plane cuts a convex polygon of n corners, if it does. */
static bool cut_polygon(const struct corner *corners, int n, double position_mm, struct cut_lines *lines,
                        struct error *err)
{
    struct vec3 found[2];
    int n_found = 0;
    for (int i = 0; i < n && n_found < 2; i++) {
        const struct corner *a = &corners[i], *b = &corners[(i + 1) % n];
        bool is_a_above = a->position_mm >= position_mm, is_b_above = b->position_mm >= position_mm;
        if (is_a_above != is_b_above)
            found[n_found++] = is_a_above ? meet(b, a, position_mm) : meet(a, b, position_mm);
    }
    return n_found < 2 || cut_lines_add(lines, found[0], found[1], err);
}

/* The axis of a normal along an axis of the patient; -1: it is oblique. */
static int axis_of(const float normal[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (fabsf(normal[axis]) == 1 && normal[(axis + 1) % 3] == 0 && normal[(axis + 2) % 3] == 0)
            return axis;
    return -1;
}

struct cut_plane cut_plane(const struct plane *plane)
{
    return (struct cut_plane){ { (float)plane->normal.x, (float)plane->normal.y, (float)plane->normal.z },
                               (float)plane_position_mm(plane) };
}

int cut_axis(const struct plane *plane)
{
    return axis_of(cut_plane(plane).normal);
}

/* Adds the segment of one triangle. at: of its corners along the normal. */
static bool cut_triangle(const float *const p[3], const float at[3], float position, struct cut_lines *lines,
                         struct error *err)
{
    bool above[3] = { at[0] >= position, at[1] >= position, at[2] >= position };
    if (above[0] == above[1] && above[1] == above[2])
        return true;
    struct corner corners[3];
    for (int c = 0; c < 3; c++)
        corners[c] = (struct corner){ vec3((double)p[c][0], (double)p[c][1], (double)p[c][2]), (double)at[c] };
    return cut_polygon(corners, 3, (double)position, lines, err);
}

/* Cuts along a plane across a patient axis: one coordinate decides, and slabs leave out most triangles. */
static bool cut_across(const struct mesh *mesh, const struct mesh_slabs *slabs, const struct cut_plane *plane, int axis,
                       struct cut_lines *lines, struct error *err)
{
    const float sign = plane->normal[axis];
    size_t first = 0, end = mesh->n_triangles;
    if (slabs) /* along the axis itself, also if the normal is its opposite */
        mesh_slabs_find(slabs, sign * plane->position, &first, &end);
    for (size_t i = first; i < end; i++) {
        const uint32_t *corners = &mesh->indices[3 * (slabs ? slabs->triangles[i] : i)];
        const float *p[3];
        float at[3];
        for (int c = 0; c < 3; c++) {
            p[c] = &mesh->positions_lps_mm[3 * (size_t)corners[c]];
            at[c] = sign * p[c][axis];
        }
        if (!cut_triangle(p, at, plane->position, lines, err))
            return false;
    }
    return true;
}

/* Each vertex belongs to six triangles: their positions along the normal are computed once. */
static bool cut_obliquely(const struct mesh *mesh, const struct cut_plane *plane, struct cut_lines *lines,
                          struct error *err)
{
    const float *positions = mesh->positions_lps_mm;
    float *at = mem_array(mesh->n_vertices, sizeof *at, UINT64_MAX, err);
    bool is_good = at != NULL;
    for (size_t v = 0; is_good && v < mesh->n_vertices; v++)
        at[v] = cut_position(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2], plane->normal);
    const float position = plane->position;
    for (size_t t = 0; is_good && t < mesh->n_triangles; t++) {
        const uint32_t *corners = &mesh->indices[3 * t];
        const float a = at[corners[0]], b = at[corners[1]], c = at[corners[2]];
        if (((a >= position) + (b >= position) + (c >= position)) % 3 == 0)
            continue;
        const float *p[3] = { positions + 3 * (size_t)corners[0], positions + 3 * (size_t)corners[1],
                              positions + 3 * (size_t)corners[2] };
        is_good = cut_triangle(p, (const float[3]){ a, b, c }, position, lines, err);
    }
    free(at);
    return is_good;
}

bool cut_mesh(const struct mesh *mesh, const struct mesh_slabs *slabs, const struct plane *plane,
              struct cut_lines *lines, struct error *err)
{
    const struct cut_plane cut = cut_plane(plane);
    const int axis = axis_of(cut.normal);
    return axis >= 0 ? cut_across(mesh, slabs, &cut, axis, lines, err) : cut_obliquely(mesh, &cut, lines, err);
}

void cut_grid_corners(const struct grid *grid, struct vec3 corners_lps_mm[8])
{
    for (int corner = 0; corner < 8; corner++)
        corners_lps_mm[corner] = affine_point(&grid->lps_mm_from_ijk, vec3(corner & 1 ? grid->size[0] - 0.5 : -0.5,
                                                                           corner & 2 ? grid->size[1] - 0.5 : -0.5,
                                                                           corner & 4 ? grid->size[2] - 0.5 : -0.5));
}

bool cut_grid(const struct grid *grid, const struct plane *plane, struct cut_lines *lines, struct error *err)
{
    static const int faces[6][4] = { { 0, 2, 6, 4 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
                                     { 2, 3, 7, 6 }, { 0, 1, 3, 2 }, { 4, 5, 7, 6 } };
    struct vec3 corners[8];
    cut_grid_corners(grid, corners);
    for (int face = 0; face < 6; face++) {
        struct corner quad[4];
        for (int i = 0; i < 4; i++) {
            struct vec3 p = corners[faces[face][i]];
            quad[i] = (struct corner){ p, vec3_dot(p, plane->normal) };
        }
        if (!cut_polygon(quad, 4, plane_position_mm(plane), lines, err))
            return false;
    }
    return true;
}
