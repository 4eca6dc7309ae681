#pragma once
/* JPEG 2000 codestreams of made-up values, encoded by OpenJPEG. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct made_j2k {
    uint32_t columns, rows, bits;
    bool is_signed, is_lossy, is_boxed;
    uint32_t tile; /* side of a tile; 0: one tile */
};
/* Encodes value(x, y) for each pixel. The caller frees the bytes. */
uint8_t *made_j2k_bytes(const struct made_j2k *like, int32_t (*value)(uint32_t x, uint32_t y), size_t *size);
