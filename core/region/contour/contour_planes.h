#pragma once
/* Inside of contour filling: sorts the contours of one region into parallel planes, and gives each plane its slab. Any
 * thread. */
#include "core/region/contour/contour.h"

struct contour_plane {
    double at_mm;           /* position along the normal, from the patient origin */
    double low_mm, high_mm; /* the slab: low_mm <= position < high_mm; slabs ascend and never overlap */
    size_t first, end;      /* contours[first .. end) are on this plane */
};

struct contour_planes {
    struct vec3 normal_lps; /* unit vector */
    struct contour_plane *planes;
    size_t n_planes;
    const struct contour **contours; /* the contours to fill, plane by plane; borrowed */
    size_t n_contours;
    struct contour_facts facts; /* everything that needs no grid; polygon_cm3 is 0 */
};

/* Finds normal, planes and slabs. Bad points never make it fail: their contours are left out and counted in facts.
 *
 *   spacing_mm  see contour_options
 *   likely      a grid along whose planes the contours probably lie, or NULL for the patient axes: a normal within 0.1
 *               degree of one of its normals is snapped to it
 *   errors      as contour_fill */
NODISCARD bool contour_planes_init(struct contour_planes *planes, const struct contour_set *set, double spacing_mm,
                                   const struct grid *likely, struct error *err);
void contour_planes_finish(struct contour_planes *planes);
/* Distance of the grid's planes, measured along normal_lps, for the axis nearest to that direction. */
double contour_grid_spacing_mm(const struct grid *grid, struct vec3 normal_lps);
