#include "core/render/visible.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

const uint8_t visible_background[3] = { 0x08, 0x09, 0x0b };

/* ---- surfaces ------------------------------------------------------------------------------------------------------------- */

enum surface_algorithm visible_algorithm(const struct snapshot *snapshot)
{
    return snapshot->scene.surface.algorithm == SCENE_ALGORITHM_EIGHT_CELL ? SURFACE_EIGHT_CELL : SURFACE_MARCHING_CUBES;
}

static double nearest_mm(const struct camera *camera, const struct box3 *box)
{
    if (camera->is_parallel) {
        struct vec3 f = camera->forward;
        struct vec3 corner = vec3(f.x > 0 ? box->low.x : box->high.x, f.y > 0 ? box->low.y : box->high.y, f.z > 0 ? box->low.z : box->high.z);
        return vec3_dot(vec3_sub(corner, camera->eye_lps_mm), f);
    }
    struct vec3 e = camera->eye_lps_mm;
    struct vec3 p = vec3(fmin(fmax(e.x, box->low.x), box->high.x), fmin(fmax(e.y, box->low.y), box->high.y),
                         fmin(fmax(e.z, box->low.z), box->high.z));
    return vec3_length(vec3_sub(p, e));
}

/* Nearest depth of a box along the line of sight: beyond near, nothing of it is cut away. */
static bool is_wholly_ahead(const struct camera *camera, const struct box3 *box)
{
    struct vec3 f = camera->forward;
    struct vec3 corner = vec3(f.x > 0 ? box->low.x : box->high.x, f.y > 0 ? box->low.y : box->high.y, f.z > 0 ? box->low.z : box->high.z);
    return vec3_dot(vec3_sub(corner, camera->eye_lps_mm), f) > camera->near_mm;
}

