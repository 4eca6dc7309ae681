#pragma once
/* Statements for records of decisions and signatures. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Adds the records of this write. Errors: those of sql_fail. */
NODISCARD bool records_write(sqlite3 *db, const struct store_room *room, struct error *err);
/* Like store_read_records. n records, the caller's; NULL: ERROR_NOT_FOUND (of one), ERROR_MEMORY, those of sql_fail. */
NODISCARD struct store_record *records_read(sqlite3 *db, const char *id, const char *before, size_t *n,
                                            struct error *err);
