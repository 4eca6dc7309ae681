#pragma once
/* The univels of regions in a cylinder or a prism around a line, such as the aperture or the opening of a beam. Any
 * thread. */
#include "core/region/region.h"

struct region_in_cylinder {
    uint64_t n_voxels;     /* with their centres inside; the region's own, without those of regions inside it */
    double first_along_mm; /* the least distance along the line of such a centre; INFINITY without one */
};

/* Counts the univels of each region whose centres are within radius_mm of the line, on it included, however far along
 * it both ways.
 *
 *   from_lps_mm, direction  the line; direction of unit length, distances along it count from from_lps_mm
 *   found    [n_regions]
 *   errors   ERROR_MEMORY
 *   threads  all cores, where that is faster; measured regions (region_set_measure) */
NODISCARD bool regions_in_cylinder(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction,
                                   double radius_mm, struct region_in_cylinder *found, struct error *err);

/* The cross-section of a prism: closed polygons, apart from each other, the first point not repeated. */
struct region_prism {
    struct vec3 x_lps, y_lps; /* of unit length, across the line and each other; 0, 0 lies on the line */
    const float (*points_mm)[2];
    const uint16_t *ends; /* [n_polygons]; polygon i has the points from ends[i - 1], of the first from 0, up to but
                             without ends[i] */
    size_t n_polygons;    /* with up to REGION_PRISM_MAX_POINTS points */
};
enum { REGION_PRISM_MAX_POINTS = 1600 };
/* Like regions_in_cylinder, for the centres whose place across the line is in a polygon. Whether a centre on an edge
 * counts is not defined. */
NODISCARD bool regions_in_prism(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction,
                                const struct region_prism *prism, struct region_in_cylinder *found, struct error *err);
