/* Adds the rows of a block column by column, then the columns: both loops are vectorised. */
#include "core/base/image_reduce.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

int image_divisor(int index)
{
    return 2 << index;
}

int image_reduced_side(int side_px, int divisor)
{
    return (side_px + divisor - 1) / divisor;
}

/* sums: [n_values], at most 4 * 255 each */
static void add_rows(const uint8_t *rows, int n_rows, size_t n_values, uint16_t *sums)
{
    memset(sums, 0, n_values * sizeof sums[0]);
    for (int row = 0; row < n_rows; row++, rows += n_values)
        for (size_t i = 0; i < n_values; i++)
            sums[i] = (uint16_t)(sums[i] + rows[i]);
}

/* Inlined with constants, so that there is no division. n: pixels of a block */
static inline void average(const uint16_t *sums, int n_blocks, int n_columns, unsigned n, uint8_t *rgba)
{
    for (int block = 0; block < n_blocks; block++, sums += 4 * n_columns, rgba += 4)
        for (int channel = 0; channel < 4; channel++) {
            unsigned sum = n / 2;
            for (int column = 0; column < n_columns; column++)
                sum += sums[4 * column + channel];
            rgba[channel] = (uint8_t)(sum / n);
        }
}

static void average_row(const uint16_t *sums, int width_px, int n_rows, int divisor, uint8_t *rgba)
{
    const int n_blocks = width_px / divisor, n_left = width_px % divisor;
    if (divisor == 2 && n_rows == 2)
        average(sums, n_blocks, 2, 4, rgba);
    else if (divisor == 4 && n_rows == 4)
        average(sums, n_blocks, 4, 16, rgba);
    else
        average(sums, n_blocks, divisor, (unsigned)(divisor * n_rows), rgba);
    if (n_left)
        average(sums + (ptrdiff_t)4 * n_blocks * divisor, 1, n_left, (unsigned)(n_left * n_rows),
                rgba + (ptrdiff_t)4 * n_blocks);
}

struct image *image_reduce(const struct image *image, int divisor, struct error *err)
{
    assert(divisor == 2 || divisor == 4); /* the sum of a block's column fits 16 bits */
    const size_t n_values = (size_t)image->width_px * 4;
    struct image *reduced =
        image_create(image_reduced_side(image->width_px, divisor), image_reduced_side(image->height_px, divisor), err);
    uint16_t *sums = mem_array(n_values, sizeof *sums, UINT64_MAX, err);
    if (!reduced || !sums) {
        image_destroy(reduced);
        free(sums);
        return NULL;
    }
    for (int row = 0; row < reduced->height_px; row++) {
        const int first = row * divisor, left = image->height_px - first, n_rows = left < divisor ? left : divisor;
        add_rows(image->rgba + (size_t)first * n_values, n_rows, n_values, sums);
        average_row(sums, image->width_px, n_rows, divisor,
                    reduced->rgba + (size_t)row * (size_t)reduced->width_px * 4);
    }
    free(sums);
    return reduced;
}
