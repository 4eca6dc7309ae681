#pragma once
/* Weighted sums of volumes, over runs of voxels: as fast as memory. Knows no grid and no weights' meaning. Any thread.
 */
#include <stdbool.h>
#include <stddef.h>

#include "core/dose/dose.h"

/* sum[i] = (before[i] + (raw[0][i] factor[0] + offset[0])) + (raw[1][i] factor[1] + offset[1]) ...; not a number where
 * that is not finite. before: NULL: the sum begins with the first term; may be sum itself. n_terms >= 1. range:
 * smallest and largest finite sum, widened. is_streaming: the sums are not read soon, so they bypass the cache; another
 * thread may read them after dose_combine_flush. */
void dose_combine(const float *const *raw, const float *factor, const float *offset, size_t n_terms, size_t n,
                  const float *before, float *sum, bool is_streaming, float range[2]);
void dose_combine_flush(void);
