/* Bounded parsing with cJSON, and printing: json.h. */
#include "server/wire/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* mem_n_refused() when json_print or json_no_memory was last called. */
static _Thread_local size_t n_told;

/* Runs before main: no other thread uses cJSON yet. */
__attribute__((constructor)) static void count_failures(void)
{
    cJSON_InitHooks(&(cJSON_Hooks){ mem_counted, free });
}

bool json_no_memory(struct problem *problem, const char *what)
{
    n_told = mem_n_refused();
    return problem_set(problem, PROBLEM_INTERNAL, "", "", "no memory for %s", what);
}

/* Length in bytes of the well-formed UTF-8 character at s, of which n bytes are there; 0 for overlong forms,
 * surrogates, NUL and anything else that is not well-formed (Unicode 15, table 3-7). */
static size_t utf8_character(const unsigned char *s, size_t n)
{
    unsigned char c = s[0];
    size_t more = c < 0x80 ? 0 : c >= 0xc2 && c < 0xe0 ? 1 : (c & 0xf0) == 0xe0 ? 2 : c >= 0xf0 && c < 0xf5 ? 3 : 4;
    if (c == 0 || more == 4 || n <= more)
        return 0;
    for (size_t k = 1; k <= more; k++)
        if ((s[k] & 0xc0) != 0x80)
            return 0;
    bool is_odd = (c == 0xe0 && s[1] < 0xa0) || (c == 0xed && s[1] > 0x9f) || (c == 0xf0 && s[1] < 0x90) ||
                  (c == 0xf4 && s[1] > 0x8f);
    return is_odd ? 0 : more + 1;
}

bool json_is_utf8(const char *text, size_t n)
{
    const unsigned char *s = (const unsigned char *)text;
    for (size_t at = 0, more; at < n; at += more)
        if ((more = utf8_character(s + at, n - at)) == 0)
            return false;
    return true;
}

/* Replaces each byte that is not part of a UTF-8 character by '?': file names are any bytes, and a sentence may have
 * been cut inside a character. */
static void make_utf8(unsigned char *s, size_t n)
{
    for (size_t at = 0; at < n;) {
        size_t more = utf8_character(s + at, n - at);
        if (more == 0)
            s[at] = '?';
        at += more ? more : 1;
    }
}

/* Checked before parsing, because cJSON recurses into every level. Brackets inside strings do not count. */
static bool depth_is_allowed(const char *s, size_t n)
{
    int depth = 0;
    bool in_string = false;
    for (size_t at = 0; at < n; at++) {
        char c = s[at];
        if (in_string) {
            if (c == '\\')
                at++;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '{' || c == '[') {
            if (++depth > JSON_MAX_DEPTH)
                return false;
        } else if (c == '}' || c == ']') {
            depth--;
        }
    }
    return true;
}

/* True if a string has the escape \u0000: cJSON ends the string there, so that "a\u0000b" would pass every check as
 * "a". */
static bool names_nul(const char *s, size_t n)
{
    for (size_t at = 0; at + 1 < n; at++)
        if (s[at] == '\\') {
            if (n - at >= 6 && memcmp(s + at + 1, "u0000", 5) == 0)
                return true;
            at++;
        }
    return false;
}

cJSON *json_read(const char *bytes, size_t n, struct problem *problem)
{
    if (n == 0) {
        problem_set(problem, PROBLEM_JSON, "", "", "nothing was sent, a JSON value was expected");
        return NULL;
    }
    if (!json_is_utf8(bytes, n)) {
        problem_set(problem, PROBLEM_JSON, "", "", "the text is not UTF-8");
        return NULL;
    }
    if (names_nul(bytes, n)) {
        problem_set(problem, PROBLEM_JSON, "", "", "a text holds the character \\u0000");
        return NULL;
    }
    if (!depth_is_allowed(bytes, n)) {
        problem_set(problem, PROBLEM_JSON, "", "", "nested deeper than %d", JSON_MAX_DEPTH);
        return NULL;
    }
    const char *end = NULL;
    size_t before = mem_n_refused();
    cJSON *json = cJSON_ParseWithLengthOpts(bytes, n, &end, false);
    if (!json && mem_n_refused() != before) {
        json_no_memory(problem, "the JSON that was sent");
        return NULL;
    }
    if (!json) {
        size_t at = end && end >= bytes ? (size_t)(end - bytes) : 0;
        problem_set(problem, PROBLEM_JSON, "", "", "not JSON near byte %zu of %zu", at, n);
        return NULL;
    }
    for (; end < bytes + n; end++)
        if (!strchr(" \t\r\n", *end)) {
            problem_set(problem, PROBLEM_JSON, "", "", "something follows the JSON value at byte %zu",
                        (size_t)(end - bytes));
            cJSON_Delete(json);
            return NULL;
        }
    return json;
}

char *json_print(const cJSON *json)
{
    char *text = cJSON_PrintUnformatted(json);
    if (mem_n_refused() != n_told) {
        n_told = mem_n_refused();
        free(text);
        return NULL;
    }
    if (text)
        make_utf8((unsigned char *)text, strlen(text));
    return text;
}

char *json_write(const cJSON *json)
{
    char *text = json_print(json);
    if (!text)
        abort(); /* no memory for a message */
    return text;
}
