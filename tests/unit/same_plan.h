#pragma once
/* Whether two plans are the same to everybody who looks at them. */
#include "core/plan/plan.h"

/* Fails the test that runs, with what differs. Every field but those that say how it was opened (id, report, load_us,
 * is_from_cache, shapes) and where its parts come from (assert_same_origins). Voxels by value; matrices, and what is
 * measured from them, within mm; a layer by what it holds of its regions, wherever it stands in the list. */
void assert_same_plan(const struct plan *found, const struct plan *expected, double mm);
/* Asserts equal patients, treatment plans, registrations and the origin of each part; a converted plan has none. */
void assert_same_origins(const struct plan *found, const struct plan *expected);
