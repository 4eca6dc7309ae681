#pragma once
/* The code and the values of a sentence in JSON: beside the member "detail" stand "detail_code", a text, and
 * "detail_values", an object, which is missing where the sentence has no places. Any thread. */
#include <cjson/cJSON.h>

#include "core/plan/fit_words.h"
#include "core/sentence/sentence.h"

/* Adds nothing where the sentence has no code. name: of the member with the sentence. */
void sentence_add_json(cJSON *object, const char *name, const struct sentence_facts *facts);
/* Like sentence_add_json, for a sentence that holds two others. */
void fit_words_add_json(cJSON *object, const char *name, const struct fit_words *words);
/* Adds a text (NULL: null) and, where it is a sentence of the list that has no places, its code. */
void reason_add_json(cJSON *object, const char *name, const char *text);
/* Reads what is not trusted: facts without code where it is not as the code's sentence has it. */
void sentence_read_json(const cJSON *object, const char *name, struct sentence_facts *facts);
