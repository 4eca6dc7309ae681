#pragma once
/* JSON text to documents and back, with limits: everything from outside that is JSON is parsed here. Documents are
 * cJSON trees with one owner. Thread: any. */
#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdint.h>

#include "server/wire/problem.h"

enum { JSON_MAX_DEPTH = 32 };

/* Parses exactly n bytes: valid UTF-8 without NUL, at most JSON_MAX_DEPTH levels, nothing but white space after the
 * value. NULL with a problem of type "json", or "internal" when there is no memory. The caller bounds n. */
NODISCARD cJSON *json_read(const char *bytes, size_t n, struct problem *problem);
/* Compact text, for free(). Always UTF-8: bytes in strings that are not come out as '?'. NULL when there is no memory
 * for it, or when on this thread, since the last json_print or json_no_memory, there was none for a part of some
 * document: so a caller that adds part to part need not check each, and no half document is sent. */
NODISCARD char *json_print(const cJSON *json);
/* Like json_print, for a program that can do nothing else: aborts without memory. */
NODISCARD char *json_write(const cJSON *json);
/* Fills problem with PROBLEM_INTERNAL: no memory for `what`. Returns false. */
bool json_no_memory(struct problem *problem, const char *what);
/* Like cJSON_AddItemToObject and cJSON_AddItemToArray, but frees value (taken) where it cannot be added. */
void json_add(cJSON *object, const char *name, cJSON *value);
void json_append(cJSON *array, cJSON *value);

/* A number, or null where the value is not finite: JSON has no infinity and no NaN. */
cJSON *json_finite(double value);
void json_add_finite(cJSON *object, const char *name, double value);
void json_add_text(cJSON *object, const char *name, const char *text); /* NULL is null */
/* The text that from has under this name, "" where it has none: added to an object, or put into an array of size bytes
 * and cut to it. */
void json_copy_text(cJSON *to, const cJSON *from, const char *name);
void json_put_text(char *to, size_t size, const cJSON *from, const char *name);

/* A member's value; NULL or fallback when it is absent or of another type. object may be NULL. */
const char *json_text(const cJSON *object, const char *name);
double json_number(const cJSON *object, const char *name, double fallback);
bool json_flag(const cJSON *object, const char *name, bool fallback);
