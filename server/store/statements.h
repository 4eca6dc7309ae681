#pragma once
/* Statements for what people have stated of whom plans are of. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Replaces what is kept of the plan, or deletes it. Errors: those of sql_fail. */
NODISCARD bool statements_write(sqlite3 *db, const struct store_statement *statement, struct error *err);
/* All, at most STORE_MAX_STATEMENTS, the caller's; NULL: ERROR_MEMORY, those of sql_fail. */
NODISCARD struct store_statement *statements_read(sqlite3 *db, size_t *n, struct error *err);
void statements_free(struct store_statement *statements, size_t n);
