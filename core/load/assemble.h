#pragma once
/* Builds the plan from the files that were read: images, regions, doses, beams, tracks. */
#include "core/load/loading.h"

/* Consumes what the readings hold. errors ERROR_LIMIT; those of the hierarchy's and the tracks' files */
NODISCARD bool plan_assemble(struct loading *loading, struct error *err);
