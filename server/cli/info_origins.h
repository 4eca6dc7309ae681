#pragma once
/* What `beamroom info` prints of patients and treatment plans. */
#include <stdbool.h>

#include "core/plan/plan.h"

/* Patients masked, or with is_full by name, ID and birth date; then the treatment plans, the one shown first marked. */
void info_print_origins(const struct plan *plan, bool is_full);
