#pragma once
/* Computes the bounds of a plan from its parts; for core/load. */
#include "core/plan/plan.h"

/* Fills bounds_lps_mm and body_lps_mm from the parts of the plan, and reports an image or a dose that overlaps no
 * region. */
void plan_measure_bounds(struct plan *plan);
