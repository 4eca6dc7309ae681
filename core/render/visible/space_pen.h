#pragma once
/* Lines of the patient over a finished picture into space. */
#include "core/render/visible/paint.h"
#include "core/scene/snapshot.h"

struct space_pen {
    const struct snapshot *snapshot;
    const struct camera *camera;
    struct paint *paint;
    int width_px, height_px; /* of the picture */
    double scale;            /* pixels of this picture to one of the full one */
};
/* Queues a stroke from p to q, as far as it lies before the eye. */
void space_pen_line(const struct space_pen *pen, struct vec3 p_lps_mm, struct vec3 q_lps_mm, double width_px);
/* True if a point lies before the eye, and then its place. */
bool space_pen_place(const struct space_pen *pen, struct vec3 p_lps_mm, struct paint_point *place);
