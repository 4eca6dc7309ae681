#pragma once
/* Paints anti-aliased lines over a finished picture. Knows no scene and no back end. */
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
/* Queues a round-capped stroke. Strokes queued together are blended once where they overlap. Ignores NaN end points. */
void paint_line(struct paint *paint, struct paint_point a, struct paint_point b, double width_px);
/* Strokes as coverage of pixels, to be queued again without painting them anew: in pictures of the same size. */
struct paint_strokes;
/* Takes what is queued off the queue. NULL on failure, and then it is queued still. errors ERROR_MEMORY */
NODISCARD struct paint_strokes *paint_take(struct paint *paint, struct error *err);
/* Queues them; paint must have the size of the one that they were taken from. */
void paint_queue(struct paint *paint, const struct paint_strokes *strokes);
size_t paint_strokes_bytes(const struct paint_strokes *strokes); /* NULL: 0 */
void paint_strokes_destroy(struct paint_strokes *strokes);
/* Blends all queued strokes over the picture. rgb: 0xrrggbb. */
void paint_flush(struct paint *paint, uint32_t rgb, double opacity);
