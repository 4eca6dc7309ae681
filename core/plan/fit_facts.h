#pragma once
/* What the judgement of pairs knows of one part, for the words about it (fit_words.h). Any thread. */
#include "core/plan/fit.h"

/* Where a part comes from; of a part without an origin one that says nothing. */
const struct part_origin *fit_origin_of(const struct plan *plan, struct fit_part part);
/* NULL: none that is here. */
const struct treatment_plan *fit_treatment_plan_of(const struct plan *plan, const struct part_origin *origin);
/* True if a dose has weighted components alone. */
bool fit_is_weighted_alone(const struct dose *dose);
