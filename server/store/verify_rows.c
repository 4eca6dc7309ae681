/* Reads rows of the audit line by line, and computes their hashes anew. */
#include "server/store/verify_rows.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/audit.h"

enum { HASH_DIGITS = STORE_AUDIT_HASH - 1 };
static const char before_mark[] = "{\"before\":\"", hash_mark[] = "\",\"sha256\":\"", row_mark[] = "\",\"row\":";

struct line { /* of the file */
    int64_t number, n, time_ms;
    char before[STORE_AUDIT_HASH], hash[STORE_AUDIT_HASH];
    const char *text; /* of the row */
};

bool verify_row_beginning(const char *text, int64_t *n, int64_t *time_ms)
{
    long long number, ms;
    int at = 0;
    if (sscanf(text, "{\"n\":%lld,\"time_ms\":%lld%n", &number, &ms, &at) != 2 || at == 0 || text[at] != ',')
        return false;
    *n = number;
    *time_ms = ms;
    return true;
}

bool verify_is_rows(const char *path)
{
    char begin[sizeof before_mark] = "";
    FILE *file = fopen(path, "re");
    const size_t n = file ? fread(begin, 1, sizeof begin - 1, file) : 0;
    if (file)
        (void)fclose(file);
    return n == sizeof begin - 1 && memcmp(begin, before_mark, n) == 0;
}

/* Goes on behind mark and, unless hash is NULL, behind a hash; NULL: the text is another one. */
static const char *pass(const char *at, const char *mark, char *hash)
{
    if (!at || strncmp(at, mark, strlen(mark)) != 0)
        return NULL;
    at += strlen(mark);
    if (!hash)
        return at;
    if (strspn(at, "0123456789abcdef") != HASH_DIGITS)
        return NULL;
    memcpy(hash, at, HASH_DIGITS);
    hash[HASH_DIGITS] = 0;
    return at + HASH_DIGITS;
}

/* Takes a line apart; bytes is cut. */
static bool read_line(char *bytes, struct line *line)
{
    size_t n = strcspn(bytes, "\r\n");
    bytes[n] = 0;
    if (n == 0 || bytes[n - 1] != '}')
        return false;
    bytes[n - 1] = 0;
    const char *at = pass(bytes, before_mark, line->before);
    at = pass(at, hash_mark, line->hash);
    line->text = pass(at, row_mark, NULL);
    return line->text && verify_row_beginning(line->text, &line->n, &line->time_ms);
}

static bool check_line(const struct line *line, const struct line *last, struct audit_facts *facts, struct error *err)
{
    char computed[STORE_AUDIT_HASH];
    audit_hash(line->before, line->text, computed);
    if (strcmp(computed, line->hash) != 0)
        return error_set(err, ERROR_FORMAT, "line %lld: row %lld does not fit: its hash is %.64s, its text gives %.64s",
                         (long long)line->number, (long long)line->n, line->hash, computed);
    const bool is_next = line->n == last->n + 1, is_previous = line->n == last->n - 1;
    if (line->number > 1 && !is_next && !is_previous)
        facts->n_gaps++;
    if (line->number > 1 &&
        ((is_next && strcmp(line->before, last->hash) != 0) || (is_previous && strcmp(last->before, line->hash) != 0)))
        return error_set(err, ERROR_FORMAT, "line %lld: row %lld and row %lld are no chain: one of them was changed",
                         (long long)line->number, (long long)line->n, (long long)last->n);
    return line->n != 1 || strcmp(line->before, audit_no_hash) == 0 ||
           error_set(err, ERROR_FORMAT, "line %lld: row 1 has a row before it", (long long)line->number);
}

static void add(struct audit_facts *facts, const struct line *line, int64_t *newest_n)
{
    if (facts->n_rows++ == 0 || line->time_ms < facts->first_ms)
        facts->first_ms = line->time_ms;
    if (line->time_ms > facts->last_ms)
        facts->last_ms = line->time_ms;
    if (line->n <= *newest_n)
        return;
    *newest_n = line->n;
    memcpy(facts->head, line->hash, sizeof facts->head);
}

static bool check_file(FILE *file, const char *head, struct audit_facts *facts, struct error *err)
{
    struct line line = { 0 }, last = { 0 };
    int64_t newest_n = 0;
    char *bytes = NULL;
    size_t size = 0;
    bool ok = true, has_head = !head;
    while (ok && getline(&bytes, &size, file) >= 0) {
        line.number++;
        ok = read_line(bytes, &line) ||
             error_set(err, ERROR_FORMAT, "line %lld is no row of the audit as it is given", (long long)line.number);
        ok = ok && check_line(&line, &last, facts, err);
        if (!ok)
            break;
        add(facts, &line, &newest_n);
        has_head = has_head || strcmp(head, line.hash) == 0;
        last = line;
        last.text = NULL;
    }
    free(bytes);
    if (ok && ferror(file))
        return error_set(err, ERROR_IO, "the file cannot be read: %s", strerror(errno));
    return ok && (has_head ||
                  error_set(err, ERROR_FORMAT, "none of the %lld rows has the hash given", (long long)facts->n_rows));
}

bool verify_rows(const char *path, const char *head, struct audit_facts *facts, struct error *err)
{
    FILE *file = fopen(path, "re");
    facts->is_export = true;
    if (!file)
        return error_set(err, ERROR_IO, "%.150s: %s", path, strerror(errno));
    const bool ok = check_file(file, head, facts, err);
    (void)fclose(file);
    return ok;
}
