#pragma once
/* Estimates the memory that loading a plan will take, from headers alone, before the first voxel is allocated. */
#include "core/load/loading.h"

/* Estimates the bytes at the peak, within PLAN_ESTIMATE_FACTOR of the true value either way. largest: receives the
 * reading that needs most. */
uint64_t plan_estimate(const struct loading *loading, const struct part_reading **largest);
/* Compares the estimate with loading's max_bytes. errors ERROR_LIMIT it is above; the text names both and the largest
 * part */
NODISCARD bool plan_check_estimate(const struct loading *loading, struct error *err);
