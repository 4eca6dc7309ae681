#pragma once
/* Erases what is kept of a plan: its rooms with all that is in them, the words of its records, its files, and what
 * SQLite leaves behind of them. A file beside the database says what is being erased until all of it is done, so that a
 * daemon which was killed goes on at its next start. Internal to server/store, but for store_erase_resume. */
#include <sqlite3.h>

#include "server/store/audit.h"
#include "server/store/store.h"

/* is_begin: writes the file, flushed to the disk. Else does all of it, in one transaction as far as the database goes,
 * and removes the file; what was done before is not done twice. Fills said->erased, or said->error (ERROR_LIMIT,
 * ERROR_IO, those of sql_fail): the file stays. */
void erase_plan(sqlite3 *db, const char *database, const struct store_erase *what, bool is_begin,
                struct store_answer *said);
