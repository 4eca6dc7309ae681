/* Checks the fields of acceptances: acceptance_body.h. */
#include "server/room/items/acceptance_body.h"

#include <stdio.h>
#include <string.h>

#include "server/room/state/body_check.h"
#include "wire_gen.h"

static const char *const kinds[] = { "image", "regions", "dose", "beam" };

/* ---- the plan --------------------------------------------------------------------------------------------------- */

static bool is_pair(const cJSON *fit, const char *thing, const char *with)
{
    const char *first = json_text(fit, "thing"), *second = json_text(fit, "with");
    return first && second && strcmp(first, thing) == 0 && strcmp(second, with) == 0;
}

const cJSON *acceptance_fit(const cJSON *plan, const char *thing, const char *with)
{
    const cJSON *fit;
    cJSON_ArrayForEach(fit, cJSON_GetObjectItemCaseSensitive(plan, "fits"))
    {
        if (is_pair(fit, thing, with) || is_pair(fit, with, thing))
            return fit;
    }
    return NULL;
}

/* ---- fields ----------------------------------------------------------------------------------------------------- */

static bool is_part(const char *text)
{
    const char *colon = text ? strchr(text, ':') : NULL;
    if (text && strcmp(text, "tracks") == 0)
        return true;
    for (size_t i = 0; colon && i < sizeof kinds / sizeof kinds[0]; i++)
        if (strlen(kinds[i]) == (size_t)(colon - text) && memcmp(kinds[i], text, strlen(kinds[i])) == 0)
            return id_is_valid(colon + 1);
    return false;
}

static bool check_part(const cJSON *body, const char *name, const char *where, struct problem *problem)
{
    const char *text = json_text(body, name);
    char pointer[96];
    (void)snprintf(pointer, sizeof pointer, "%.64s/%s", where, name);
    return is_part(text) ||
           problem_set(problem, PROBLEM_VALIDATION, pointer, text ? "pattern" : "required",
                       "%s is \"%.80s\", expected image:ID, dose:ID, beam:ID, regions:NUMBER or tracks", pointer,
                       text ? text : "");
}

/* Letters and digits: of ASCII, and every character beyond it. */
static size_t n_letters(const char *text)
{
    size_t n = 0;
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        n += (*c >= '0' && *c <= '9') || (*c >= 'A' && *c <= 'Z') || (*c >= 'a' && *c <= 'z') || *c >= 0xc0;
    return n;
}

bool acceptance_words_check(const cJSON *words, const char *pointer, struct problem *problem)
{
    if (!body_check_text(words, pointer, ACCEPTANCE_MAX_WORDS, problem))
        return false;
    return n_letters(words->valuestring) >= ACCEPTANCE_MIN_LETTERS ||
           problem_set(problem, PROBLEM_VALIDATION, pointer, "length",
                       "%s has %zu letters, expected your own words of at least %d", pointer,
                       n_letters(words->valuestring), ACCEPTANCE_MIN_LETTERS);
}

static bool check_words(const cJSON *body, const char *where, struct problem *problem)
{
    char pointer[96];
    (void)snprintf(pointer, sizeof pointer, "%.64s/words", where);
    return acceptance_words_check(cJSON_GetObjectItemCaseSensitive(body, "words"), pointer, problem);
}

static bool check_reason(const cJSON *body, const char *where, struct problem *problem)
{
    const char *reason = json_text(body, "reason");
    char pointer[96];
    (void)snprintf(pointer, sizeof pointer, "%.64s/reason", where);
    for (size_t i = 0; reason && i < wire_acceptance_reason_words.n; i++)
        if (strcmp(reason, wire_acceptance_reason_words.words[i]) == 0)
            return true;
    return problem_set(problem, PROBLEM_VALIDATION, pointer, reason ? "enum" : "required",
                       "%s is \"%.40s\", expected registered-elsewhere, same-session, compared-on-anatomy or other",
                       pointer, reason ? reason : "");
}

static bool check_pair(const cJSON *plan, const char *thing, const char *with, const char *where,
                       struct problem *problem)
{
    char pointer[96];
    const cJSON *fit = acceptance_fit(plan, thing, with);
    const char *needs = json_text(fit, "needs"), *why = json_text(fit, "reason");
    (void)snprintf(pointer, sizeof pointer, "%.64s/thing", where);
    if (!fit)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-id",
                           "the plan has no pair of %.80s and %.80s that could be accepted", thing, with);
    if (needs && strcmp(needs, "never") == 0)
        return problem_set(problem, PROBLEM_FORBIDDEN, pointer, "never", "%.200s Nobody can accept this.",
                           why ? why : "These belong to two patients.");
    return (needs && strcmp(needs, "acceptance") == 0) ||
           problem_set(problem, PROBLEM_VALIDATION, pointer, "enum", "%.80s and %.80s need no acceptance", thing, with);
}

bool acceptance_check(const cJSON *plan, const cJSON *body, const char *where, struct problem *problem)
{
    return check_part(body, "thing", where, problem) && check_part(body, "with", where, problem) &&
           check_reason(body, where, problem) && check_words(body, where, problem) &&
           (!plan || check_pair(plan, json_text(body, "thing"), json_text(body, "with"), where, problem));
}
