/* Running totals and vertex positions for extraction on bit rows. */
#include "core/surface/bit_rows.h"

uint64_t rows_number(uint32_t *counts, size_t n)
{
    uint64_t total = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t count = counts[i];
        counts[i] = (uint32_t)total;
        total += count;
    }
    counts[n] = (uint32_t)total;
    return total;
}

void row_write_vertices(const uint64_t *row, uint32_t n_words, const struct affine *lps_mm_from_ijk, struct vec3 start,
                        float *to)
{
    for (uint32_t w = 0; w < n_words; w++)
        for (uint64_t left = row[w]; left; left &= left - 1) {
            double i = 64.0 * w + __builtin_ctzll(left) + start.x;
            struct vec3 p = affine_point(lps_mm_from_ijk, vec3(i, start.y, start.z));
            *to++ = (float)p.x;
            *to++ = (float)p.y;
            *to++ = (float)p.z;
        }
}
