#pragma once
/* Rooms to rows and back. Each function inside or outside of a transaction of the caller's. Internal to server/store.
 */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* Errors of all: those of sql_fail. */
NODISCARD bool rows_write_room(sqlite3 *db, const struct store_room *room, struct error *err);
/* Items and records of a write that is_prompt, of a room that may never have been written. */
NODISCARD bool rows_write_prompt(sqlite3 *db, const struct store_room *room, struct error *err);
NODISCARD bool rows_delete_room(sqlite3 *db, const char *id, struct error *err); /* true when there is none */
/* Reads rows of sql, of whose ?1 is id unless NULL, to an array of size bytes each, at most `most`; read is given zeros
 * to fill and returns false for no memory. What was read stays in list and *n also on failure. */
NODISCARD bool rows_read_list(sqlite3 *db, const char *sql, const char *id, size_t size, size_t most,
                              bool (*read)(sqlite3_stmt *row, void *to), void **list, size_t *n, struct error *err);
/* NULL: ERROR_NOT_FOUND, ERROR_MEMORY, or of sql_fail. */
NODISCARD struct store_room *rows_read_room(sqlite3 *db, const char *id, struct error *err);
/* The room that has a bookmark with this token; else as rows_read_room. */
NODISCARD struct store_room *rows_read_saved(sqlite3 *db, const char *token, struct error *err);
/* All rooms, last used first, at most `most`. NULL with err; *n 0: there is none. */
NODISCARD struct store_summary *rows_list_rooms(sqlite3 *db, size_t most, size_t *n, struct error *err);
