#pragma once
/* Inside of contour filling: the contours of one region sorted into parallel planes, and the slab each plane stands
 * for. */
#include "core/region/contour.h"

struct contour_plane {
    double at_mm;           /* along the normal, from the origin of the patient */
    double low_mm, high_mm; /* the slab: low <= distance < high; slabs ascend and never overlap */
    size_t first, end;      /* contours[first .. end) */
};

struct contour_planes {
    struct vec3 normal_lps; /* unit */
    struct contour_plane *planes;
    size_t n_planes;
    const struct contour **contours; /* those to fill, plane by plane; borrowed */
    size_t n_contours;
    struct contour_facts facts; /* all that does not need a grid; polygon_cm3 is 0 */
};

/* spacing_mm: see contour_options; likely: a grid along whose planes the contours probably lie, or NULL for the
 * patient's axes: a normal within a tenth of a degree of one of its own is taken to be that one. errors as
 * contour_fill. Never fails for bad points. */
NODISCARD bool contour_planes_init(struct contour_planes *planes, const struct contour_set *set, double spacing_mm,
                                   const struct grid *likely, struct error *err);
void contour_planes_finish(struct contour_planes *planes);
/* Distance of the grid's own planes along a direction: of the axis most nearly along it. */
double contour_grid_spacing_mm(const struct grid *grid, struct vec3 normal_lps);
