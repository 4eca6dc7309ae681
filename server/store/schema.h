#pragma once
/* The tables, as the steps from each version to the next. A step that was released never changes: a later one does.
 * tests/data/store has a database of every older version. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"

extern const int schema_version; /* PRAGMA user_version of a database made by this program */

/* Runs the steps that the database lacks, each in a transaction of its own.
 *   errors  ERROR_UNSUPPORTED  its version is newer than schema_version; those of sql_fail */
NODISCARD bool schema_update(sqlite3 *db, struct error *err);
