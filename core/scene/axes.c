/* Where the patient axes of a plan begin and end. */
#include "core/scene/axes.h"

#include <math.h>

static struct vec3 along_axis(struct vec3 v, int axis, double value)
{
    return vec3(axis == 0 ? value : v.x, axis == 1 ? value : v.y, axis == 2 ? value : v.z);
}

static double component(struct vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static bool axes_through(const struct plan *plan, const struct vec3 *through, struct vec3 *meet, struct axis_end *ends)
{
    const struct box3 *box = &plan->bounds_lps_mm;
    if (box3_is_empty(box) || !vec3_is_finite(box->low) || !vec3_is_finite(box->high))
        return false;
    struct vec3 size = vec3_sub(box->high, box->low), middle = vec3_scale(vec3_add(box->low, box->high), 0.5);
    *meet = through ? *through : middle;
    for (int i = 0; i < AXES_N_ENDS; i++) {
        const int axis = i / 2, side = i % 2 ? -1 : 1;
        const double from = component(*meet, axis), half = side * component(size, axis),
                     end = component(middle, axis) + AXES_REACH * half, face = component(middle, axis) + 0.5 * half;
        double in_box = through ? fmin(fmax((face - from) / (end - from), 0), 1) : 0.5 / AXES_REACH;
        ends[i] = (struct axis_end){ "LRPASI"[i], along_axis(*meet, axis, end), isfinite(in_box) ? in_box : 0 };
    }
    return true;
}

bool axes_of_plan(const struct plan *plan, struct vec3 *middle_lps_mm, struct axis_end ends[AXES_N_ENDS])
{
    return axes_through(plan, NULL, middle_lps_mm, ends);
}

bool axes_of_scene(const struct plan *plan, const struct scene *scene, struct vec3 *meet_lps_mm,
                   struct axis_end ends[AXES_N_ENDS])
{
    const struct scene_slices *slices = &scene->image.slices;
    const struct vec3 crosshair =
        vec3(slices->sagittal.position_mm, slices->coronal.position_mm, slices->axial.position_mm);
    return axes_through(plan, scene->axes.form == SCENE_AXES_FORM_CROSSHAIR ? &crosshair : NULL, meet_lps_mm, ends);
}

/* In parts of the picture's shorter side. */
static const double corner_aside = 0.15, corner_up = 0.2, arm_length = 0.075, letter_at = 0.105;

void axes_in_corner(const struct camera *camera, double width_px, double height_px, struct axes_corner *corner)
{
    static const struct vec3 axes[AXES_N_ARMS] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    const double side_px = fmin(width_px, height_px);
    corner->at[0] = corner_aside * side_px;
    corner->at[1] = height_px - corner_up * side_px;
    for (int i = 0; i < AXES_N_ARMS; i++) {
        const double right = vec3_dot(axes[i], camera->right), up = vec3_dot(axes[i], camera->up);
        corner->arm[i][0] = arm_length * side_px * right;
        corner->arm[i][1] = -arm_length * side_px * up;
        corner->letter[i][0] = letter_at * side_px * right;
        corner->letter[i][1] = -letter_at * side_px * up;
        corner->away[i] = vec3_dot(axes[i], camera->forward);
    }
}
