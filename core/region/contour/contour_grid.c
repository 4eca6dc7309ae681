/* Chooses the label grid of each contour set: accuracy of the volume, subdivision of the image's grid, grids shared by
 * several sets. */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/contour/contour_raster.h"
#include "core/region/contour/contour_reach.h"

#define LARGE_CM3 1.0
#define LARGE_ACCURACY 0.01
#define SMALL_ACCURACY 0.05
#define PLANE_GRID_MM 1.0 /* in-plane voxel size without an image */
enum { MOST_SEARCH_ROWS = 4000000, SHARED_VOXELS = 8 << 20 };

/* Properties of one set while grids are chosen. */
struct candidate {
    uint32_t low[3], high[3]; /* box around it in voxels of the base grid, one more on each side; low <= index < high */
    size_t n_voxels;          /* voxels of the grid cropped to it, unless it is on the image's own grid */
    bool is_outside;          /* its contours leave the base grid */
};

static double accuracy_of(double cm3)
{
    return cm3 >= LARGE_CM3 ? LARGE_ACCURACY : SMALL_ACCURACY;
}

double contour_usual_spacing_mm(const struct contour_set *sets, size_t n_sets, const struct grid *image)
{
    enum { MOST_KINDS = 64 };
    struct {
        double mm;
        size_t n_planes;
    } kinds[MOST_KINDS], best = { 0, 0 };
    size_t n_kinds = 0;
    double along_mm = 0;
    for (size_t i = 0; i < n_sets; i++) {
        struct contour_planes planes;
        if (!contour_planes_init(&planes, &sets[i], 0, image, NULL))
            continue;
        if (image && planes.n_planes > 0 && along_mm == 0)
            along_mm = contour_grid_spacing_mm(image, planes.normal_lps);
        size_t kind = 0;
        while (kind < n_kinds && fabs(kinds[kind].mm - planes.facts.spacing_mm) > 0.01 * planes.facts.spacing_mm)
            kind++;
        if (planes.n_planes >= 2 && kind < MOST_KINDS) {
            if (kind == n_kinds) {
                kinds[n_kinds].mm = planes.facts.spacing_mm;
                kinds[n_kinds++].n_planes = 0;
            }
            kinds[kind].n_planes += planes.n_planes;
        }
        contour_planes_finish(&planes);
    }
    for (size_t i = 0; i < n_kinds; i++)
        if (kinds[i].n_planes > best.n_planes) {
            best.mm = kinds[i].mm;
            best.n_planes = kinds[i].n_planes;
        }
    return best.n_planes > 0 ? best.mm : along_mm > 0 ? along_mm : 1;
}

/* ---- grid without an image -------------------------------------------------------------------------------------- */

/* Finds the planes that the grid is aligned to: those of the set with most planes. */
static bool leading_planes(const struct contour_set *sets, size_t n_sets, double spacing_mm, struct vec3 *normal,
                           double *at_mm, struct error *err)
{
    size_t most = 0;
    for (size_t i = 0; i < n_sets; i++) {
        struct contour_planes planes;
        if (!contour_planes_init(&planes, &sets[i], spacing_mm, NULL, err))
            return false;
        if (planes.n_planes > most) {
            most = planes.n_planes;
            *normal = planes.normal_lps;
            *at_mm = planes.planes[0].at_mm;
        }
        contour_planes_finish(&planes);
    }
    return most > 0 ||
           error_set(err, ERROR_RANGE, "no region has a closed contour, and there is no image to take a grid from");
}

static void add_points(struct box3 *box, const struct contour_set *set, const struct vec3 axes[3])
{
    for (size_t c = 0; c < set->n_contours; c++)
        for (size_t i = 0; i < set->contours[c].n_points; i++) {
            const double *p = set->contours[c].points_lps_mm + 3 * i;
            if (fabs(p[0]) <= CONTOUR_MAX_MM && fabs(p[1]) <= CONTOUR_MAX_MM && fabs(p[2]) <= CONTOUR_MAX_MM) {
                struct vec3 point = vec3(p[0], p[1], p[2]);
                box3_add(box, vec3(vec3_dot(axes[0], point), vec3_dot(axes[1], point), vec3_dot(axes[2], point)));
            }
        }
}

