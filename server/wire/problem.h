#pragma once
/* RFC 9457 problem details: why a request or message was refused, for programs (type, code, pointer) and for people (a
 * sentence). Fixed size, so that it can be filled without memory. Thread: any. */
#include <cjson/cJSON.h>

#include "core/base/error.h"
#include "core/sentence/sentence.h"
#include "problem_gen.h" /* enum problem_type and its words, from proto/problems.json */

struct problem {
    enum problem_type type;
    /* forbidden: role, or "". validation: type, range, enum, unknown-field, required, duplicate, length, pattern,
     * count, order or unknown-id; "" for other types. */
    char code[32];
    char pointer[160];           /* RFC 6901: "/image/window/width"; "" the whole document */
    char detail[320];            /* a sentence: what was found, what was expected */
    int retry_after_ms;          /* 0: not given */
    struct sentence_facts facts; /* of the sentence */
};

/* Fills problem (NULL is allowed) and returns false: `return problem_set(...);` is a whole failure. */
bool problem_set(struct problem *problem, enum problem_type type, const char *pointer, const char *code,
                 const char *format, ...) PRINTF_LIKE(5, 6);
/* Puts prefix in front of the pointer, for a document that was checked alone and is a part of a larger one. */
void problem_below(struct problem *problem, const char *prefix);
/* Fills problem from an error of core. HTTP status by its code: not-found 404; range, format, unsupported 422; limit
 * 429; cancelled 409; gl, state, memory 503; else 500. Returns false. */
bool problem_from_error(struct problem *problem, const struct error *err);
int problem_status(enum problem_type type);       /* HTTP status; 500 for an unknown type */
const char *problem_word(enum problem_type type); /* "validation"; "internal" for an unknown type */
/* {type: "/problems/validation", title, status, detail, detail_code?, detail_values?, pointer?, code?, retry_after_ms?}
 */
NODISCARD cJSON *problem_to_json(const struct problem *problem);
/* Reads such an object, which is not trusted. False when it is malformed: problem is then of type internal. */
bool problem_from_json(const cJSON *json, struct problem *problem);
