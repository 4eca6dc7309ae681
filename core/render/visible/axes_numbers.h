#pragma once
/* Numbers at the ticks of the patient axes: mm from where the ticks are counted. Drawn as strokes, so that pictures of
 * every back end, size and pixel ratio have the same. */
#include "core/render/visible/space_pen.h"

/* Along the line from from_lps_mm to to_lps_mm: each 50 mm, or in larger steps where these would touch. A number that
 * would cover one of another line, stand at the line's end or near the edge of the picture is left out; the last one
 * has its unit. */
struct axes_numbers_line {
    struct vec3 from_lps_mm, to_lps_mm;
    bool has_letter;       /* at its end */
    const double *away_px; /* [2] where numbers stand on the other side from; NULL: they stand below or right */
};
enum { AXES_NUMBERS_LINES = 6 };
/* Paints them with a rim of halo_rgb. n <= AXES_NUMBERS_LINES */
void axes_numbers_paint(const struct space_pen *pen, const struct axes_numbers_line *lines, size_t n, uint32_t rgb,
                        uint32_t halo_rgb, double opacity);
