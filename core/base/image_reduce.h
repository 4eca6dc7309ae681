#pragma once
/* A picture at a half or a quarter of its size, by an exact box filter: each pixel is the mean of a block of pixels. */
#include "core/base/image.h"

/* There are two: to a half, and to a quarter. */
enum { IMAGE_N_REDUCED = 2 };
/* The divisor of each: 2, 4. */
int image_divisor(int index);

/* Each pixel is the mean of divisor x divisor pixels, channel by channel, rounded to the nearest (halves up). Means are
 * of the values as they are stored (sRGB), in which the greys of a slice are proportional to its image values: so a
 * pixel has the grey of the mean image value. Where a side is no multiple of divisor, the last blocks hold the pixels
 * that are left, and the side is the next whole number: the last column or row then stands for less of the picture
 * than the others. All divisors are applied to the picture itself: a quarter is no half of a half, rounded twice.
 *
 *   divisor  2 or 4
 *   returns  the caller's; equal input gives equal bytes. NULL on failure.
 *   errors   ERROR_MEMORY
 *   thread   any */
NODISCARD struct image *image_reduce(const struct image *image, int divisor, struct error *err);
/* A side of the reduced picture: side_px / divisor, rounded up. */
int image_reduced_side(int side_px, int divisor);
