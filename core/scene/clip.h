#pragma once
/* The clip planes of a scene: what they cut off is not drawn in 3-D, not picked, and a cap closes the cut. Knows no
 * pixels. */
#include "core/plan/plan.h"
#include "core/scene/plane.h"

enum clip_name {
    CLIP_AXIAL_LOW,
    CLIP_AXIAL_HIGH,
    CLIP_CORONAL_LOW,
    CLIP_CORONAL_HIGH,
    CLIP_SAGITTAL_LOW,
    CLIP_SAGITTAL_HIGH,
    CLIP_BEAM,
    CLIP_FREE,
    CLIP_MAX
};

/* An enabled clip plane. It cuts off what lies above it (plane_height_mm > 0). */
struct clip_plane {
    enum clip_name name;
    struct plane plane;
    bool is_capped;
};

/* The enabled clip planes, by name; returns how many. One along a beam that the plan does not have is left out. */
size_t clip_planes(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                   struct clip_plane planes[CLIP_MAX]);

/* A plane in a clip plane is drawn on it: what lies less than this above a clip plane is not cut off. */
#define CLIP_SLACK_MM 1e-6
/* True if one of the planes cuts the point off. */
bool clip_cuts(const struct clip_plane *planes, size_t n, struct vec3 point_lps_mm);

/* The part of a ray that no plane cuts off; distances along its direction. */
struct clip_range {
    double from_mm, to_mm; /* >= 0; to_mm may be infinite; nothing is left if from_mm >= to_mm */
    int from, to;          /* index of the plane where the part starts, ends; -1: no plane does it */
};
/* direction: of unit length. The ray starts at its origin. */
struct clip_range clip_ray(const struct clip_plane *planes, size_t n, struct vec3 origin_lps_mm, struct vec3 direction);
