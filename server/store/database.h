#pragma once
/* The database file: opening it with its checks and migrations, transactions, errors as sentences. Internal to
 * server/store. One thread at a time. */
#include <sqlite3.h>
#include <stddef.h>

#include "core/base/error.h"

enum {
    DATABASE_BUSY_MS = 5000, /* how long a lock of another process, as of a backup, is waited for */
    DATABASE_PATH_SIZE = 4096
};

/* Opens or creates the database at path, in WAL mode with every commit flushed to the disk, and brings its schema up to
 * date in one transaction. A file that is damaged or no database is renamed to "<path>.damaged-<UTC time>", its log
 * beside it likewise, and a new database is begun; *moved then has the new name, else "".
 *   errors  ERROR_UNSUPPORTED  a newer program made it: it is left alone
 *           ERROR_LIMIT        the disk is full
 *           ERROR_IO           it cannot be read or written now */
NODISCARD sqlite3 *database_open(const char *path, char moved[DATABASE_PATH_SIZE], struct error *err);
/* For reading only, without migrations. */
NODISCARD sqlite3 *database_open_to_read(const char *path, struct error *err);
void database_close(sqlite3 *db);
