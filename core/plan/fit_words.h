#pragma once
/* The sentence of a pair of parts with its code and values: fit.h judges the pair. Any thread. */
#include "core/plan/fit.h"
#include "core/sentence/sentence.h"

/* The sentence holds two others, so its values "fact" and "may" have codes of their own. */
struct fit_words {
    struct sentence_facts all, fact;
    struct sentence_facts may; /* without code where nothing is said of it */
};
/* fit_sentence, or with is_by_word fit_accepted_sentence; words: NULL is allowed. */
void fit_describe(const struct plan *plan, struct fit_part thing, struct fit_part with, enum fit_relation relation,
                  bool is_by_word, char why[FIT_WHY_SIZE], struct fit_words *words);
