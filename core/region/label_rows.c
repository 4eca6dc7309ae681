/* Finds runs and faces in label rows by comparing whole words. */
#include "core/region/label_rows.h"

#include <string.h>

static inline uint64_t load_word(const void *at)
{
    uint64_t word;
    memcpy(&word, at, sizeof word);
    return word;
}

#define DEFINE_ROWS(type) \
    static uint32_t run_end_##type(const type *row, uint32_t i, uint32_t n) \
    { \
        const uint32_t step = sizeof(uint64_t) / sizeof(type); \
        type label = row[i]; \
        uint64_t all = label * (UINT64_MAX / (type)-1); \
        i++; \
        while (i + step <= n && load_word(row + i) == all) \
            i += step; \
        while (i < n && row[i] == label) \
            i++; \
        return i; \
    } \
    /* Counts the pairs (row[i], other[i]); pairs along the row itself if other is row + 1. */ \
    static void row_faces_##type(const type *row, const type *other, uint32_t n, const uint16_t *slot, size_t n_slots, \
                                 uint64_t *faces) \
    { \
        const uint32_t step = sizeof(uint64_t) / sizeof(type); \
        for (uint32_t i = 0; i < n;) { \
            if (i + step <= n && load_word(row + i) == load_word(other + i)) { \
                i += step; \
                continue; \
            } \
            uint32_t end = i + step < n ? i + step : n; \
            for (; i < end; i++) \
                if (row[i] != other[i]) { \
                    faces[slot[row[i]] * n_slots + slot[other[i]]]++; \
                    faces[slot[other[i]] * n_slots + slot[row[i]]]++; \
                } \
        } \
    }

DEFINE_ROWS(uint8_t)
DEFINE_ROWS(uint16_t)

uint32_t label_row_end(enum voxel_type type, const void *row, uint32_t i, uint32_t n)
{
    return type == VOXEL_U8 ? run_end_uint8_t(row, i, n) : run_end_uint16_t(row, i, n);
}

#define RUNS(type) \
    do { \
        const type *row = layer->voxels; \
        for (uint32_t k = 0; k < size[2]; k++) \
            for (uint32_t j = 0; j < size[1]; j++, row += size[0]) \
                for (uint32_t i = 0; i < size[0];) { \
                    uint32_t end = run_end_##type(row, i, size[0]); \
                    if (row[i] != 0) \
                        run(context, row[i], i, j, k, end - i); \
                    i = end; \
                } \
    } while (0)

void label_rows_runs(const struct volume *layer,
                     void (*run)(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length),
                     void *context)
{
    const uint32_t *size = layer->grid.size;
    if (layer->type == VOXEL_U8)
        RUNS(uint8_t);
    else
        RUNS(uint16_t);
}

#define FACES(type) \
    do { \
        const type *row = layer->voxels; \
        size_t slice = (size_t)size[0] * size[1]; \
        for (uint32_t k = 0; k < size[2]; k++) \
            for (uint32_t j = 0; j < size[1]; j++, row += size[0]) { \
                row_faces_##type(row, row + 1, size[0] - 1, slot, n_slots, faces); \
                if (j + 1 < size[1]) \
                    row_faces_##type(row, row + size[0], size[0], slot, n_slots, faces); \
                if (k + 1 < size[2]) \
                    row_faces_##type(row, row + slice, size[0], slot, n_slots, faces); \
                border[slot[row[0]]]++; \
                border[slot[row[size[0] - 1]]]++; \
                uint32_t outer = (uint32_t)((j == 0) + (j + 1 == size[1]) + (k == 0) + (k + 1 == size[2])); \
                for (uint32_t i = 0; outer > 0 && i < size[0]; i++) \
                    border[slot[row[i]]] += outer; \
            } \
    } while (0)

void label_rows_faces(const struct volume *layer, const uint16_t *slot, size_t n_slots, uint64_t *faces,
                      uint64_t *border)
{
    const uint32_t *size = layer->grid.size;
    if (layer->type == VOXEL_U8)
        FACES(uint8_t);
    else
        FACES(uint16_t);
}
