#pragma once
/* Lines painted over a finished picture, with smooth edges. Knows no scene and no back end. */
#include "core/base/error.h"
#include "core/base/image.h"

/* In pixels, y down; the centre of the first pixel is at 0.5, 0.5. */
struct paint_point {
    double x, y;
};

struct paint;

/* image is borrowed. errors ERROR_MEMORY */
NODISCARD struct paint *paint_create(struct image *image, struct error *err);
void paint_destroy(struct paint *paint);
/* Adds a line with round ends to what is to be painted: where lines meet or cross, the picture is not painted twice.
 * What is not a number is left out. */
void paint_line(struct paint *paint, struct paint_point a, struct paint_point b, double width_px);
/* Lays all lines added since the last time over the picture. */
void paint_flush(struct paint *paint, uint32_t rgb, double opacity);
