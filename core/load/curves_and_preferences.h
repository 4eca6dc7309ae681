#pragma once
/* Inside core/load: what goes with a plan and is not part of the patient: reference curves, and preferences of SERA's
 * programs. A file that cannot be read is left out and reported; the plan is whole without it. */
#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/plan/plan.h"

void plan_add_curves(struct plan *plan, const struct folder *folder, const struct plan_file *file);
/* Colours, opacities and tissue data go to regions that have none from their own file; levels and colour map are kept.
 */
void plan_add_preferences(struct plan *plan, const struct folder *folder, const struct plan_file *file);
