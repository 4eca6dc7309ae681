#pragma once
/* The comparison of two doses that a scene asks for. Any thread. */
#include "core/derive/dose_comparison.h"
#include "core/scene/dose_scale.h"

/* Both are compared in one domain: the voxels of the first dose in the body, unless the scene or a plan without regions
 * says the whole grid, of at least the threshold; of a difference without a known reference, all of them.
 * The scene's dose against the one of dose.compare, in the scene's quantity. 100 % is the scale's reference.
 *   is_gamma  the gamma index, else the difference
 *   errors    ERROR_NOT_FOUND no second dose, or not its quantity; ERROR_RANGE it may not be drawn, or the reference is
 *             unknown */
NODISCARD bool dose_compare_of(const struct snapshot *snapshot, const struct dose_scale *scale, bool is_gamma,
                               struct dose_comparison_choice *choice, struct error *why);
