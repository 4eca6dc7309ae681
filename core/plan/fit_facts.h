#pragma once
/* Facts about one part that the judgement of pairs goes by, for the words about it (fit_words.h). Any thread. */
#include "core/plan/fit.h"

/* Origin of a part; one that says nothing where the part has none. */
const struct part_origin *fit_origin_of(const struct plan *plan, struct fit_part part);
/* NULL: the part has none, or it is not in the folder. */
const struct treatment_plan *fit_treatment_plan_of(const struct plan *plan, const struct part_origin *origin);
/* True if a dose has weighted components alone. */
bool fit_is_weighted_alone(const struct dose *dose);
