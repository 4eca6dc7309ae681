/* Where the patient axes of a plan begin and end. */
#include "core/scene/axes.h"

bool axes_of_plan(const struct plan *plan, struct vec3 *middle_lps_mm, struct axis_end ends[AXES_N_ENDS])
{
    const struct box3 *box = &plan->bounds_lps_mm;
    if (box3_is_empty(box) || !vec3_is_finite(box->low) || !vec3_is_finite(box->high))
        return false;
    struct vec3 size = vec3_sub(box->high, box->low), middle = vec3_scale(vec3_add(box->low, box->high), 0.5);
    const struct vec3 reach[3] = { vec3(AXES_REACH * size.x, 0, 0), vec3(0, AXES_REACH * size.y, 0),
                                   vec3(0, 0, AXES_REACH * size.z) };
    *middle_lps_mm = middle;
    for (int i = 0; i < AXES_N_ENDS; i++)
        ends[i] = (struct axis_end){ "LRPASI"[i], vec3_add(middle, vec3_scale(reach[i / 2], i % 2 ? -1 : 1)) };
    return true;
}
