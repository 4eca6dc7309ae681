#pragma once
/* The fixed header in front of each picture sent to a browser (proto/frame.md): little-endian bytes to a struct and
 * back. Thread: any. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { FRAME_HEADER_BYTES = 112, FRAME_VERSION = 1 };
#define FRAME_MAGIC 0x524D5242u
enum frame_flag {
    FRAME_STILL = 1,
    FRAME_LOSSLESS = 2,
    FRAME_FULL_COLOR = 4,
    FRAME_SHARED = 8,
    FRAME_COARSE = 16,
    FRAME_HALF = 32,
    FRAME_QUARTER = 64
};

struct frame_header {
    uint8_t codec, flags, quality, scale_percent;
    uint32_t view, sequence, scene_revision, input_id;
    uint16_t width_px, height_px;
    uint32_t render_us, encode_us, payload_bytes, pixels_per_mm_1000;
    float clip_from_lps_mm[16];
};

/* The header of the same picture reduced to a half or a quarter (core/base/image_reduce.h): with its size and its flag.
 * A reduced picture whose sides were rounded up reaches a little beyond the view: its matrix says so, and maps a point
 * to the very place in the picture where it is seen. payload_bytes stays. */
struct frame_header frame_header_reduced(const struct frame_header *header, int divisor);
void frame_header_write(const struct frame_header *header, uint8_t bytes[FRAME_HEADER_BYTES]);
/* n: the whole message. errors ERROR_FORMAT with what and where; header_bytes: where the picture starts */
NODISCARD bool frame_header_read(const uint8_t *bytes, size_t n, struct frame_header *header, size_t *header_bytes,
                                 struct error *err);
