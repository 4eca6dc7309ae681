#pragma once
/* Statements and their failures as sentences. Internal to server/store. One thread at a time. */
#include <sqlite3.h>
#include <stddef.h>

#include "core/base/error.h"

/* Sets err from the last failure of db, while `what` was being done. Returns false.
 *   codes  ERROR_LIMIT   no space: worth another try
 *          ERROR_IO      the disk, a lock or memory: worth another try
 *          ERROR_FORMAT  the file is damaged
 *          ERROR_STATE   anything else: trying again would fail again */
bool sql_fail(sqlite3 *db, const char *what, struct error *err);
NODISCARD bool sql_run(sqlite3 *db, const char *sql, struct error *err);

/* One statement. sql is a literal. NULL with err; sqlite3_finalize is the caller's. */
NODISCARD sqlite3_stmt *sql_prepare(sqlite3 *db, const char *sql, struct error *err);
/* Binds text, copied; NULL is NULL. */
void sql_bind_text(sqlite3_stmt *statement, int index, const char *text);
/* Steps a statement that gives no rows, and resets it. */
NODISCARD bool sql_step(sqlite3_stmt *statement, const char *what, struct error *err);
/* Copies a column's text, cut at size; "" for NULL. */
void sql_text(sqlite3_stmt *statement, int column, char *text, size_t size);
/* A copy of a column's text for free(); NULL for NULL, or when there is no memory. */
char *sql_copy_text(sqlite3_stmt *statement, int column);
