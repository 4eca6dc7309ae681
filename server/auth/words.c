/* UTF-8 by Unicode 15, table 3-7. */
#include "server/auth/words.h"

#include <stdint.h>
#include <string.h>

#include "core/base/invisible.h"

/* The character at text and its bytes; 0: it is not UTF-8. */
static size_t next_character(const char *text, uint32_t *character)
{
    const unsigned char *s = (const unsigned char *)text, c = s[0];
    const size_t more = c < 0x80                ? 0
                        : c >= 0xc2 && c < 0xe0 ? 1
                        : (c & 0xf0) == 0xe0    ? 2
                        : c >= 0xf0 && c < 0xf5 ? 3
                                                : 4;
    if (c == 0 || more == 4)
        return 0;
    *character = more == 0 ? c : c & (0x3fU >> more);
    for (size_t k = 1; k <= more; k++) { /* the end of the text is no such byte */
        if ((s[k] & 0xc0) != 0x80)
            return 0;
        *character = *character << 6 | (s[k] & 0x3fU);
    }
    if ((more == 2 && *character < 0x800) || (more == 3 && *character < 0x10000) || *character > 0x10ffff ||
        (*character >= 0xd800 && *character < 0xe000))
        return 0;
    return more + 1;
}

bool words_are_printable(const char *text, size_t most)
{
    uint32_t character = 0;
    const size_t n = strnlen(text, most + 1);
    if (n == 0 || n > most)
        return false;
    for (size_t at = 0, more; at < n; at += more) {
        more = next_character(text + at, &character);
        if (!more || character < 32 || (character >= 0x7f && character < 0xa0) || invisible_tag(character))
            return false;
    }
    return true;
}

bool words_are_id(const char *text)
{
    return words_are_printable(text, IDENTITY_MAX_USER) && !strpbrk(text, " ,;\"\\") && text[0] != '@' &&
           text[0] != '-';
}

static bool has_group(const struct identity *identity, const char *group)
{
    for (size_t i = 0; i < identity->n_groups; i++)
        if (strcmp(identity->groups[i], group) == 0)
            return true;
    return false;
}

bool words_read_groups(const char *list, struct identity *identity, struct problem *problem)
{
    while (*list) {
        char group[IDENTITY_MAX_USER + 2];
        size_t n = strcspn(list, ",;\n");
        const char *next = list + n + (list[n] != 0);
        while (n && *list == ' ') {
            list++;
            n--;
        }
        while (n && list[n - 1] == ' ')
            n--;
        const size_t n_kept = n < sizeof group - 1 ? n : sizeof group - 1; /* too long stays too long */
        memcpy(group, list, n_kept);
        group[n_kept] = 0;
        list = next;
        if (n == 0 || (words_are_printable(group, IDENTITY_MAX_USER) && has_group(identity, group)))
            continue;
        if (!words_are_printable(group, IDENTITY_MAX_USER))
            return problem_set(problem, PROBLEM_VALIDATION, "/groups", "pattern",
                               "a group has 1 to %d bytes of UTF-8 without control characters", IDENTITY_MAX_USER);
        if (identity->n_groups == IDENTITY_MAX_GROUPS)
            return problem_set(problem, PROBLEM_VALIDATION, "/groups", "count",
                               "more than %d groups: pass on only those that grants name", IDENTITY_MAX_GROUPS);
        memcpy(identity->groups[identity->n_groups++], group, n_kept + 1);
    }
    return true;
}

void words_copy_groups(const char *list, struct identity *identity)
{
    const char *end;
    for (; identity->n_groups < IDENTITY_MAX_GROUPS && (end = strchr(list, '\n')); list = end + 1) {
        const size_t n = (size_t)(end - list);
        if (n > IDENTITY_MAX_USER)
            continue;
        memcpy(identity->groups[identity->n_groups], list, n);
        identity->groups[identity->n_groups++][n] = 0;
    }
}

bool words_has(const char *list, const char *entry)
{
    const size_t n = strlen(entry);
    const char *end;
    for (; (end = strchr(list, '\n')); list = end + 1)
        if ((size_t)(end - list) == n && memcmp(list, entry, n) == 0)
            return true;
    return false;
}

void words_cut(char *to, const char *text, size_t most)
{
    size_t n = strlen(text);
    if (n > most)
        for (n = most; n && ((unsigned char)text[n] & 0xc0) == 0x80;)
            n--;
    memcpy(to, text, n);
    to[n] = 0;
}
