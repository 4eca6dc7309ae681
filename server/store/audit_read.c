/* The statement that reads rows of the audit. */
#include "server/store/audit_read.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/store/audit.h"
#include "server/store/sql.h"
#include "server/store/store.h"

void audit_rows_free(struct store_audit_row *rows, size_t n)
{
    for (size_t i = 0; rows && i < n; i++)
        free(rows[i].text);
    free(rows);
}

/* CASE: a row that somebody has made no JSON must not end the reading of the others; it is given without filters. */
static const char choice[] =
    "SELECT n, row, hash, (SELECT hash FROM audit AS b WHERE b.n = a.n - 1), json_valid(row) FROM audit AS a WHERE n < ?1 AND n >= ?2 AND"
    " CASE WHEN json_valid(row) THEN json_extract(row, '$.time_ms') BETWEEN ?3 AND ?4 AND"
    " (?5 = '' OR json_extract(row, '$.user') = ?5) AND (?6 = '' OR json_extract(row, '$.plan') = ?6) AND"
    " (?7 = '' OR json_extract(row, '$.room') = ?7) AND (?8 = '' OR json_extract(row, '$.action') = ?8)"
    " ELSE ?5 || ?6 || ?7 || ?8 = '' END ORDER BY n DESC LIMIT ?9";

static void bind(sqlite3_stmt *row, const struct store_audit_query *query, int64_t least_n)
{
    (void)sqlite3_bind_int64(row, 1, query->before_n);
    (void)sqlite3_bind_int64(row, 2, least_n);
    (void)sqlite3_bind_int64(row, 3, query->from_ms);
    (void)sqlite3_bind_int64(row, 4, query->to_ms);
    sql_bind_text(row, 5, query->user);
    sql_bind_text(row, 6, query->plan);
    sql_bind_text(row, 7, query->room);
    sql_bind_text(row, 8, query->action);
    (void)sqlite3_bind_int64(row, 9, (int64_t)query->limit);
}

static bool read_row(sqlite3_stmt *row, struct store_audit_row *to)
{
    *to = (struct store_audit_row){ .n = sqlite3_column_int64(row, 0), .text = sql_copy_text(row, 1) };
    sql_text(row, 2, to->hash, sizeof to->hash);
    sql_text(row, 3, to->before, sizeof to->before);
    to->is_json = sqlite3_column_int(row, 4) != 0;
    if (to->n == 1)
        memcpy(to->before, audit_no_hash, sizeof to->before);
    return to->text != NULL;
}

struct store_audit_row *audit_read(sqlite3 *db, const struct store_audit_query *query, size_t *n, int64_t *next_n,
                                   struct error *err)
{
    struct store_audit_query asked = *query;
    struct audit_head head;
    *n = 0;
    *next_n = 0;
    if (!audit_read_head(db, &head, err))
        return NULL;
    if (asked.before_n > head.n)
        asked.before_n = head.n + 1;
    const int64_t least_n = asked.before_n > STORE_AUDIT_LOOKED_AT ? asked.before_n - STORE_AUDIT_LOOKED_AT : 1;
    struct store_audit_row *rows = mem_array(asked.limit, sizeof *rows, STORE_AUDIT_AT_ONCE * sizeof *rows, err);
    sqlite3_stmt *row = rows ? sql_prepare(db, choice, err) : NULL;
    bool ok = row != NULL;
    if (ok)
        bind(row, &asked, least_n);
    for (int step; ok && *n < asked.limit && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW)
            ok = sql_fail(db, "reading the audit", err);
        else
            ok = read_row(row, &rows[(*n)++]) || error_set(err, ERROR_MEMORY, "no memory for a row of the audit");
    }
    (void)sqlite3_finalize(row);
    if (ok) {
        *next_n = *n == asked.limit ? rows[*n - 1].n : least_n;
        *next_n = *next_n > 1 ? *next_n : 0;
        return rows;
    }
    audit_rows_free(rows, *n);
    *n = 0;
    return NULL;
}
