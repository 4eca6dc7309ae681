#pragma once
/* Inside core/surface: helpers for extraction on bit rows, whatever the vertices are: running totals, and writing
 * vertices. Any thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/math/vec.h"

/* Replaces the counts of n rows by running totals: counts[i] becomes the index of row i's first element, counts[n] the
 * total (counts holds n + 1). Returns the total as 64 bits; entries that do not fit 32 bits are wrong, so check the
 * total before using them. */
uint64_t rows_number(uint32_t *counts, size_t n);
/* Writes a vertex for every set bit, in ascending order: bit i is at index (i + start.x, start.y, start.z). to receives
 * three floats per vertex, patient LPS, mm. */
void row_write_vertices(const uint64_t *row, uint32_t n_words, const struct affine *lps_mm_from_ijk, struct vec3 start,
                        float *to);