static bool grid_from_planes(struct grid *grid, const struct contour_set *sets, size_t n_sets,
                             const struct contour_options *options, struct error *err)
{
    double spacing_mm = options->spacing_mm > 0 ? options->spacing_mm : contour_usual_spacing_mm(sets, n_sets, NULL);
    struct vec3 axes[3];
    double at_mm = 0;
    if (!leading_planes(sets, n_sets, spacing_mm, &axes[2], &at_mm, err))
        return false;
    struct vec3 right = fabs(axes[2].x) < 0.9 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    axes[0] = vec3_normalize(vec3_sub(right, vec3_scale(axes[2], vec3_dot(right, axes[2]))));
    axes[1] = vec3_cross(axes[2], axes[0]);
    struct box3 box = box3_empty();
    for (size_t i = 0; i < n_sets; i++)
        add_points(&box, &sets[i], axes);
    const double low[3] = { box.low.x, box.low.y, box.low.z }, high[3] = { box.high.x, box.high.y, box.high.z };
    double step_mm[3] = { PLANE_GRID_MM, PLANE_GRID_MM, spacing_mm };
    double first[3], n[3];
    for (;;) {
        for (int a = 0; a < 3; a++) {
            /* slice positions are those of the planes; rows and columns are at multiples of the step */
            double base = a == 2 ? at_mm : 0;
            first[a] = base + step_mm[a] * (floor((low[a] - base) / step_mm[a]) - 1);
            n[a] = ceil((high[a] - first[a]) / step_mm[a]) + 2;
        }
        bool is_deep = n[2] > VOLUME_MAX_SIDE, is_wide = n[0] > VOLUME_MAX_SIDE || n[1] > VOLUME_MAX_SIDE;
        if (!is_deep && !is_wide && n[0] * n[1] * n[2] <= (double)options->most_voxels)
            break;
        if (is_deep || (!is_wide && n[0] * n[1] < 4)) {
            step_mm[2] *= 2;
        } else {
            step_mm[0] *= 1.25;
            step_mm[1] = step_mm[0];
        }
    }
    struct affine map = { .origin = vec3(0, 0, 0) };
    uint32_t size[3];
    for (int a = 0; a < 3; a++) {
        size[a] = (uint32_t)n[a];
        map.columns[a] = vec3_scale(axes[a], step_mm[a]);
        map.origin = vec3_add(map.origin, vec3_scale(axes[a], first[a]));
    }
    return grid_init(grid, size, &map, err);
}

/* ---- subdivision ------------------------------------------------------------------------------------------------ */

/* Divides each voxel of a box of the base grid into subdivision parts along each axis; low and high in voxels of
 * base. */
static bool fine_grid(struct grid *grid, const struct grid *base, const uint32_t subdivision[3], const uint32_t low[3],
                      const uint32_t high[3], struct error *err)
{
    struct affine map;
    uint32_t size[3];
    double first[3];
    for (int a = 0; a < 3; a++) {
        size[a] = (high[a] - low[a]) * subdivision[a];
        first[a] = low[a] - 0.5 + 0.5 / subdivision[a];
        map.columns[a] = vec3_scale(base->lps_mm_from_ijk.columns[a], 1.0 / subdivision[a]);
    }
    map.origin = affine_point(&base->lps_mm_from_ijk, vec3(first[0], first[1], first[2]));
    return grid_init(grid, size, &map, err);
}

/* Finds the box around all slabs, in voxels of the base grid. */
static void find_box(struct candidate *candidate, const struct contour_planes *planes, const struct grid *base)
{
    struct box3 box = box3_empty();
    for (size_t c = 0; c < planes->n_contours; c++)
        for (size_t i = 0; i < planes->contours[c]->n_points; i++) {
            const double *p = planes->contours[c]->points_lps_mm + 3 * i;
            box3_add(&box, affine_point(&base->ijk_from_lps_mm, vec3(p[0], p[1], p[2])));
        }
    struct vec3 half = vec3(0, 0, 0);
    for (size_t i = 0; i < planes->n_planes; i++) {
        struct vec3 thick =
            affine_vector(&base->ijk_from_lps_mm,
                          vec3_scale(planes->normal_lps, planes->planes[i].high_mm - planes->planes[i].low_mm));
        half = vec3(fmax(half.x, fabs(thick.x)), fmax(half.y, fabs(thick.y)), fmax(half.z, fabs(thick.z)));
    }
    const double low[3] = { box.low.x, box.low.y, box.low.z }, high[3] = { box.high.x, box.high.y, box.high.z };
    const double more[3] = { half.x, half.y, half.z };
    for (int a = 0; a < 3; a++) {
        double from = floor(low[a] - more[a]) - 1, to = ceil(high[a] + more[a]) + 2;
        candidate->low[a] = from <= 0 ? 0 : from >= base->size[a] ? base->size[a] - 1 : (uint32_t)from;
        candidate->high[a] = to >= base->size[a]           ? base->size[a]
                             : to <= candidate->low[a] + 1 ? candidate->low[a] + 1
                                                           : (uint32_t)to;
    }
}

