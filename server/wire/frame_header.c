/* The header in front of each picture: little-endian bytes, whatever the machine. */
#include "server/wire/frame_header.h"

#include <math.h>
#include <string.h>

#include "core/base/image_reduce.h"

static void put16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

static void put32(uint8_t *at, uint32_t value)
{
    put16(at, (uint16_t)value);
    put16(at + 2, (uint16_t)(value >> 16));
}

static uint16_t get16(const uint8_t *at)
{
    return (uint16_t)(at[0] | at[1] << 8);
}

static uint32_t get32(const uint8_t *at)
{
    return (uint32_t)get16(at) | (uint32_t)get16(at + 2) << 16;
}

struct frame_header frame_header_reduced(const struct frame_header *header, int divisor)
{
    struct frame_header reduced = *header;
    reduced.width_px = (uint16_t)image_reduced_side(header->width_px, divisor);
    reduced.height_px = (uint16_t)image_reduced_side(header->height_px, divisor);
    reduced.flags |= divisor == 2 ? FRAME_HALF : FRAME_QUARTER;
    /* the view's share of the reduced picture; it begins at the left and at the top, where clip space has -1 and 1 */
    const double across = (double)header->width_px / (divisor * reduced.width_px),
                 down = (double)header->height_px / (divisor * reduced.height_px);
    for (float *column = reduced.clip_from_lps_mm; column < reduced.clip_from_lps_mm + 16; column += 4) {
        const double w = (double)column[3];
        column[0] = (float)(across * (double)column[0] + (across - 1) * w);
        column[1] = (float)(down * (double)column[1] + (1 - down) * w);
    }
    return reduced;
}

void frame_header_write(const struct frame_header *header, uint8_t bytes[FRAME_HEADER_BYTES])
{
    put32(bytes, FRAME_MAGIC);
    put16(bytes + 4, FRAME_VERSION);
    put16(bytes + 6, FRAME_HEADER_BYTES);
    bytes[8] = header->codec;
    bytes[9] = header->flags;
    bytes[10] = header->quality;
    bytes[11] = header->scale_percent;
    put32(bytes + 12, header->view);
    put32(bytes + 16, header->sequence);
    put32(bytes + 20, header->scene_revision);
    put32(bytes + 24, header->input_id);
    put16(bytes + 28, header->width_px);
    put16(bytes + 30, header->height_px);
    put32(bytes + 32, header->render_us);
    put32(bytes + 36, header->encode_us);
    put32(bytes + 40, header->payload_bytes);
    put32(bytes + 44, header->pixels_per_mm_1000);
    for (int i = 0; i < 16; i++) {
        uint32_t word;
        memcpy(&word, &header->clip_from_lps_mm[i], sizeof word);
        put32(bytes + 48 + 4 * i, word);
    }
}

bool frame_header_read(const uint8_t *bytes, size_t n, struct frame_header *header, size_t *header_bytes,
                       struct error *err)
{
    if (n < FRAME_HEADER_BYTES)
        return error_set(err, ERROR_FORMAT, "a frame of %zu bytes, at least %d were expected", n, FRAME_HEADER_BYTES);
    if (get32(bytes) != FRAME_MAGIC)
        return error_set(err, ERROR_FORMAT, "a frame begins with 0x%08x at byte 0, expected 0x%08x", get32(bytes),
                         FRAME_MAGIC);
    if (get16(bytes + 4) != FRAME_VERSION)
        return error_set(err, ERROR_FORMAT, "frame version %u at byte 4, expected %d", get16(bytes + 4), FRAME_VERSION);
    size_t head = get16(bytes + 6);
    if (head < FRAME_HEADER_BYTES || head > n)
        return error_set(err, ERROR_FORMAT, "header_bytes %zu at byte 6, expected %d to %zu", head, FRAME_HEADER_BYTES,
                         n);
    *header = (struct frame_header){ .codec = bytes[8],
                                     .flags = bytes[9],
                                     .quality = bytes[10],
                                     .scale_percent = bytes[11],
                                     .view = get32(bytes + 12),
                                     .sequence = get32(bytes + 16),
                                     .scene_revision = get32(bytes + 20),
                                     .input_id = get32(bytes + 24),
                                     .width_px = get16(bytes + 28),
                                     .height_px = get16(bytes + 30),
                                     .render_us = get32(bytes + 32),
                                     .encode_us = get32(bytes + 36),
                                     .payload_bytes = get32(bytes + 40),
                                     .pixels_per_mm_1000 = get32(bytes + 44) };
    if (header->payload_bytes != n - head)
        return error_set(err, ERROR_FORMAT, "payload_bytes %u at byte 40, but %zu bytes follow the header",
                         header->payload_bytes, n - head);
    if (header->codec != 1 && header->codec != 2)
        return error_set(err, ERROR_FORMAT, "codec %u at byte 8, expected 1 (JPEG) or 2 (PNG)", header->codec);
    if (header->scale_percent < 10 || header->scale_percent > 100)
        return error_set(err, ERROR_FORMAT, "scale_percent %u at byte 11, expected 10 to 100", header->scale_percent);
    if (header->width_px == 0 || header->height_px == 0)
        return error_set(err, ERROR_FORMAT, "a picture of %u x %u pixels at byte 28", header->width_px,
                         header->height_px);
    for (int i = 0; i < 16; i++) {
        uint32_t word = get32(bytes + 48 + 4 * i);
        memcpy(&header->clip_from_lps_mm[i], &word, sizeof word);
        if (!isfinite(header->clip_from_lps_mm[i]))
            return error_set(err, ERROR_FORMAT, "clip_from_lps_mm[%d] at byte %d is not finite", i, 48 + 4 * i);
    }
    *header_bytes = head;
    return true;
}
