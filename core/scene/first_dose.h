#pragma once
/* The style of the plan's first dose in a new room, once it is switched on. */
#include "core/plan/plan.h"
#include "scene.h" /* generated from proto/scene.json */

/* Fills quantity, sum, weights, levels and reference of a style of defaults. Doses of all beams of a plan are summed.
 * Weights are those of the regions' files; where none has any, those of the first preset, by the regions' names, as an
 * example that weights_name says. A plan without physical components has no weights. scene_finish frees them. */
void scene_first_dose(const struct plan *plan, struct scene_dose_style *style);
