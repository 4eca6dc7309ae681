#pragma once
/* The table "what fits what" of the plan document: the judgements of core/plan/fit.h, without a scene. Thread: any. */
#include "core/plan/fit.h"
#include "server/wire/json.h"

/* [{thing, with, relation, reasons, reason, needs}]: each dose, beam, source of regions and the tracks with each image,
 * each image with each other one; and those pairs with a dose that do not fit (in a plan
 * without images also a dose with itself). Words as in core/plan/fit.h. */
NODISCARD cJSON *plan_fits_array(const struct plan *plan);
