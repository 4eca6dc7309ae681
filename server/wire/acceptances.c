/* Reads lists of acceptances. */
#include "server/wire/acceptances.h"

#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"

/* Copies a text of at least one byte that fits, else a problem. */
static bool read_text(const cJSON *item, size_t index, const char *name, bool is_required, char *text, size_t size,
                      struct problem *problem)
{
    const cJSON *json = cJSON_GetObjectItemCaseSensitive(item, name);
    char pointer[64];
    (void)snprintf(pointer, sizeof pointer, "/acceptances/%zu/%s", index, name);
    if (!json && !is_required)
        return true;
    if (!cJSON_IsString(json) || (is_required && json->valuestring[0] == 0))
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%s is not a text", pointer);
    if (strlen(json->valuestring) >= size)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "length", "%s has more than %zu bytes", pointer,
                           size - 1);
    (void)snprintf(text, size, "%s", json->valuestring);
    return true;
}

static bool read_item(const cJSON *item, size_t index, struct acceptance *acceptance, struct problem *problem)
{
    return read_text(item, index, "thing", true, acceptance->thing, sizeof acceptance->thing, problem) &&
           read_text(item, index, "with", true, acceptance->with, sizeof acceptance->with, problem) &&
           read_text(item, index, "by", false, acceptance->by, sizeof acceptance->by, problem) &&
           read_text(item, index, "words", false, acceptance->words, sizeof acceptance->words, problem);
}

bool acceptances_read(const cJSON *list, struct acceptances *acceptances, struct problem *problem)
{
    struct error err = { 0 };
    int n = list ? cJSON_GetArraySize(list) : 0;
    *acceptances = (struct acceptances){ 0 };
    if (n > ACCEPTANCES_MAX)
        return problem_set(problem, PROBLEM_VALIDATION, "/acceptances", "length",
                           "/acceptances has %d entries; at most %d are allowed", n, ACCEPTANCES_MAX);
    if (n == 0)
        return true;
    acceptances->items = mem_array((size_t)n, sizeof *acceptances->items, UINT64_MAX, &err);
    if (!acceptances->items)
        return problem_from_error(problem, &err);
    for (const cJSON *item = list->child; item; item = item->next, acceptances->n++)
        if (!read_item(item, acceptances->n, &acceptances->items[acceptances->n], problem)) {
            acceptances_finish(acceptances);
            return false;
        }
    return true;
}
