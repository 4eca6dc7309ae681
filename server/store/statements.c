/* The SQL that writes and reads what people have stated of whom plans are of. */
#include "server/store/statements.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "server/store/sql.h"

void store_statement_free(struct store_statement *statement)
{
    if (statement)
        free(statement->body);
    free(statement);
}

void statements_free(struct store_statement *statements, size_t n)
{
    for (size_t i = 0; statements && i < n; i++)
        free(statements[i].body);
    free(statements);
}

bool statements_write(sqlite3 *db, const struct store_statement *statement, struct error *err)
{
    const char *sql = statement->body ? "INSERT OR REPLACE INTO statements(plan, body) VALUES(?1, ?2)"
                                      : "DELETE FROM statements WHERE plan = ?1";
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    if (row)
        sql_bind_text(row, 1, statement->plan);
    if (row && statement->body)
        sql_bind_text(row, 2, statement->body);
    const bool ok = row && sql_step(row, "writing a statement on a plan", err);
    (void)sqlite3_finalize(row);
    return ok;
}

struct store_statement *statements_read(sqlite3 *db, size_t *n, struct error *err)
{
    struct store_statement *list = mem_array(STORE_MAX_STATEMENTS, sizeof list[0], 1 << 20, err);
    sqlite3_stmt *row = list ? sql_prepare(db, "SELECT plan, body FROM statements ORDER BY rowid", err) : NULL;
    bool ok = row != NULL;
    *n = 0;
    for (int step; ok && *n < STORE_MAX_STATEMENTS && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW) {
            ok = sql_fail(db, "reading statements on plans", err);
            continue;
        }
        list[*n] = (struct store_statement){ .body = sql_copy_text(row, 1) };
        sql_text(row, 0, list[*n].plan, sizeof list[*n].plan);
        ok = list[(*n)++].body || error_set(err, ERROR_MEMORY, "no memory for a statement on a plan");
    }
    (void)sqlite3_finalize(row);
    if (ok)
        return list;
    statements_free(list, *n);
    *n = 0;
    return NULL;
}
