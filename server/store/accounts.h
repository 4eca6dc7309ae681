#pragma once
/* Users, tokens, sessions and owners of plans to rows and back. Each function inside or outside of a transaction of the
 * caller's. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Errors of both: those of sql_fail; ERROR_MEMORY. */
NODISCARD bool accounts_write(sqlite3 *db, const struct store_accounts *accounts, struct error *err);
NODISCARD struct store_accounts *accounts_read(sqlite3 *db, struct error *err); /* all of them; NULL with err */
