#pragma once
/* Makes ids for the parts that are added to a plan, and checks the limit on its doses. */
#include "core/plan/plan.h"

/* Makes an id that may stand in a URL: from the id the plan gives, else from the file's name; different from others. */
void plan_make_id(char id[64], const char *given, const char *path, const char *const *others, size_t n_others);

/* Returns false when the plan holds PLAN_MAX_DOSES doses, and reports the dose, of the file where, as left out. */
NODISCARD bool plan_has_room_for_dose(struct plan *plan, const char *id, const char *where);
