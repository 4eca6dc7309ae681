#pragma once
/* RFC 9457 problem details: why a request or message was refused, for people and programs alike. */
#include <cjson/cJSON.h>

#include "core/base/error.h"

enum problem_type {
    PROBLEM_NONE,
    PROBLEM_JSON,            /* 400 the body is not JSON (or not UTF-8, or too deep) */
    PROBLEM_VALIDATION,      /* 422 a field is wrong: pointer says which, code how */
    PROBLEM_FORBIDDEN,       /* 403 asked for by a page of another origin */
    PROBLEM_NOT_FOUND,       /* 404 */
    PROBLEM_METHOD,          /* 405 */
    PROBLEM_STALE_REVISION,  /* 412 If-Match names another revision than the current */
    PROBLEM_REVISION_NEEDED, /* 428 PATCH of shared state without If-Match */
    PROBLEM_TOO_LARGE,       /* 413 */
    PROBLEM_MEDIA_TYPE,      /* 415 */
    PROBLEM_UPGRADE,         /* 426 open the WebSocket on a fresh connection */
    PROBLEM_BUSY,            /* 503 try again after retry_after_ms */
    PROBLEM_PLAN_UNREADABLE, /* 409 the plan cannot be loaded; detail is the reason */
    PROBLEM_RENDERER,        /* 503 the renderer stopped while answering; it is being restarted */
    PROBLEM_GL,              /* 503 no way to draw on this machine */
    PROBLEM_LIMIT,           /* 429 more rooms, members, views, requests than configured */
    PROBLEM_TIMEOUT,         /* 504 */
    PROBLEM_CANCELLED,       /* 409 somebody cancelled the job */
    PROBLEM_INTERNAL,        /* 500 */
    PROBLEM_N_TYPES
};

struct problem {
    enum problem_type type;
    char code[32];      /* validation: "type", "range", "enum", "unknown-field", "required", "duplicate", "length", "pattern", "count" */
    char pointer[160];  /* RFC 6901, "/image/window/width"; "" the whole */
    char detail[256];   /* a sentence: what was found, what was expected */
    int retry_after_ms; /* 0: not said */
};

/* Fills problem (NULL is allowed) and returns false. */
bool problem_set(struct problem *problem, enum problem_type type, const char *pointer, const char *code, const char *format, ...)
    PRINTF_LIKE(5, 6);
/* From an error of core: not-found 404, range, format, unsupported 422, limit 429, cancelled 409, gl 503, else 500. Returns false. */
bool problem_from_error(struct problem *problem, const struct error *err);
int problem_status(enum problem_type type);       /* HTTP status */
const char *problem_word(enum problem_type type); /* "validation" */
/* {type: "/problems/validation", title, status, detail, pointer?, code?, retry_after_ms?} */
NODISCARD cJSON *problem_to_json(const struct problem *problem);
/* From such an object, untrusted: false when it is none, and problem is then PROBLEM_INTERNAL. */
bool problem_from_json(const cJSON *json, struct problem *problem);
