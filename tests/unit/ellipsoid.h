#pragma once
/* Ellipsoids as masks of any spacing, and how far a surface of such a mask is from the exact ellipsoid. */
#include "core/region/mask.h"
#include "core/surface/mesh.h"

struct ellipsoid {
    double spacing_mm[3], radius_mm[3], tilt_rad; /* tilted about x, then about y */
};

struct vec3 ellipsoid_to_body(const struct ellipsoid *body, struct vec3 p);
struct vec3 ellipsoid_from_body(const struct ellipsoid *body, struct vec3 p);
/* Outward normal of the ellipsoid at the point nearest p, to first order; not normalised. p in patient space. */
struct vec3 ellipsoid_normal(const struct ellipsoid *body, struct vec3 p);
/* Signed distance from the ellipsoid, to first order; positive outside. */
double ellipsoid_distance_mm(const struct ellipsoid *body, struct vec3 p);
/* Univels whose centre is inside. The ellipsoid's centre is the patient origin, at no special position between the
 * univels, and off differently for each `place`. */
struct mask *ellipsoid_mask(const struct ellipsoid *body, int place);

struct ellipsoid_error {
    /* of the triangles' normals, over the area, and of the vertex normals: 95th percentiles. Near the poles: where the
     * exact normal is within 30 degrees of the slice axis */
    double normal_deg, pole_normal_deg, shown_deg, pole_shown_deg;
    double rms_mm, max_mm; /* distance of triangles' centres, over the area; of vertices */
    double volume;         /* relative to the exact volume */
};
struct ellipsoid_error ellipsoid_error_of(const struct mesh *mesh, const struct ellipsoid *body, int slice_axis);