/* Volume of the slabs within the base's slices along the normal: what the scan cuts off must not count as missing. */
static double volume_within_cm3(const struct contour_planes *planes, const double *areas_mm2, const struct grid *base)
{
    double low_mm = INFINITY, high_mm = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = vec3(corner & 1 ? base->size[0] - 0.5 : -0.5, corner & 2 ? base->size[1] - 0.5 : -0.5,
                              corner & 4 ? base->size[2] - 0.5 : -0.5);
        double d = vec3_dot(planes->normal_lps, affine_point(&base->lps_mm_from_ijk, at));
        low_mm = fmin(low_mm, d);
        high_mm = fmax(high_mm, d);
    }
    double mm3 = 0;
    for (size_t i = 0; i < planes->n_planes; i++)
        mm3 +=
            areas_mm2[i] * fmax(0, fmin(high_mm, planes->planes[i].high_mm) - fmax(low_mm, planes->planes[i].low_mm));
    return mm3 / 1000;
}

/* Relative error of the volume on a grid against the polygon volume. */
static bool error_on(const struct contour_raster *raster, const struct grid *grid,
                     const struct contour_options *options, double cm3, double *volume_error, struct error *err)
{
    uint64_t n_voxels;
    if (!contour_raster_fill(raster, grid, NULL, options->n_threads, CONTOUR_MAX_MEETINGS, &n_voxels, err))
        return false;
    *volume_error = cm3 > 0 ? ((double)n_voxels * grid_voxel_mm3(grid) / 1000 - cm3) / cm3 : NAN;
    return true;
}

struct step {
    uint32_t in_plane, along;
};

static int by_cost(const void *a, const void *b)
{
    const struct step *one = a, *other = b;
    uint32_t cost = one->in_plane * one->in_plane * one->along,
             other_cost = other->in_plane * other->in_plane * other->along;
    if (cost != other_cost)
        return cost < other_cost ? -1 : 1;
    return one->in_plane < other->in_plane ? -1 : one->in_plane > other->in_plane;
}

/* Refines until the volume is accurate; else keeps the best grid tried. */
static bool subdivide(struct contour_choice *choice, struct candidate *candidate, const struct contour_raster *raster,
                      struct vec3 normal, const struct grid *base, const struct contour_options *options, double cm3,
                      struct error *err)
{
    static const uint32_t in_plane[] = { 1, 2, 3, 4, 6, 8 };
    static const uint32_t along_normal[] = { 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, CONTOUR_MAX_SUBDIVISION };
    enum { N_ALONG = sizeof along_normal / sizeof along_normal[0], N = N_ALONG * sizeof in_plane / sizeof in_plane[0] };
    struct step steps[N];
    for (size_t i = 0; i < N; i++)
        steps[i] = (struct step){ in_plane[i / N_ALONG], along_normal[i % N_ALONG] };
    qsort(steps, N, sizeof *steps, by_cost);
    int along = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(vec3_dot(normal, vec3_normalize(base->lps_mm_from_ijk.columns[a]))) >
            fabs(vec3_dot(normal, vec3_normalize(base->lps_mm_from_ijk.columns[along]))))
            along = a;
    uint64_t n_rows = 0;
    for (size_t i = 1; i < N && fabs(choice->volume_error) > accuracy_of(cm3); i++) {
        uint32_t subdivision[3], side = 0;
        uint64_t size[3];
        for (int a = 0; a < 3; a++) {
            subdivision[a] = a == along ? steps[i].along : steps[i].in_plane;
            size[a] = (uint64_t)(candidate->high[a] - candidate->low[a]) * subdivision[a];
            side = size[a] > side ? (uint32_t)size[a] : side;
        }
        n_rows += size[1] * size[2];
        if (side > VOLUME_MAX_SIDE || size[0] * size[1] * size[2] > options->most_voxels || n_rows > MOST_SEARCH_ROWS)
            continue;
        struct grid grid;
        double volume_error;
        if (!fine_grid(&grid, base, subdivision, candidate->low, candidate->high, err) ||
            !error_on(raster, &grid, options, cm3, &volume_error, err))
            return false;
        if (fabs(volume_error) < fabs(choice->volume_error)) {
            choice->volume_error = volume_error;
            memcpy(choice->subdivision, subdivision, sizeof subdivision);
            candidate->n_voxels = grid_n_voxels(&grid);
        }
    }
    choice->is_short = fabs(choice->volume_error) > accuracy_of(cm3);
    return true;
}

