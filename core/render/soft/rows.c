/* Rows of samples between the drawing and the picture: cleared, written as pixels, their depths kept. */
#include "core/render/soft/rows.h"

#include <math.h>
#include <string.h>

void soft_rows_clear(const struct soft_band *band, const uint8_t rgb[3])
{
    uint32_t color = (uint32_t)rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16 | 0xff000000u;
    for (size_t i = 0; i < (size_t)band->stride * (size_t)band->n_rows; i++) {
        band->depth[i] = 1;
        band->color[i] = color;
    }
}

void soft_rows_write(const struct soft_frame *frame, const struct soft_kernels *kernels, const struct soft_band *band)
{
    size_t width_px = (size_t)frame->image->width_px;
    for (int y = 0; y < band->n_rows; y += frame->list->samples) {
        const uint32_t *from = band->color + (size_t)y * (size_t)band->stride;
        uint8_t *to = frame->image->rgba + (size_t)((band->first_row + y) / frame->list->samples) * width_px * 4;
        if (frame->list->samples == 2)
            kernels->halve(from, from + band->stride, (int)width_px, (uint32_t *)(void *)to);
        else
            memcpy(to, from, width_px * 4);
    }
}

void soft_rows_keep_depth(const struct soft_frame *frame, const struct soft_band *band, bool has_planes)
{
    int samples = frame->list->samples, width_px = frame->image->width_px;
    for (int y = 0; y < band->n_rows; y += samples) {
        float *to = frame->list->depth + (size_t)((band->first_row + y) / samples) * (size_t)width_px;
        const float *from = band->depth + (size_t)y * (size_t)band->stride;
        for (int x = 0; x < width_px; x++) {
            float depth = 0.5f * from[x * samples] + 0.5f; /* the band's is -1 .. 1 */
            if (!has_planes)
                to[x] = depth;
            else if (depth < to[x])
                to[x] = -depth;
        }
    }
}

void soft_rows_keep_volume_depth(const struct soft_frame *frame, const struct soft_kernels *kernels,
                                 const struct soft_band *band)
{
    const struct soft_volume_kernels *volume_kernels = soft_volume_kernels_of(kernels);
    const int samples = frame->list->samples, width_px = frame->image->width_px;
    struct soft_volume per_pixel;
    soft_volume_per_pixel(frame->volume, &per_pixel);
    for (int y = 0; y < band->n_rows; y += samples) {
        const int row = (band->first_row + y) / samples;
        float *to = frame->list->depth + (size_t)row * (size_t)width_px;
        const float *from = band->depth + (size_t)y * (size_t)band->stride;
        for (int x = 0; x < width_px; x += SOFT_LANES) {
            const int n = width_px - x < SOFT_LANES ? width_px - x : SOFT_LANES;
            float opaque[SOFT_LANES] = { 0 }, depth[SOFT_LANES];
            for (int l = 0; l < n; l++)
                opaque[l] = from[(x + l) * samples];
            volume_kernels->depths(&per_pixel, x, row, opaque, depth);
            for (int l = 0; l < n; l++)
                if (fabsf(depth[l]) < fabsf(to[x + l]))
                    to[x + l] = depth[l];
        }
    }
}
