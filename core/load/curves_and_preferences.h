#pragma once
/* Adds reference curves, and the preferences of SERA's programs, to a plan. A file that cannot be read is reported and
 * left out, as nothing of the patient depends on it. */
#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/plan/plan.h"

void plan_add_curves(struct plan *plan, const struct folder *folder, const struct plan_file *file);
/* Gives colours, opacities and tissue data to regions that have none from their own file; keeps isodose levels and the
 * colour map in plan->preferences. */
void plan_add_preferences(struct plan *plan, const struct folder *folder, const struct plan_file *file);
