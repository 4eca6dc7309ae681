#pragma once
/* Cameras: the home camera of a plan, and a snapshot's camera resolved to axes and matrices. */
#include "core/plan/plan.h"
#include "core/scene/plane.h"
#include "scene.h" /* generated from proto/scene.json */

/* The camera that shows the whole plan. 3-D: all regions from the front, 30 degrees towards the patient's left and 12
 * degrees from above, superior up; the image instead if the regions' box is less than half as long. Slice panes: the
 * whole first image, without one all regions; of an oblique pane only target and height count, and the height is that
 * of the highest of the three others. */
void camera_home(const struct plan *plan, enum scene_kind kind, struct scene_camera *camera);

/* A view's camera, resolved: unit axes in patient space and the projection. */
struct camera {
    struct vec3 eye_lps_mm, target_lps_mm;
    struct vec3 right, up, forward; /* axes of the picture; orthonormal, right = forward x up */
    bool is_parallel;
    double pixels_per_mm;   /* of the full-size view, in parallel projection; 0 in perspective */
    double near_mm, far_mm; /* from the eye along forward; they enclose the plan's bounds */
    struct mat4 clip_from_lps_mm, lps_mm_from_clip;
};
/* The camera of a view. A slice pane's has the axes of its plane, and its target on the plane. pane: of a slice pane;
 * else unused. */
void camera_of_view(const struct plan *plan, const struct view *view, const struct plane *pane, struct camera *camera);
/* True if the view's camera can be used: position != target, up not along the line of sight. field: on failure the JSON
 * pointer of the wrong field. errors ERROR_RANGE */
NODISCARD bool camera_check(const struct plan *plan, const struct view *view, const struct plane *pane, char field[128],
                            struct error *err);
