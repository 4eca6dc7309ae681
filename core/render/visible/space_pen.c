/* Lines of the patient in a picture: cut off at the eye, then projected. */
#include "core/render/visible/space_pen.h"

#include <math.h>

static double depth_mm(const struct camera *camera, struct vec3 p)
{
    return vec3_dot(vec3_sub(p, camera->eye_lps_mm), camera->forward);
}

/* The least depth of what is drawn. A parallel 3-D view has no eye: there all is in front. */
static double least_depth_mm(const struct space_pen *pen)
{
    const struct camera *camera = pen->camera;
    if (camera->is_parallel)
        return snapshot_beam(pen->snapshot) ? fmin(0, camera->near_mm) : -INFINITY;
    return fmax(1e-3, camera->near_mm / 10);
}

static struct paint_point project(const struct space_pen *pen, struct vec3 p)
{
    struct vec3 clip = mat4_project(&pen->camera->clip_from_lps_mm, p);
    return (struct paint_point){ (clip.x + 1) / 2 * pen->width_px, (1 - clip.y) / 2 * pen->height_px };
}

void space_pen_line(const struct space_pen *pen, struct vec3 p, struct vec3 q, double width_px)
{
    const double least = least_depth_mm(pen), at_p = depth_mm(pen->camera, p), at_q = depth_mm(pen->camera, q);
    if (at_p < least && at_q < least)
        return;
    if (at_p < least || at_q < least) {
        struct vec3 cut = vec3_add(p, vec3_scale(vec3_sub(q, p), (least - at_p) / (at_q - at_p)));
        *(at_p < least ? &p : &q) = cut;
    }
    paint_line(pen->paint, project(pen, p), project(pen, q), width_px);
}

bool space_pen_place(const struct space_pen *pen, struct vec3 p, struct paint_point *place)
{
    *place = project(pen, p);
    return depth_mm(pen->camera, p) >= least_depth_mm(pen);
}
