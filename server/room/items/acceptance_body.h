#pragma once
/* Body of an acceptance, by which a person has two parts of a plan used together though they do not fit: {thing, with,
 * reason, words}. thing and with are "KIND:ID". Checks it against the pairs that the plan's document lists in fits,
 * which the renderer decides (core/plan/fit.h). Knows nothing of rooms; server/http checks the same of a call. */
#include "server/wire/json.h"
#include "server/wire/problem.h"

enum {
    ACCEPTANCE_MAX = 64,         /* that count at once, and in one call */
    ACCEPTANCE_MAX_WORDS = 300,  /* characters */
    ACCEPTANCE_MIN_LETTERS = 10, /* of the words: letters and digits of any script */
    ACCEPTANCE_PART_SIZE = 80    /* of "KIND:ID" with its final zero */
};

/* The pair's entry of fits, whichever of the two is named first; NULL: there is none. */
const cJSON *acceptance_fit(const cJSON *plan, const char *thing, const char *with);
/* A person's own words for a judgement: ACCEPTANCE_MIN_LETTERS letters and ACCEPTANCE_MAX_WORDS characters. */
NODISCARD bool acceptance_words_check(const cJSON *words, const char *pointer, struct problem *problem);
/* Checks the four fields. plan NULL: a kept acceptance, whose parts the plan may not have any more. False with problem:
 * validation; or forbidden with the code never, for a pair that nobody can accept. where: pointer of the object. */
NODISCARD bool acceptance_check(const cJSON *plan, const cJSON *body, const char *where, struct problem *problem);
