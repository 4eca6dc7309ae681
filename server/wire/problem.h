#pragma once
/* RFC 9457 problem details: why a request or message was refused, for people and programs alike. */
#include <cjson/cJSON.h>

#include "core/base/error.h"
#include "problem_gen.h" /* enum problem_type and its words, from proto/problems.json */

struct problem {
    enum problem_type type;
    char code[32];      /* validation: "type", "range", "enum", "unknown-field", "required", "duplicate", "length",
                         "pattern", "count",      "unknown-id" */
    char pointer[160];  /* RFC 6901, "/image/window/width"; "" the whole */
    char detail[320];   /* a sentence: what was found, what was expected */
    int retry_after_ms; /* 0: not said */
};

/* Fills problem (NULL is allowed) and returns false. */
bool problem_set(struct problem *problem, enum problem_type type, const char *pointer, const char *code,
                 const char *format, ...) PRINTF_LIKE(5, 6);
/* Puts prefix before the pointer: what was checked alone is a part of something larger. */
void problem_below(struct problem *problem, const char *prefix);
/* From an error of core: not-found 404, range, format, unsupported 422, limit 429, cancelled 409, gl 503, else 500.
 * Returns false. */
bool problem_from_error(struct problem *problem, const struct error *err);
int problem_status(enum problem_type type);       /* HTTP status */
const char *problem_word(enum problem_type type); /* "validation" */
/* {type: "/problems/validation", title, status, detail, pointer?, code?, retry_after_ms?} */
NODISCARD cJSON *problem_to_json(const struct problem *problem);
/* From such an object, untrusted: false when it is none, and problem is then PROBLEM_INTERNAL. */
bool problem_from_json(const cJSON *json, struct problem *problem);
