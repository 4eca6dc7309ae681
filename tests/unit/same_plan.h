#pragma once
/* Whether two plans are the same to everybody who looks at them. */
#include "core/plan/plan.h"

/* Fails the test that runs, with what differs. Voxels by value; matrices within mm; the report, load_us and label numbers are not
 * compared. */
void assert_same_plan(const struct plan *found, const struct plan *expected, double mm);
