#pragma once
/* Recordings of meetings to rows and back. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Errors of all: those of sql_fail. Part of the write of a room. */
NODISCARD bool recordings_write(sqlite3 *db, const struct store_room *room, struct error *err);
/* The batches from the last one with a state at or before t_ms (or the first one) on, up to the next one with a state.
 * Where a batch in between is missing it ends before; ERROR_FORMAT: t_ms lies in what is missing.
 * NULL: ERROR_NOT_FOUND, ERROR_LIMIT beyond STORE_MAX_PART_BYTES, or of sql_fail. */
NODISCARD struct store_part *recordings_read_part(sqlite3 *db, const char *room, const char *recording, int64_t t_ms,
                                                  struct error *err);
