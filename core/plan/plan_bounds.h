#pragma once
/* Inside core/plan: where the parts of a plan lie. */
#include "core/plan/plan.h"

/* Fills bounds_lps_mm from what was loaded, and reports parts that lie apart from the regions. */
void plan_measure_bounds(struct plan *plan);
