#pragma once
/* Rows of samples between the drawing and the picture: cleared, written as pixels, their depths kept. Any thread, a
 * band each. */
#include "core/render/soft/frame.h"

void soft_rows_clear(const struct soft_band *band, const uint8_t rgb[3]);
/* Into the picture, halved where it has four samples a pixel. */
void soft_rows_write(const struct soft_frame *frame, const struct soft_kernels *kernels, const struct soft_band *band);
/* Keeps the depths of the band's pixels in the list: those of opaque shapes, then, negative, those of planes before
 * them. */
void soft_rows_keep_depth(const struct soft_frame *frame, const struct soft_band *band, bool has_planes);
/* Keeps also the depths of the volume, where it is nearer and has absorbed half of the light. */
void soft_rows_keep_volume_depth(const struct soft_frame *frame, const struct soft_kernels *kernels,
                                 const struct soft_band *band);
