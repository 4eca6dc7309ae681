#pragma once
/* Inside core/surface: what extraction by rows of bits does whatever the vertices are: number them, and write them. */
#include <stddef.h>
#include <stdint.h>

#include "core/math/vec.h"

/* Counts of n rows become the numbers of their first, the total that of the row after the last; counts holds n + 1.
 * Gives the total: numbers that no longer fit 32 bits are wrong, so the caller refuses such a total before it uses
 * them. */
uint64_t rows_number(uint32_t *counts, size_t n);
/* A vertex for every bit that is set, in order: bit i stands for the index i + start.x, start.y, start.z. to holds
 * three floats each. */
void row_write_vertices(const uint64_t *row, uint32_t n_words, const struct affine *lps_mm_from_ijk, struct vec3 start,
                        float *to);
