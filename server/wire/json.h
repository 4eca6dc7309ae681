#pragma once
/* JSON documents for the server's modules: the one door to cJSON, with bounds. Thread: any, a document has one owner.
 */
#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdint.h>

#include "server/wire/problem.h"

enum { JSON_MAX_DEPTH = 32 };

/* Parses exactly n bytes: valid UTF-8, at most JSON_MAX_DEPTH deep, nothing after the value. NULL with problem "json".
 */
NODISCARD cJSON *json_read(const char *bytes, size_t n, struct problem *problem);
/* Compact text, free() it. Never NULL, always UTF-8: bytes in strings that are none come out as '?'. */
NODISCARD char *json_write(const cJSON *json);
/* The same; NULL when there is no memory. For documents whose size others decide. */
NODISCARD char *json_print(const cJSON *json);

const char *json_text(const cJSON *object, const char *name);               /* NULL when absent or no string */
double json_number(const cJSON *object, const char *name, double fallback); /* fallback when absent or no number */
bool json_flag(const cJSON *object, const char *name, bool fallback);