/* Whether a box lies beyond one side of what is drawn. */
static bool is_out_of_sight(const struct mat4 *clip_from_lps_mm, const struct box3 *box)
{
    const double *m = clip_from_lps_mm->m;
    int n_beyond[6] = { 0 };
    for (int corner = 0; corner < 8; corner++) {
        double x = corner & 1 ? box->high.x : box->low.x, y = corner & 2 ? box->high.y : box->low.y, z = corner & 4 ? box->high.z : box->low.z;
        double clip[4];
        for (int row = 0; row < 4; row++)
            clip[row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
        for (int axis = 0; axis < 3; axis++) {
            n_beyond[2 * axis] += clip[axis] < -clip[3];
            n_beyond[2 * axis + 1] += clip[axis] > clip[3];
        }
    }
    for (int side = 0; side < 6; side++)
        if (n_beyond[side] == 8)
            return true;
    return false;
}

static bool is_shown(const struct snapshot *snapshot, size_t region)
{
    return snapshot->styles[region].visible && snapshot->styles[region].opacity > 0;
}

static bool is_drawn(const struct snapshot *snapshot, size_t region)
{
    return is_shown(snapshot, region) && snapshot->plan->regions.regions[region].n_voxels > 0;
}

size_t visible_n_translucent(const struct snapshot *snapshot)
{
    size_t n = 0;
    for (size_t i = 0; i < snapshot->plan->regions.n_regions; i++)
        n += is_drawn(snapshot, i) && snapshot->styles[i].opacity < 1;
    return n;
}

/* A region inside an opaque one, in the same label layer, cannot be seen: the outer surface is closed and encloses it. Unless the
 * eye is within the outer one's box, or the near plane cuts it open. False on failure. */
static bool find_hidden(const struct snapshot *snapshot, const struct camera *camera, size_t region, visible_bounds *bounds, void *context,
                        bool *is_hidden, struct error *err)
{
    const struct region *regions = snapshot->plan->regions.regions;
    *is_hidden = false;
    for (int outer = regions[region].parent; outer >= 0 && !*is_hidden; outer = regions[outer].parent) {
        if (!is_drawn(snapshot, (size_t)outer) || snapshot->styles[outer].opacity < 1 || regions[outer].layer != regions[region].layer)
            continue;
        const struct box3 *box = bounds(context, (size_t)outer, err);
        if (!box)
            return false;
        *is_hidden = !box3_is_empty(box) && is_wholly_ahead(camera, box);
    }
    return true;
}

/* As visible_surfaces says. What encloses another is never farther away, so at equal distances the inner one comes first. */
static int compare_back_to_front(const void *left, const void *right)
{
    const struct visible_surface *a = left, *b = right;
    if (a->order != b->order)
        return a->order < b->order ? -1 : 1;
    if (a->distance_mm != b->distance_mm)
        return a->distance_mm > b->distance_mm ? -1 : 1;
    if (a->depth != b->depth)
        return a->depth > b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels < b->n_voxels ? -1 : 1;
    return a->style < b->style ? -1 : a->style > b->style;
}

struct visible_surface *visible_surfaces(const struct snapshot *snapshot, const struct camera *camera, const struct mat4 *clip_from_lps_mm,
                                         bool is_opaque, visible_bounds *bounds, void *context, size_t *n, struct error *err)
{
    const struct region_set *set = &snapshot->plan->regions;
    struct visible_surface *surfaces = mem_array(set->n_regions, sizeof *surfaces, UINT64_MAX, err);
    *n = 0;
    for (size_t i = 0; surfaces && i < set->n_regions; i++) {
        bool is_hidden = false;
        if (!is_drawn(snapshot, i) || (snapshot->styles[i].opacity >= 1) != is_opaque)
            continue;
        bool is_good = find_hidden(snapshot, camera, i, bounds, context, &is_hidden, err);
        if (is_good && is_hidden)
            continue;
        const struct box3 *box = is_good ? bounds(context, i, err) : NULL;
        if (!box) {
            free(surfaces);
            return NULL;
        }
        if (!box3_is_empty(box) && !is_out_of_sight(clip_from_lps_mm, box))
            surfaces[(*n)++] = (struct visible_surface){ i, &snapshot->styles[i], nearest_mm(camera, box),
                                                         (int)snapshot->styles[i].order, region_depth(set, i),
                                                         set->regions[i].n_voxels };
    }
    if (surfaces)
        qsort(surfaces, *n, sizeof *surfaces, compare_back_to_front);
    return surfaces;
}

/* ---- cross-sections ------------------------------------------------------------------------------------------------------- */

size_t visible_palette(const struct snapshot *snapshot, size_t layer, uint8_t (*colors)[4])
{
    const struct region_set *set = &snapshot->plan->regions;
    size_t n = 0;
    memset(colors, 0, VISIBLE_N_LABELS * sizeof *colors);
    for (size_t i = 0; i < set->n_regions; i++) {
        int shown = (int)i;
        while (shown >= 0 && !is_shown(snapshot, (size_t)shown))
            shown = set->regions[shown].parent;
        if (set->regions[i].layer != layer || shown < 0)
            continue;
        uint32_t rgb = snapshot->styles[shown].color_rgb;
        uint8_t *color = colors[set->regions[i].label];
        color[0] = (uint8_t)(rgb >> 16);
        color[1] = (uint8_t)(rgb >> 8);
        color[2] = (uint8_t)rgb;
        color[3] = 255;
        n++;
    }
    return n;
}

static int outermost_depth(const struct region_set *set, size_t layer)
{
    int depth = INT32_MAX;
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].layer == layer && region_depth(set, i) < depth)
            depth = region_depth(set, i);
    return depth;
}

void visible_layers(const struct region_set *set, size_t layers[REGION_MAX_LAYERS])
{
    int depths[REGION_MAX_LAYERS];
    for (size_t layer = 0; layer < set->n_layers; layer++) { /* insertion sort, stable */
        int depth = outermost_depth(set, layer);
        size_t at = layer;
        for (; at > 0 && depths[at - 1] > depth; at--) {
            depths[at] = depths[at - 1];
            layers[at] = layers[at - 1];
        }
        depths[at] = depth;
        layers[at] = layer;
    }
}

int visible_samples(const struct snapshot *snapshot, const struct camera *camera, int width_px, bool is_still)
{
    enum { STILL_SAMPLES = 2 };
    if (!is_still)
        return 1;
    if (snapshot->view.kind == SCENE_KIND_3D || snapshot->image < 0)
        return STILL_SAMPLES;
    struct vec3 spacing_mm = grid_spacing_mm(&snapshot->plan->images[snapshot->image].volume->grid);
    double pixels_per_mm = camera->pixels_per_mm * width_px / snapshot->view.size_px[0];
    return fmin(fmin(spacing_mm.x, spacing_mm.y), spacing_mm.z) * pixels_per_mm < 1 ? STILL_SAMPLES : 1;
}
