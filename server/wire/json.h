#pragma once
/* JSON text to documents and back, with limits: everything from outside that is JSON is parsed here. Documents are
 * cJSON trees with one owner. Thread: any. */
#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdint.h>

#include "server/wire/json_member.h"
#include "server/wire/problem.h"

enum { JSON_MAX_DEPTH = 32 };

/* Parses exactly n bytes: valid UTF-8 without NUL, at most JSON_MAX_DEPTH levels, nothing but white space after the
 * value. NULL with a problem of type "json", or "internal" when there is no memory. The caller bounds n. */
NODISCARD cJSON *json_read(const char *bytes, size_t n, struct problem *problem);
bool json_is_utf8(const char *text, size_t n); /* well-formed, and without NUL */
/* Compact text, for free(). Always UTF-8: bytes in strings that are not come out as '?'. NULL when there is no memory
 * for it, or when on this thread, since the last json_print or json_no_memory, there was none for a part of some
 * document: so a caller that adds part to part need not check each, and no half document is sent. */
NODISCARD char *json_print(const cJSON *json);
/* Like json_print, for a program that can do nothing else: aborts without memory. */
NODISCARD char *json_write(const cJSON *json);
/* Fills problem with PROBLEM_INTERNAL: no memory for `what`. Returns false. */
bool json_no_memory(struct problem *problem, const char *what);
