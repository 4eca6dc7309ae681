/* Computes the chain of the audit anew. */
#include "server/store/verify.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/store/audit.h"
#include "server/store/database.h"
#include "server/store/heads.h"
#include "server/store/sql.h"
#include "server/store/verify_items.h"
#include "server/store/verify_rows.h"

enum { VERSION_WITH_AUDIT = 4, VERSION_WITH_HEAD = 6 }; /* of the database */

/* Whether a row with this number, text and hash continues the chain that ends with facts->head. */
static bool check_row(const struct audit_facts *facts, int64_t n, const char *text, const char *hash, int64_t *time_ms,
                      struct error *err)
{
    const long long here = facts->n_rows + 1, found = n;
    char computed[STORE_AUDIT_HASH];
    int64_t own = 0;
    if (found != here)
        return error_set(err, ERROR_FORMAT, "row %lld is missing: row %lld follows row %lld", here, found, here - 1);
    if (!verify_row_beginning(text, &own, time_ms))
        return error_set(err, ERROR_FORMAT, "row %lld: its text does not begin with its number and its time", here);
    if (own != n)
        return error_set(err, ERROR_FORMAT, "row %lld has the text of row %lld: the order was changed", here,
                         (long long)own);
    audit_hash(facts->head, text, computed);
    if (strcmp(computed, hash) != 0)
        return error_set(err, ERROR_FORMAT,
                         "row %lld does not fit: its hash is %.64s, row %lld and its text give %.64s; its text, its "
                         "hash or that of row %lld was changed",
                         here, hash, here - 1, computed, here - 1);
    return true;
}

static bool check_rows(sqlite3 *db, const char *head, bool *has_head, struct audit_facts *facts, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, "SELECT n, row, hash FROM audit ORDER BY n", err);
    bool ok = row != NULL;
    for (int step; ok && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        char hash[STORE_AUDIT_HASH + 8];
        const char *text = step == SQLITE_ROW ? (const char *)sqlite3_column_text(row, 1) : NULL;
        int64_t time_ms = 0;
        if (step != SQLITE_ROW) {
            ok = sql_fail(db, "reading the audit", err);
            break;
        }
        sql_text(row, 2, hash, sizeof hash);
        ok = check_row(facts, sqlite3_column_int64(row, 0), text ? text : "", hash, &time_ms, err);
        if (!ok)
            break;
        facts->n_rows++;
        facts->first_ms = facts->n_rows == 1 ? time_ms : facts->first_ms;
        facts->last_ms = time_ms;
        memcpy(facts->head, hash, sizeof facts->head);
        *has_head = *has_head || (head && strcmp(head, hash) == 0);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

static int64_t read_number(sqlite3 *db, const char *sql)
{
    sqlite3_stmt *row = sql_prepare(db, sql, NULL);
    const int64_t number = row && sqlite3_step(row) == SQLITE_ROW ? sqlite3_column_int64(row, 0) : -1;
    (void)sqlite3_finalize(row);
    return number;
}

static bool has_audit(sqlite3 *db, int64_t version, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'audit'", err);
    int step = row ? sqlite3_step(row) : SQLITE_ERROR;
    bool ok = step == SQLITE_ROW;
    if (step == SQLITE_DONE && version >= VERSION_WITH_AUDIT)
        error_set(err, ERROR_FORMAT, "the table of the audit was removed");
    else if (step == SQLITE_DONE)
        error_set(err, ERROR_NOT_FOUND, "the database has no audit: it is older, or not the daemon's");
    else if (row && !ok)
        (void)sql_fail(db, "reading", err);
    (void)sqlite3_finalize(row);
    return ok;
}

/* The newest row as it stands in the database beside the table. */
static bool check_kept_head(sqlite3 *db, const struct audit_facts *facts, struct error *err)
{
    char hash[STORE_AUDIT_HASH] = "";
    sqlite3_stmt *row = sql_prepare(db, "SELECT n, hash FROM audit_head", NULL);
    const bool is_there = row && sqlite3_step(row) == SQLITE_ROW;
    const int64_t n = is_there ? sqlite3_column_int64(row, 0) : 0;
    if (is_there)
        sql_text(row, 1, hash, sizeof hash);
    (void)sqlite3_finalize(row);
    if (!is_there)
        return error_set(err, ERROR_FORMAT, "the number and hash of the newest row (audit_head) were removed");
    if (n > facts->n_rows)
        return error_set(err, ERROR_FORMAT, "rows %lld to %lld were removed at the end", (long long)facts->n_rows + 1,
                         (long long)n);
    if (n < facts->n_rows || strcmp(hash, facts->head) != 0)
        return error_set(
            err, ERROR_FORMAT,
            "the newest row is %lld with the hash %.64s, and audit_head says row %lld with %.64s: the chain "
            "was written anew",
            (long long)facts->n_rows, facts->head, (long long)n, hash);
    return true;
}

/* The newest row as it was noted in the file beside the database. */
static bool check_noted_head(sqlite3 *db, const struct audit_facts *facts, const struct audit_head *noted,
                             struct error *err)
{
    if (noted->n > facts->n_rows)
        return error_set(err, ERROR_FORMAT,
                         "rows %lld to %lld were removed at the end: the file beside the database knows them",
                         (long long)facts->n_rows + 1, (long long)noted->n);
    return !noted->n || audit_has_row(db, noted) ||
           error_set(err, ERROR_FORMAT,
                     "row %lld has not the hash %.64s, which the file beside the database knows: the chain was written "
                     "anew",
                     (long long)noted->n, noted->hash);
}

static bool check_all(sqlite3 *db, const char *head, const struct audit_head *noted, struct audit_facts *facts,
                      struct error *err)
{
    bool has_head = !head || strcmp(head, audit_no_hash) == 0;
    const int64_t version = read_number(db, "PRAGMA user_version");
    if (!has_audit(db, version, err) || !check_rows(db, head, &has_head, facts, err) ||
        (version >= VERSION_WITH_HEAD && !check_kept_head(db, facts, err)) || !check_noted_head(db, facts, noted, err))
        return false;
    if (!has_head)
        return error_set(err, ERROR_FORMAT,
                         "none of the %lld rows has the hash given: rows at the end were removed, or the chain was "
                         "written anew",
                         (long long)facts->n_rows);
    return version < VERSION_WITH_HEAD || verify_items(db, &facts->n_items, err);
}

bool store_verify_audit(const char *path, const char *head, struct audit_facts *facts, struct error *err)
{
    struct audit_head noted;
    *facts = (struct audit_facts){ 0 };
    memcpy(facts->head, audit_no_hash, sizeof facts->head);
    if (access(path, F_OK) != 0)
        return error_set(err, ERROR_NOT_FOUND, "%.150s: %s", path, strerror(errno));
    if (verify_is_rows(path))
        return verify_rows(path, head, facts, err);
    heads_read(path, &noted); /* before the database, which goes on growing while a daemon writes it */
    sqlite3 *db = database_open_to_read(path, err);
    const bool ok = db && sql_run(db, "BEGIN", err) && check_all(db, head, &noted, facts, err);
    database_close(db);
    return ok;
}
