#pragma once
/* Draws marked univels on planes (DRAW_MARKS). */
#include "core/render/soft/planes.h"

struct soft_marks {
    struct soft_plane plane; /* through the volume of marks */
    uint32_t color_rgb;
    float stripe, edge; /* in samples */
    float slack;        /* how far the picture's depth may be from the plane's */
};

/* For a picture of width x height samples; samples_per_px: of the full picture. */
void soft_marks_init(struct soft_marks *marks, const struct draw *draw, const struct mat4 *clip_from_lps_mm, int width,
                     int height, double samples_per_px);
void soft_marks_draw(const struct soft_marks *marks, const struct soft_band *band);
