/* Rules and bookkeeping of entry names: UTF-8, safe names, a tree of names seen. */
#define _GNU_SOURCE
#include "server/renderer/unpack_name.h"

#include <search.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <wctype.h>

#include "server/renderer/unpack_limits.h"

/* Bytes of the UTF-8 character at the start of text (RFC 3629: shortest form, no surrogates); 0 when it is invalid. */
static size_t utf8_length(const char *text, uint32_t *code)
{
    const unsigned char *byte = (const unsigned char *)text;
    if (byte[0] < 0x80) {
        *code = byte[0];
        return byte[0] != 0;
    }
    size_t n = byte[0] >= 0xf0 ? 4 : byte[0] >= 0xe0 ? 3 : 2;
    static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    if (byte[0] < 0xc2 || byte[0] > 0xf4)
        return 0;
    *code = byte[0] & (0x7fu >> n);
    for (size_t i = 1; i < n; i++) {
        if ((byte[i] & 0xc0) != 0x80)
            return 0;
        *code = *code << 6 | (byte[i] & 0x3f);
    }
    return *code >= least[n] && *code <= 0x10ffff && (*code < 0xd800 || *code > 0xdfff) ? n : 0;
}

static bool is_control(uint32_t code)
{
    return code < 32 || (code >= 127 && code < 160);
}

void unpack_show(const char *raw, char shown[UNPACK_SHOWN_SIZE])
{
    size_t n = 0;
    for (const char *at = raw; *at;) {
        uint32_t code = 0;
        size_t length = utf8_length(at, &code);
        bool is_bad = length == 0 || is_control(code);
        size_t step = length ? length : 1, added = is_bad ? 1 : length;
        if (n + added > UNPACK_SHOWN_SIZE - 4) { /* room for the dots and the end */
            memcpy(shown + n, "...", 3);
            n += 3;
            break;
        }
        if (is_bad)
            shown[n] = '?';
        else
            memcpy(shown + n, at, length);
        n += added;
        at += step;
    }
    shown[n] = 0;
}

static bool refuse(struct problem *problem, const char *raw, const char *code, const char *found)
{
    char shown[UNPACK_SHOWN_SIZE];
    unpack_show(raw, shown);
    return problem_set(problem, PROBLEM_VALIDATION, "", code,
                       "entry \"%s\": %s; expected is a relative name below the archive's top", shown, found);
}

/* Copies raw with '/' for '\' and "_XX" for every byte that is not UTF-8. */
static bool make_safe(const char *raw, char safe[FOLDER_NAME_SIZE], struct problem *problem)
{
    size_t n = 0;
    for (const char *at = raw; *at;) {
        uint32_t code = 0;
        size_t length = utf8_length(at, &code);
        if (length > 0 && is_control(code))
            return refuse(problem, raw, "pattern", "a control character in its name");
        if (n + (length > 0 ? length : 3) >= FOLDER_NAME_SIZE) {
            char shown[UNPACK_SHOWN_SIZE];
            unpack_show(raw, shown);
            return problem_set(problem, PROBLEM_VALIDATION, "", "length",
                               "entry \"%s\": a name of %zu bytes; at most %d are allowed", shown, strlen(raw),
                               FOLDER_NAME_SIZE - 1);
        }
        if (length == 0)
            (void)snprintf(safe + n, 4, "_%02X", (unsigned)(unsigned char)*at);
        else
            memcpy(safe + n, at, length);
        if (safe[n] == '\\')
            safe[n] = '/';
        n += length > 0 ? length : 3;
        at += length > 0 ? length : 1;
    }
    safe[n] = 0;
    return true;
}

bool unpack_name(const char *raw, bool is_folder, char name[FOLDER_NAME_SIZE], struct problem *problem)
{
    char safe[FOLDER_NAME_SIZE];
    name[0] = 0;
    if (!make_safe(raw, safe, problem))
        return false;
    size_t n = 0, n_parts = 0;
    if (safe[0] == 0)
        return refuse(problem, raw, "pattern", "an empty name");
    if (safe[0] == '/')
        return refuse(problem, raw, "pattern", "an absolute name");
    if (((safe[0] | 32) >= 'a' && (safe[0] | 32) <= 'z') && safe[1] == ':')
        return refuse(problem, raw, "pattern", "a name that begins with a drive letter");
    for (const char *part = safe; *part;) {
        size_t length = strcspn(part, "/");
        if (length == 0)
            return refuse(problem, raw, "pattern", "an empty part in its name (\"//\")");
        if (length == 2 && memcmp(part, "..", 2) == 0)
            return refuse(problem, raw, "pattern", "\"..\" in its name, which leads out of the archive");
        if (length > UNPACK_PART_SIZE)
            return refuse(problem, raw, "length", "a part of its name is longer than 255 bytes");
        bool is_last = part[length] == 0;
        if (length != 1 || part[0] != '.') {
            if (++n_parts > UNPACK_MAX_DEPTH)
                return refuse(problem, raw, "length", "more than 16 folders deep");
            if (n > 0)
                name[n++] = '/';
            memcpy(name + n, part, length);
            n += length;
            name[n] = 0;
        }
        part += length + !is_last;
        if (!is_last && *part == 0 && !is_folder)
            return refuse(problem, raw, "pattern", "a file whose name ends in \"/\"");
    }
    if (n == 0 && !is_folder)
        return refuse(problem, raw, "pattern", "a file without a name");
    return true;
}

