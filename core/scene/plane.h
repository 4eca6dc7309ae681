#pragma once
/* A plane in the patient with its own axes, and the planes of a scene: image slices, slice panes. The only place that
 * knows which patient axis a slice or a kind of view belongs to; all others take the plane. Knows no grid, no pixels.
 */
#include "core/plan/plan.h"
#include "core/scene/fit_use.h"
#include "scene.h" /* generated from proto/scene.json */

/* Patient LPS, mm. right, up and normal are unit vectors at right angles to each other; right x up is the normal or its
 * opposite. A picture of the plane shows it from the side that right x up points to. The normal decides which side is
 * above (plane_height_mm > 0). In planes square to the patient every component is exactly 0, 1 or -1, so that dot
 * products return coordinates unchanged. */
struct plane {
    struct vec3 origin_lps_mm;
    struct vec3 right, up, normal;
};

/* The plane of a kind of slice pane, at a position along the positive patient axis, which is its normal. Axial is seen
 * from the feet (right: patient left, up: anterior), coronal from the front (right: patient left, up: superior),
 * sagittal from the patient's left (right: posterior, up: superior). All other kinds give the coronal plane. */
struct plane plane_of_kind(enum scene_kind kind, double position_mm);
/* A plane of any direction, with the axes of the nearest of those three, turned about an axis in both: up is that
 * plane's up as far as it lies in the plane. The normal points to the same side as the nearest plane's; of a normal
 * square to the patient the result is exactly the plane_of_kind. normal: any length but 0, finite. */
struct plane plane_of_normal(struct vec3 origin_lps_mm, struct vec3 normal);
/* The plane that a view's slice pane shows; of a beam's-eye view that through the beam's target (beam_shown.h). The
 * view's kind is not SCENE_KIND_3D. An oblique view of a plane that the scene does not have, and views of a beam that
 * there is not, have the axial slice. */
struct plane plane_of_view(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                           const struct view *view);
/* The image slices that a scene shows in space, in the order in which they are drawn: the three orthogonal ones, then
 * the obliques, then the beam slice; returns how many. */
enum { PLANE_MAX_SLICES = 3 + 8 + 1 };
size_t planes_of_slices(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                        struct plane slices[PLANE_MAX_SLICES]);

/* Field by field. */
bool plane_equal(const struct plane *a, const struct plane *b);
/* The plane, moved along its normal. */
struct plane plane_moved(const struct plane *plane, double distance_mm);
/* The viewing direction of a picture of the plane: opposite to right x up. */
struct vec3 plane_forward(const struct plane *plane);

/* Distance of the plane from the patient's origin, along the normal. */
static inline double plane_position_mm(const struct plane *plane)
{
    return vec3_dot(plane->origin_lps_mm, plane->normal);
}
/* Height of a point above the plane; negative below it. */
static inline double plane_height_mm(const struct plane *plane, struct vec3 point_lps_mm)
{
    return vec3_dot(vec3_sub(point_lps_mm, plane->origin_lps_mm), plane->normal);
}
/* The point of the plane at these coordinates along right and up. */
struct vec3 plane_point(const struct plane *plane, double right_mm, double up_mm);
/* The point projected on the plane. */
struct vec3 plane_nearest(const struct plane *plane, struct vec3 point_lps_mm);

/* The extent of a box in the plane's coordinates: along right and up, and in height. */
struct plane_reach {
    double low_right_mm, high_right_mm, low_up_mm, high_up_mm, low_mm, high_mm;
};
struct plane_reach plane_reach(const struct plane *plane, const struct box3 *box);
static inline bool plane_meets(const struct plane_reach *reach)
{
    return reach->low_mm <= 0 && reach->high_mm >= 0;
}

/* The plane with right and up turned towards the positive patient axes: pixels laid out along them do not depend on
 * which way up a picture of the plane is. */
struct plane plane_upright(const struct plane *plane);
