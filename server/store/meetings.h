#pragma once
/* Statements for meetings and their cases. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Replaces what is kept of the meeting, or deletes it. Errors: those of sql_fail. */
NODISCARD bool meetings_write(sqlite3 *db, const struct store_meeting *meeting, struct error *err);
/* All, at most STORE_MAX_MEETINGS, the caller's; NULL: ERROR_MEMORY, those of sql_fail. */
NODISCARD struct store_meeting **meetings_read(sqlite3 *db, size_t *n, struct error *err);
void meetings_free(struct store_meeting **meetings, size_t n);
