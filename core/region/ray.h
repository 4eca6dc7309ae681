#pragma once
/* Along a line through the patient: which region is innermost where. The line crosses the univels of all label layers,
 * whatever the orientation of their grids. Any thread. */
#include "core/region/region.h"

/* Depths lie on a line, in mm from its first point. */
struct ray {
    struct vec3 from_lps_mm, direction; /* of length 1 */
    double low_mm, high_mm;             /* the first and the last depth; low_mm < high_mm */
};
static inline struct vec3 ray_point(const struct ray *ray, double depth_mm)
{
    return vec3_add(ray->from_lps_mm, vec3_scale(ray->direction, depth_mm));
}
/* Narrows [*low_mm, *high_mm] to the depths within a grid's outer faces. False: there are none. */
bool ray_clip(const struct ray *ray, const struct grid *grid, double *low_mm, double *high_mm);

/* A part of the line in univels of one innermost region: the deepest in the hierarchy, of equally deep ones the
 * smaller. */
struct ray_band {
    size_t region;
    double from_mm, to_mm;
};
/* The bands from low_mm to high_mm, ascending. Their ends are where the line crosses the faces of univels (J.
 * Amanatides, A. Woo, A fast voxel traversal algorithm, Eurographics 1987), on the grids of all label layers. Sets
 * *bands (free) and *n. Errors: ERROR_MEMORY. */
NODISCARD bool ray_bands(const struct region_set *set, const struct ray *ray, struct ray_band **bands, size_t *n,
                         struct error *err);

/* Like ray_bands, along the whole line through a point, both ways; without label layers, or beside all of them, none.
 * The skin is where the first band begins. */
NODISCARD bool ray_bands_all(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction,
                             struct ray_band **bands, size_t *n, struct error *err);
