#pragma once
/* Members of JSON documents: added and read, one call each. Thread: any. */
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>

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