/* Chooses the grid of one set. base is the image's grid or, with is_beyond, its continuation; on a continuation a set
 * always gets a cropped grid of its own. */
static bool choose_one(struct contour_choice *choice, struct candidate *candidate, const struct contour_set *set,
                       const struct grid *base, bool is_beyond, const struct contour_options *options,
                       struct error *err)
{
    *choice = (struct contour_choice){ .grid = *base, .subdivision = { 1, 1, 1 }, .volume_error = NAN };
    struct contour_planes planes;
    if (!contour_planes_init(&planes, set, options->spacing_mm, base, err))
        return false;
    if (planes.n_planes == 0) {
        contour_planes_finish(&planes);
        return true;
    }
    struct contour_raster *raster = contour_raster_create(&planes, base, err);
    double *areas_mm2 = mem_array(planes.n_planes, sizeof *areas_mm2, UINT64_MAX, err);
    bool is_chosen = raster && areas_mm2 && contour_raster_areas(raster, areas_mm2, err);
    if (is_chosen) {
        double cm3 = volume_within_cm3(&planes, areas_mm2, base);
        bool is_inside = contour_is_within(&planes, base);
        find_box(candidate, &planes, base);
        for (int a = 0; a < 3 && is_beyond; a++)
            candidate->n_voxels = (a > 0 ? candidate->n_voxels : 1) * (candidate->high[a] - candidate->low[a]);
        is_chosen = error_on(raster, base, options, cm3, &choice->volume_error, err) &&
                    (!is_inside || subdivide(choice, candidate, raster, planes.normal_lps, base, options, cm3, err));
        candidate->is_outside = !is_inside;
        choice->is_beyond = is_beyond;
    }
    free(areas_mm2);
    contour_raster_destroy(raster);
    contour_planes_finish(&planes);
    return is_chosen;
}

/* ---- grids shared by several sets ------------------------------------------------------------------------------- */

struct group {
    uint32_t subdivision[3], low[3], high[3];
    uint64_t own_voxels; /* sum over the cropped grids of its members */
};

static uint64_t fine_voxels(const uint32_t subdivision[3], const uint32_t low[3], const uint32_t high[3])
{
    uint64_t n = 1;
    for (int a = 0; a < 3; a++)
        n *= (uint64_t)(high[a] - low[a]) * subdivision[a]; /* each factor is at most 16 * 4096 */
    return n;
}

/* Returns true if one grid around both takes not much more than the two alone. */
static bool may_join(const struct group *group, const struct contour_choice *choice, const struct candidate *candidate,
                     uint64_t most_voxels, struct group *joined)
{
    if (memcmp(group->subdivision, choice->subdivision, sizeof group->subdivision) != 0)
        return false;
    *joined = *group;
    for (int a = 0; a < 3; a++) {
        joined->low[a] = candidate->low[a] < group->low[a] ? candidate->low[a] : group->low[a];
        joined->high[a] = candidate->high[a] > group->high[a] ? candidate->high[a] : group->high[a];
        if ((joined->high[a] - joined->low[a]) * joined->subdivision[a] > VOLUME_MAX_SIDE)
            return false;
    }
    joined->own_voxels += candidate->n_voxels;
    uint64_t n = fine_voxels(joined->subdivision, joined->low, joined->high);
    return n <= most_voxels && (n <= SHARED_VOXELS || n <= 2 * joined->own_voxels);
}

/* Lets sets share cropped grids on one base: the image, or its continuation with is_beyond. Their groups are numbered
 * from *n_groups_before on, which grows by the number of groups. */
