#pragma once
/* Finds the largest value of each dose inside the patient. */
#include "core/plan/plan.h"

/* A grid with more voxels is not searched; its body_high stays unknown. */
enum { PLAN_BODY_MAX_VOXELS = 4 << 20 };
/* A value outside the regions is reported if it exceeds this multiple of the largest inside. */
enum { PLAN_ABSURD_TIMES = 10 };

/* Fills body_high of all doses from the voxels whose centres lie in a region and in the dose's mask. Reports a dose
 * with far larger values outside, which would spoil any scale. Does nothing for a plan without regions. */
void plan_measure_body(struct plan *plan);
