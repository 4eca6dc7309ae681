#pragma once
/* JSON text to documents and back, with limits: everything from outside that is JSON is parsed here. Documents are
 * cJSON trees with one owner. Thread: any. */
#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdint.h>

#include "server/wire/problem.h"

enum { JSON_MAX_DEPTH = 32 };

/* Parses exactly n bytes: valid UTF-8 without NUL, at most JSON_MAX_DEPTH levels, nothing but white space after the
 * value. NULL with a problem of type "json". The caller bounds n. */
NODISCARD cJSON *json_read(const char *bytes, size_t n, struct problem *problem);
/* Compact text, for free(). Always UTF-8: bytes in strings that are not come out as '?'. Aborts when there is no
 * memory. */
NODISCARD char *json_write(const cJSON *json);
/* The same, but NULL when there is no memory: for documents whose size comes from outside. */
NODISCARD char *json_print(const cJSON *json);

/* A member's value; NULL or fallback when it is absent or of another type. object may be NULL. */
const char *json_text(const cJSON *object, const char *name);
double json_number(const cJSON *object, const char *name, double fallback);
bool json_flag(const cJSON *object, const char *name, bool fallback);
