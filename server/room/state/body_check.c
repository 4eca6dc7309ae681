/* Checks fields of the bodies of items. */
#include "server/room/state/body_check.h"

#include <stdio.h>
#include <string.h>

/* Where a check is: "/body" and below. */
bool body_refuse_type(struct problem *problem, const char *where, const char *expected)
{
    return problem_set(problem, PROBLEM_VALIDATION, where, "type", "%s is not %s", where, expected);
}

/* Refuses members that are none of these names, or are there twice. */
bool body_names_are(const cJSON *object, const char *const *names, const char *where, struct problem *problem)
{
    unsigned seen = 0;
    const cJSON *member;
    cJSON_ArrayForEach(member, object)
    {
        char pointer[160];
        unsigned at = 0;
        (void)snprintf(pointer, sizeof pointer, "%s/%.60s", where, member->string);
        while (names[at] && strcmp(names[at], member->string) != 0)
            at++;
        if (!names[at])
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of %s",
                               member->string, where);
        if (seen & 1U << at)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "duplicate", "%s is there twice", pointer);
        seen |= 1U << at;
    }
    return true;
}

static size_t n_characters(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

/* Checks a text of 1 to `most` characters, not all of them white; lines may break. */
bool body_check_text(const cJSON *json, const char *where, size_t most, struct problem *problem)
{
    if (!json)
        return problem_set(problem, PROBLEM_VALIDATION, where, "required", "%s is missing", where);
    if (!cJSON_IsString(json))
        return body_refuse_type(problem, where, "text");
    const char *text = json->valuestring;
    if (text[strspn(text, " \t\n")] == 0 || n_characters(text) > most)
        return problem_set(problem, PROBLEM_VALIDATION, where, "length",
                           "%s has %zu characters, expected 1 to %zu, not all of them spaces", where,
                           n_characters(text), most);
    for (const char *c = text; *c; c++)
        if (((unsigned char)*c < 0x20 && *c != '\n' && *c != '\t') || *c == 0x7f)
            return problem_set(problem, PROBLEM_VALIDATION, where, "pattern", "%s holds a control character", where);
    return true;
}

bool body_check_id(const cJSON *json, const char *where, struct problem *problem)
{
    if (!cJSON_IsString(json))
        return body_refuse_type(problem, where, "an id");
    if (!id_is_valid(json->valuestring))
        return problem_set(problem, PROBLEM_VALIDATION, where, "pattern",
                           "%s is \"%.40s\", expected 1 to 63 of a-z, 0-9 and -", where, json->valuestring);
    return true;
}
