/* Statements, and the failures of SQLite by what can be done about them. */
#include "server/store/sql.h"

#include <stdio.h>
#include <string.h>

bool sql_fail(sqlite3 *db, const char *what, struct error *err)
{
    int code = db ? sqlite3_errcode(db) : SQLITE_NOMEM, reason = db ? sqlite3_system_errno(db) : 0;
    const char *words = db ? sqlite3_errmsg(db) : "no memory";
    enum error_code kind = ERROR_STATE;
    switch (code) {
    case SQLITE_FULL: kind = ERROR_LIMIT; break;
    case SQLITE_IOERR:
        kind = ERROR_IO;
        words = reason ? strerror(reason) : words;
        break;
    case SQLITE_CANTOPEN:
        words = reason ? strerror(reason) : words;
        kind = ERROR_IO;
        break;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_NOMEM:
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_PROTOCOL:
    case SQLITE_INTERRUPT: kind = ERROR_IO; break;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB: kind = ERROR_FORMAT; break;
    default: break;
    }
    return error_set(err, kind, "%s: %s", what, words);
}

bool sql_run(sqlite3 *db, const char *sql, struct error *err)
{
    char what[40];
    (void)snprintf(what, sizeof what, "%.*s", (int)strcspn(sql, "(;"), sql);
    return sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK || sql_fail(db, what, err);
}

sqlite3_stmt *sql_prepare(sqlite3 *db, const char *sql, struct error *err)
{
    sqlite3_stmt *statement = NULL;
    if (sqlite3_prepare_v2(db, sql, -1, &statement, NULL) != SQLITE_OK)
        (void)sql_fail(db, "preparing", err);
    return statement;
}

void sql_bind_text(sqlite3_stmt *statement, int index, const char *text)
{
    (void)sqlite3_bind_text(statement, index, text, -1, SQLITE_TRANSIENT);
}

bool sql_step(sqlite3_stmt *statement, const char *what, struct error *err)
{
    bool ok = sqlite3_step(statement) == SQLITE_DONE || sql_fail(sqlite3_db_handle(statement), what, err);
    (void)sqlite3_reset(statement);
    return ok;
}

void sql_text(sqlite3_stmt *statement, int column, char *text, size_t size)
{
    const char *found = (const char *)sqlite3_column_text(statement, column);
    (void)snprintf(text, size, "%s", found ? found : "");
}

char *sql_copy_text(sqlite3_stmt *statement, int column)
{
    const char *found = (const char *)sqlite3_column_text(statement, column);
    return found ? strdup(found) : NULL;
}
