#pragma once
/* Acceptances as JSON: a list of {thing, with, by, words}, to structs and back. Thread: any. */
#include "core/scene/fit_use.h"
#include "server/wire/json.h"

/* Fills acceptances (acceptances_finish). list NULL: none. False with PROBLEM_VALIDATION, whose pointer begins with
 * /acceptances, or PROBLEM_MEMORY: nothing is filled. */
NODISCARD bool acceptances_read(const cJSON *list, struct acceptances *acceptances, struct problem *problem);
