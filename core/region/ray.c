/* Crosses the univels of label layers along a line. */
#include "core/region/ray.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* The line in a grid's index space: start + depth * step. */
static void in_index_space(const struct ray *ray, const struct grid *grid, double start[3], double step[3])
{
    struct vec3 p = affine_point(&grid->ijk_from_lps_mm, ray->from_lps_mm),
                d = affine_vector(&grid->ijk_from_lps_mm, ray->direction);
    memcpy(start, (double[]){ p.x, p.y, p.z }, 3 * sizeof *start);
    memcpy(step, (double[]){ d.x, d.y, d.z }, 3 * sizeof *step);
}

bool ray_clip(const struct ray *ray, const struct grid *grid, double *low_mm, double *high_mm)
{
    double start[3], step[3];
    in_index_space(ray, grid, start, step);
    for (int axis = 0; axis < 3; axis++) {
        double near = (-0.5 - start[axis]) / step[axis], far = (grid->size[axis] - 0.5 - start[axis]) / step[axis];
        if (step[axis] == 0) {
            if (start[axis] < -0.5 || start[axis] > grid->size[axis] - 0.5)
                return false;
            continue;
        }
        *low_mm = fmax(*low_mm, fmin(near, far));
        *high_mm = fmin(*high_mm, fmax(near, far));
    }
    return *low_mm < *high_mm;
}

/* Adds the depths at which the line crosses faces between voxels of a grid, and its outer faces. */
static size_t add_crossings(const struct ray *ray, const struct grid *grid, double *depths)
{
    double start[3], step[3], low = ray->low_mm, high = ray->high_mm;
    size_t n = 0;
    in_index_space(ray, grid, start, step);
    if (!ray_clip(ray, grid, &low, &high))
        return 0;
    for (int axis = 0; axis < 3; axis++) {
        if (step[axis] == 0)
            continue;
        double a = start[axis] + step[axis] * low, b = start[axis] + step[axis] * high;
        double first = fmax(ceil(fmin(a, b) + 0.5 - 1e-9), 0),
               last = fmin(floor(fmax(a, b) + 0.5 + 1e-9), grid->size[axis]);
        for (double face = first; face <= last; face++)
            depths[n++] = (face - 0.5 - start[axis]) / step[axis];
    }
    return n;
}

static int compare_depths(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* All crossings from low_mm to high_mm, with both ends, ascending; NULL on failure. */
static double *list_crossings(const struct region_set *set, const struct ray *ray, size_t *n, struct error *err)
{
    size_t most = 2;
    bool is_repeated[REGION_MAX_LAYERS] = { false };
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        const struct grid *grid = &set->layers[layer]->grid;
        for (size_t before = 0; before < layer && !is_repeated[layer]; before++)
            is_repeated[layer] = memcmp(grid, &set->layers[before]->grid, sizeof *grid) == 0;
        most += is_repeated[layer] ? 0 : (size_t)grid->size[0] + grid->size[1] + grid->size[2] + 3;
    }
    double *depths = mem_array(most, sizeof *depths, UINT64_MAX, err);
    if (!depths)
        return NULL;
    *n = 0;
    depths[(*n)++] = ray->low_mm;
    depths[(*n)++] = ray->high_mm;
    for (size_t layer = 0; layer < set->n_layers; layer++)
        if (!is_repeated[layer])
            *n += add_crossings(ray, &set->layers[layer]->grid, depths + *n);
    for (size_t i = 0; i < *n; i++)
        depths[i] = fmin(fmax(depths[i], ray->low_mm), ray->high_mm);
    qsort(depths, *n, sizeof *depths, compare_depths);
    return depths;
}

/* The innermost region at a point; -1: none. */
static int innermost_at(const struct region_set *set, struct vec3 point)
{
    int best = -1, best_depth = -1;
    uint16_t labels[REGION_MAX_LAYERS];
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        uint32_t at[3];
        labels[layer] = 0;
        if (volume_voxel_at(set->layers[layer], point, at))
            labels[layer] = volume_label(set->layers[layer], at[0], at[1], at[2]);
    }
    for (size_t r = 0; r < set->n_regions; r++) {
        if (labels[set->regions[r].layer] != set->regions[r].label || set->regions[r].label == 0)
            continue;
        int depth = region_depth(set, r);
        if (depth > best_depth || (depth == best_depth && set->regions[r].n_voxels < set->regions[best].n_voxels)) {
            best = (int)r;
            best_depth = depth;
        }
    }
    return best;
}

bool ray_bands(const struct region_set *set, const struct ray *ray, struct ray_band **bands, size_t *n,
               struct error *err)
{
    size_t n_depths;
    double *depths = list_crossings(set, ray, &n_depths, err);
    struct ray_band *list = depths ? mem_array(n_depths, sizeof *list, UINT64_MAX, err) : NULL;
    *n = 0;
    for (size_t i = 0; list && i + 1 < n_depths; i++) {
        if (depths[i + 1] - depths[i] < 1e-7)
            continue; /* a crossing of two faces, or of grids that coincide */
        int region = innermost_at(set, ray_point(ray, (depths[i] + depths[i + 1]) / 2));
        if (region < 0)
            continue;
        struct ray_band *last = *n ? &list[*n - 1] : NULL;
        if (last && last->region == (size_t)region && depths[i] - last->to_mm < 1e-6)
            last->to_mm = depths[i + 1];
        else
            list[(*n)++] = (struct ray_band){ (size_t)region, depths[i], depths[i + 1] };
    }
    free(depths);
    *bands = list;
    return list;
}

bool ray_bands_all(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction,
                   struct ray_band **bands, size_t *n, struct error *err)
{
    struct ray ray = { from_lps_mm, direction, INFINITY, -INFINITY };
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        double low = -INFINITY, high = INFINITY;
        if (ray_clip(&ray, &set->layers[layer]->grid, &low, &high)) {
            ray.low_mm = fmin(ray.low_mm, low);
            ray.high_mm = fmax(ray.high_mm, high);
        }
    }
    *bands = NULL;
    *n = 0;
    return !(ray.low_mm < ray.high_mm) || ray_bands(set, &ray, bands, n, err);
}
