#pragma once
/* Inside core/derive: the reduction that all coarse surfaces of a plan by one algorithm have in common, as a result of
 * the store. One number for the whole plan, so that all surfaces of a moving picture are equally coarse. */
#include "core/derive/derive.h"
#include "core/surface/surface.h"

/* Most triangles of all coarse surfaces of a plan together, unless the largest reduction (8) still leaves more. */
enum { COARSE_MAX_TRIANGLES = 80000 };

/* The smallest reduction that keeps the limit; 1: the full surfaces keep it; 0 on failure. Surfaces that are built on
 * the way are kept in the store. errors ERROR_MEMORY */
NODISCARD uint32_t coarse_reduction_get(struct derive *derive, enum surface_algorithm algorithm, struct error *err);
