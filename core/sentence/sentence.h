#pragma once
/* The code and the values of an English sentence, so that a page can say it in another language: proto/sentences.json
 * lists the sentences. A sentence is known by the format that it was written with, so the code that says it does not
 * name it twice. Must never know who says a sentence, and no JSON. Allocates nothing. Any thread. */
#include <stdarg.h>

#include "core/base/error.h"
#include "sentences_gen.h" /* struct sentence, from proto/sentences.json */

enum { SENTENCE_CODE_SIZE = 48, SENTENCE_VALUES_SIZE = 400 };
#define SENTENCE_BREAK '\x1f' /* stands between two values */

/* Both "" where the sentence is not in the list, or its values do not fit. */
struct sentence_facts {
    char code[SENTENCE_CODE_SIZE];
    char values[SENTENCE_VALUES_SIZE]; /* in the order of the places: texts as they are, numbers in decimal */
};

/* The facts of a sentence that is being written by vprintf with this format and these arguments, which are used up. */
void sentence_describe(struct sentence_facts *facts, const char *format, va_list args);
/* Like sentence_describe, for a sentence that is written as subject, a space, and the rest by this format. */
void sentence_describe_of(struct sentence_facts *facts, const char *subject, const char *format, va_list args);
/* NULL: no sentence has this code. Sentences of one code have the same names in the same order. */
const struct sentence *sentence_find(const char *code);
/* Adds a value behind those that are there. False: no place for it. */
NODISCARD bool sentence_add_text(struct sentence_facts *facts, bool is_first, const char *text, int precision);
/* The number as English has it: a place of a whole number gets no fraction. */
NODISCARD bool sentence_add_number(struct sentence_facts *facts, bool is_first, const struct sentence_place *place,
                                   double number);
