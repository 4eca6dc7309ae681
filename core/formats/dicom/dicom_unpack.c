/* Turns pixel cells as stored in a file into stored values. Compiled with -O3: these loops must vectorize. Source:
 * DICOM PS3.5 8.1.1. */
#include "core/formats/dicom/dicom_unpack.h"

static void swap16(uint16_t *values, size_t n)
{
    for (size_t i = 0; i < n; i++)
        values[i] = (uint16_t)(values[i] << 8 | values[i] >> 8);
}

/* Swaps two pixels of 8 bits in each 16-bit word; the last of an odd number stays. */
static void swap_pairs(uint8_t *values, size_t n)
{
    for (size_t i = 0; i + 1 < n; i += 2) {
        uint8_t first = values[i];
        values[i] = values[i + 1];
        values[i + 1] = first;
    }
}

static void swap32(uint32_t *values, size_t n)
{
    for (size_t i = 0; i < n; i++)
        values[i] = values[i] << 24 | (values[i] & 0xFF00) << 8 | (values[i] >> 8 & 0xFF00) | values[i] >> 24;
}

/* Shifts up, then down again: drops the bits above and below the value, and extends its sign. */
#define KEEP_BITS(signed_type, unsigned_type) \
    do { \
        unsigned_type *cells = values; \
        for (size_t i = 0; i < n; i++) { \
            unsigned_type top = (unsigned_type)((uint32_t)cells[i] << up); \
            if (pixels->is_signed) \
                cells[i] = (unsigned_type)((signed_type)top >> down); \
            else \
                cells[i] = (unsigned_type)(top >> down); \
        } \
    } while (0)

void dicom_pixels_unpack(const struct dicom_pixels *pixels, bool is_swapped, void *values, size_t n)
{
    if (is_swapped && pixels->bits_allocated == 16)
        swap16(values, n);
    if (is_swapped && pixels->bits_allocated == 8)
        swap_pairs(values, n);
    if (is_swapped && pixels->bits_allocated == 32)
        swap32(values, n);
    int up = (int)(pixels->bits_allocated - 1 - pixels->high_bit),
        down = (int)(pixels->bits_allocated - pixels->bits_stored);
    if (down == 0)
        return;
    if (pixels->bits_allocated == 8)
        KEEP_BITS(int8_t, uint8_t);
    else if (pixels->bits_allocated == 16)
        KEEP_BITS(int16_t, uint16_t);
    else
        KEEP_BITS(int32_t, uint32_t);
}

#define WIDEN(type) \
    do { \
        const type *v = cells; \
        type least = v[0], most = v[0]; \
        for (size_t i = 0; i < n; i++) { \
            least = v[i] < least ? v[i] : least; \
            most = v[i] > most ? v[i] : most; \
        } \
        range[0] = least < range[0] ? least : range[0]; \
        range[1] = most > range[1] ? most : range[1]; \
    } while (0)

void dicom_cells_measure(size_t cell_size, bool is_signed, const void *cells, size_t n, int32_t range[2])
{
    if (n == 0)
        return;
    if (cell_size == 1)
        WIDEN(uint8_t);
    else if (cell_size == 2 && is_signed)
        WIDEN(int16_t);
    else if (cell_size == 2)
        WIDEN(uint16_t);
}