static bool share_grids(struct contour_choice *choices, const struct candidate *candidates, size_t n,
                        const struct grid *base, bool is_beyond, uint64_t most_voxels, uint32_t *n_groups_before,
                        struct error *err)
{
    struct group *groups = mem_array(n, sizeof *groups, UINT64_MAX, err);
    if (!groups)
        return false;
    size_t n_groups = 0;
    for (size_t i = 0; i < n; i++) {
        if (candidates[i].n_voxels == 0 || choices[i].is_beyond != is_beyond)
            continue;
        size_t at = 0;
        struct group joined;
        while (at < n_groups && !may_join(&groups[at], &choices[i], &candidates[i], most_voxels, &joined))
            at++;
        if (at == n_groups) {
            joined.own_voxels = candidates[i].n_voxels;
            memcpy(joined.subdivision, choices[i].subdivision, sizeof joined.subdivision);
            memcpy(joined.low, candidates[i].low, sizeof joined.low);
            memcpy(joined.high, candidates[i].high, sizeof joined.high);
            n_groups++;
        }
        groups[at] = joined;
        choices[i].group = *n_groups_before + (uint32_t)at + 1;
    }
    bool is_made = true;
    for (size_t i = 0; is_made && i < n; i++) {
        if (candidates[i].n_voxels == 0 || choices[i].is_beyond != is_beyond)
            continue;
        const struct group *group = &groups[choices[i].group - *n_groups_before - 1];
        is_made = fine_grid(&choices[i].grid, base, group->subdivision, group->low, group->high, err);
    }
    free(groups);
    *n_groups_before += (uint32_t)n_groups;
    return is_made;
}

/* Same as choose_one for a set that may exceed a limit of contour_fill. On the image, contour_fill reports the limit
 * for this set later; on the continuation, the choice made on the image stays. */
static bool choose_or_leave(struct contour_choice *choice, struct candidate *candidate, const struct contour_set *set,
                            const struct grid *base, bool is_beyond, const struct contour_options *options,
                            struct error *err)
{
    struct error reason = { 0 };
    const struct contour_choice choice_before = is_beyond ? *choice : (struct contour_choice){ 0 };
    const struct candidate candidate_before = *candidate;
    bool is_chosen = choose_one(choice, candidate, set, base, is_beyond, options, &reason);
    if (!is_chosen && reason.code == ERROR_LIMIT && is_beyond) {
        *choice = choice_before;
        *candidate = candidate_before;
        is_chosen = true;
    } else if (!is_chosen && reason.code == ERROR_LIMIT) {
        *choice =
            (struct contour_choice){ .grid = *base, .subdivision = { 1, 1, 1 }, .volume_error = NAN, .is_short = true };
        *candidate = (struct candidate){ 0 };
        is_chosen = true;
    }
    if (!is_chosen && err)
        *err = reason;
    return is_chosen;
}

/* Chooses grids that continue the image for sets that leave it. Sets that are too far away or too intricate stay on the
 * image's grid. */
static bool choose_beyond(const struct contour_set *sets, size_t n_sets, const struct grid *image,
                          const struct contour_options *options, struct contour_choice *choices,
                          struct candidate *candidates, uint32_t *n_groups, struct error *err)
{
    bool *is_marked = mem_array(n_sets, sizeof *is_marked, UINT64_MAX, err), has_grid = false, is_any = false;
    if (!is_marked)
        return false;
    for (size_t i = 0; i < n_sets; i++) {
        is_marked[i] = candidates[i].is_outside;
        is_any |= is_marked[i];
    }
    struct grid reach;
    bool is_chosen = !is_any || contour_reach_grid(sets, is_marked, n_sets, image, options, &reach, &has_grid, err);
    for (size_t i = 0; i < n_sets && is_chosen && has_grid; i++)
        if (is_marked[i])
            is_chosen = choose_or_leave(&choices[i], &candidates[i], &sets[i], &reach, true, options, err);
    free(is_marked);
    return is_chosen &&
           (!has_grid || share_grids(choices, candidates, n_sets, &reach, true, options->most_voxels, n_groups, err));
}

bool contour_choose_grids(const struct contour_set *sets, size_t n_sets, const struct grid *image,
                          const struct contour_options *options, struct contour_choice *choices, struct error *err)
{
    struct grid made;
    if (!image && !grid_from_planes(&made, sets, n_sets, options, err))
        return false;
    const struct grid *base = image ? image : &made;
    struct candidate *candidates = mem_array(n_sets, sizeof *candidates, UINT64_MAX, err);
    bool is_chosen = candidates != NULL;
    uint32_t n_groups = 0;
    for (size_t i = 0; is_chosen && i < n_sets; i++)
        is_chosen = choose_or_leave(&choices[i], &candidates[i], &sets[i], base, false, options, err);
    is_chosen = is_chosen &&
                share_grids(choices, candidates, n_sets, base, false, options->most_voxels, &n_groups, err) &&
                (!image || choose_beyond(sets, n_sets, image, options, choices, candidates, &n_groups, err));
    free(candidates);
    return is_chosen;
}
