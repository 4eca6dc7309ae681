#pragma once
/* A plane in the patient with its own axes, and the planes of a scene: image slices, slice panes. The only place that
 * knows which patient axis a slice or a kind of view belongs to; all others take the plane. Knows no grid, no pixels.
 */
#include "core/math/vec.h"
#include "scene.h" /* generated from proto/scene.json */

/* Patient LPS, mm. right, up and normal are unit vectors, square to each other; right x up is the normal or its
 * opposite. A picture of the plane has right to the right and up upwards; the viewer stands on the side of right x up.
 * A point lies above the plane where plane_height_mm is positive. Along a patient axis every component is exactly 0, 1
 * or -1, so that positions along it come out of the arithmetic unchanged. */
struct plane {
    struct vec3 origin_lps_mm;
    struct vec3 right, up, normal;
};

/* The plane of a kind of slice pane at a position along the normal, which is the positive patient axis. Axial is seen
 * from the feet (right: patient left, up: anterior), coronal from the front (right: patient left, up: superior),
 * sagittal from the patient's left (right: posterior, up: superior). 3-D: as coronal. */
struct plane plane_of_kind(enum scene_kind kind, double position_mm);
/* The plane a view's slice pane shows; at the scene's position. The view's kind is not 3-D. */
struct plane plane_of_view(const struct scene *scene, const struct view *view);
/* The image slices that a scene shows in space, in the order in which they are drawn; returns how many. */
enum { PLANE_MAX_SLICES = 3 };
size_t planes_of_slices(const struct scene *scene, struct plane slices[PLANE_MAX_SLICES]);

/* Field by field. */
bool plane_equal(const struct plane *a, const struct plane *b);
/* The same plane, so far along its normal. */
struct plane plane_moved(const struct plane *plane, double distance_mm);
/* Direction of sight of a picture of the plane: opposite to right x up. */
struct vec3 plane_forward(const struct plane *plane);

/* The position along the normal, of the plane and of a point: dot products with the normal. */
static inline double plane_position_mm(const struct plane *plane)
{
    return vec3_dot(plane->origin_lps_mm, plane->normal);
}
/* How far a point lies above the plane. */
static inline double plane_height_mm(const struct plane *plane, struct vec3 point_lps_mm)
{
    return vec3_dot(vec3_sub(point_lps_mm, plane->origin_lps_mm), plane->normal);
}
/* The point so far along right and up from the origin. */
struct vec3 plane_point(const struct plane *plane, double right_mm, double up_mm);
/* The plane's point next to a point. */
struct vec3 plane_nearest(const struct plane *plane, struct vec3 point_lps_mm);

/* A box and a plane: how far the box reaches along right and up from the origin, and above the plane. */
struct plane_reach {
    double low_right_mm, high_right_mm, low_up_mm, high_up_mm, low_mm, high_mm;
};
struct plane_reach plane_reach(const struct plane *plane, const struct box3 *box);
static inline bool plane_meets(const struct plane_reach *reach)
{
    return reach->low_mm <= 0 && reach->high_mm >= 0;
}

/* The same plane with right and up turned towards the positive patient axes: equal for a plane and for one whose
 * picture is upside down, so that what is laid out on it is too. */
struct plane plane_upright(const struct plane *plane);
