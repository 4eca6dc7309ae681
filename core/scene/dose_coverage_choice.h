#pragma once
/* Turns a scene's question about a region's coverage by its dose into the recipe of a result. Any thread. */
#include "core/derive/dose_coverage.h"
#include "core/scene/dose_scale.h"

/* The coverage that the snapshot's scene asks for, shown or not, with the weights and the population that its histogram
 * has: how the dose is drawn changes nothing. scale: of the snapshot, with a field.
 * errors  ERROR_NOT_FOUND no region is named and the plan has no target; a limit is in percent of an unknown
 *         reference */
NODISCARD bool dose_coverage_choice_of(const struct snapshot *snapshot, const struct dose_scale *scale,
                                       struct dose_coverage_choice *choice, struct error *why);
