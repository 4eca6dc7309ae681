#pragma once
/* Cameras: the home camera of a plan, and a snapshot's camera resolved to axes and matrices. */
#include "core/plan/plan.h"
#include "core/scene/beam_shown.h"
#include "core/scene/plane.h"
#include "scene.h" /* generated from proto/scene.json */

/* The camera that shows the whole plan. 3-D: all regions from the front, 30 degrees towards the patient's left and 12
 * degrees from above, superior up; the image instead if the regions' box is less than half as long. Slice panes: the
 * whole first image, without one all regions; of an oblique pane only target and height count, and the height is that
 * of the highest of the three others. */
void camera_home(const struct plan *plan, enum scene_kind kind, struct scene_camera *camera);

/* Turns the camera of a 3-D view about the axis to superior through its target, positive towards the patient's left
 * from the front. A place that the view does not give is that of the home camera, before the turn. */
void camera_turn(const struct plan *plan, struct view *view, double turn_deg);

/* A view's camera, resolved: unit axes in patient space and the projection. */
struct camera {
    struct vec3 eye_lps_mm, target_lps_mm;
    struct vec3 right, up, forward; /* axes of the picture; orthonormal, right = forward x up */
    bool is_parallel;
    double pixels_per_mm;   /* of the full-size view, in parallel projection; 0 in perspective */
    double near_mm, far_mm; /* from the eye along forward; they enclose the plan's bounds */
    struct mat4 clip_from_lps_mm, lps_mm_from_clip;
};
/* True if views of this kind are slice panes; else they are views into space. */
static inline bool camera_is_of_pane(enum scene_kind kind)
{
    return kind != SCENE_KIND_3D && kind != SCENE_KIND_BEAM;
}
/* The camera of a view. A slice pane's has the axes of its plane, and its target on the plane. A beam's-eye view's eye
 * is on the beam's line and looks along it, with the axes of beam_plane and the beam's target as its target, which may
 * lie behind the eye; with an aperture ring it is parallel. Its extent in parallel projection is that of the camera
 * given; without one, what perspective from its home shows at the target, wherever the eye is. What lies behind an eye
 * whose place the view gives is not in it; a slice at that very place is, in parallel projection.
 *   pane  of a slice pane; else unused
 *   beam  of a beam's-eye view; NULL: it is a 3-D view. Else unused */
void camera_of_view(const struct plan *plan, const struct view *view, const struct plane *pane,
                    const struct beam_shown *beam, struct camera *camera);
/* Like camera_of_view, for a picture that shows more than the plan's bounds: near and far enclose this box too; it may
 * be empty. */
void camera_of_view_beyond(const struct plan *plan, const struct view *view, const struct plane *pane,
                           const struct beam_shown *beam, const struct box3 *beyond, struct camera *camera);
/* True if the view's camera can be used: position != target, up not along the line of sight. field: on failure the JSON
 * pointer of the wrong field. errors ERROR_RANGE */
NODISCARD bool camera_check(const struct plan *plan, const struct view *view, const struct plane *pane,
                            const struct beam_shown *beam, char field[128], struct error *err);
