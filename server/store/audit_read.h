#pragma once
/* Rows of the audit for who asks for them. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Like store_read_audit. n rows, for audit_rows_free; *next_n: rows with lower numbers were not looked at, 0: there are
 * none. NULL: ERROR_MEMORY, those of sql_fail. */
NODISCARD struct store_audit_row *audit_read(sqlite3 *db, const struct store_audit_query *query, size_t *n,
                                             int64_t *next_n, struct error *err);
void audit_rows_free(struct store_audit_row *rows, size_t n); /* NULL is allowed */