bool unpack_is_litter(const char *name)
{
    static const char *const litter[] = { "__MACOSX", ".DS_Store", "Thumbs.db", "desktop.ini" };
    for (const char *part = name; *part;) {
        size_t length = strcspn(part, "/");
        if (length >= 2 && memcmp(part, "._", 2) == 0)
            return true;
        for (size_t i = 0; i < sizeof litter / sizeof *litter; i++)
            if (length == strlen(litter[i]) && strncasecmp(part, litter[i], length) == 0)
                return true;
        part += length + (part[length] == '/');
    }
    return false;
}

/* ---- names seen so far: a balanced tree, so that no choice of names makes it slow ------------------------------- */

struct node {
    bool is_folder;
    size_t name_at; /* text holds the name in lower case, then, from name_at, as it is written */
    char text[];
};

static int compare(const void *a, const void *b)
{
    return strcmp(((const struct node *)a)->text, ((const struct node *)b)->text);
}

enum { FOLDED_SIZE = 2 * FOLDER_NAME_SIZE };

/* The name in lower case, as a case-insensitive file system compares it. Lower case adds at most one byte to every two
 * of a character. */
static size_t fold(const char *name, size_t n, char folded[FOLDED_SIZE])
{
    size_t length = 0;
    for (size_t i = 0; i < n;) {
        uint32_t code = 0;
        size_t step = utf8_length(name + i, &code);
        if (step == 0)
            break; /* names here are UTF-8 */
        uint32_t lower =
            code < 128 ? (code >= 'A' && code <= 'Z' ? code + 32 : code) : (uint32_t)towlower((wint_t)code);
        char *out = folded + length;
        if (lower < 0x80) {
            out[0] = (char)lower;
            length += 1;
        } else if (lower < 0x800) {
            out[0] = (char)(0xc0 | lower >> 6);
            out[1] = (char)(0x80 | (lower & 0x3f));
            length += 2;
        } else if (lower < 0x10000) {
            out[0] = (char)(0xe0 | lower >> 12);
            out[1] = (char)(0x80 | (lower >> 6 & 0x3f));
            out[2] = (char)(0x80 | (lower & 0x3f));
            length += 3;
        } else {
            out[0] = (char)(0xf0 | lower >> 18);
            out[1] = (char)(0x80 | (lower >> 12 & 0x3f));
            out[2] = (char)(0x80 | (lower >> 6 & 0x3f));
            out[3] = (char)(0x80 | (lower & 0x3f));
            length += 4;
        }
        i += step;
    }
    folded[length] = 0;
    return length;
}

static enum unpack_known compare_known(const struct node *known, const struct node *fresh, struct problem *problem)
{
    const char *old = known->text + known->name_at, *now = fresh->text + fresh->name_at;
    char shown[UNPACK_SHOWN_SIZE], other[UNPACK_SHOWN_SIZE];
    if (known->is_folder && fresh->is_folder && strcmp(old, now) == 0)
        return UNPACK_KNOWN;
    unpack_show(now, shown);
    unpack_show(old, other);
    if (strcmp(old, now) != 0)
        (void)problem_set(
            problem, PROBLEM_VALIDATION, "", "duplicate",
            "entry \"%s\": differs from \"%s\" only in upper and lower case; expected are names that differ otherwise",
            shown, other);
    else if (known->is_folder != fresh->is_folder)
        (void)problem_set(problem, PROBLEM_VALIDATION, "", "duplicate",
                          "entry \"%s\": both a file and a folder; expected is one of them", shown);
    else
        (void)problem_set(problem, PROBLEM_VALIDATION, "", "duplicate",
                          "entry \"%s\": there twice; expected is each name once", shown);
    return UNPACK_REFUSED;
}

enum unpack_known unpack_names_add(struct unpack_names *names, const char *name, size_t n, bool is_folder,
                                   struct problem *problem)
{
    char folded[FOLDED_SIZE];
    size_t n_folded = fold(name, n, folded);
    struct node *node = malloc(sizeof *node + n_folded + 1 + n + 1);
    if (!node) {
        (void)problem_set(problem, PROBLEM_INTERNAL, "", "", "no memory for the archive's names");
        return UNPACK_REFUSED;
    }
    node->is_folder = is_folder;
    node->name_at = n_folded + 1;
    memcpy(node->text, folded, n_folded + 1);
    memcpy(node->text + node->name_at, name, n);
    node->text[node->name_at + n] = 0;
    struct node **place = tsearch(node, &names->tree, compare);
    if (place && *place == node) {
        if (++names->n <= UNPACK_MAX_ENTRIES)
            return UNPACK_NEW;
        (void)problem_set(problem, PROBLEM_TOO_LARGE, "", "",
                          "more than %d files and folders come out of the archive; at most so many are allowed",
                          UNPACK_MAX_ENTRIES);
        return UNPACK_REFUSED;
    }
    enum unpack_known known = UNPACK_REFUSED;
    if (place)
        known = compare_known(*place, node, problem);
    else
        (void)problem_set(problem, PROBLEM_INTERNAL, "", "", "no memory for the archive's names");
    free(node);
    return known;
}

void unpack_names_finish(struct unpack_names *names)
{
    tdestroy(names->tree, free);
    *names = (struct unpack_names){ 0 };
}
