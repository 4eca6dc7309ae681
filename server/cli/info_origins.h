#pragma once
/* Prints patients and treatment plans for `beamroom info`. */
#include <stdbool.h>

#include "core/plan/plan.h"

/* Patients masked, or with is_full by name, ID and birth date; then the treatment plans, the one shown first marked. */
void info_print_origins(const struct plan *plan, bool is_full);
