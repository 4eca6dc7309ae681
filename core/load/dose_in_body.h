#pragma once
/* Inside core/load: the largest value of each dose inside the patient. */
#include "core/plan/plan.h"

/* Grids with more voxels are not searched: their body_high stays unknown. */
enum { PLAN_BODY_MAX_VOXELS = 4 << 20 };
/* Outside the regions a value may be so many times the largest inside before it is worth a line. */
enum { PLAN_ABSURD_TIMES = 10 };

/* Fills body_high of all doses from the voxels whose centres lie in a region and are valid; reports values outside that
 * would spoil any scale. Without regions nothing is known. */
void plan_measure_body(struct plan *plan);
