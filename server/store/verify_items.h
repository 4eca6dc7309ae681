#pragma once
/* Compares notes, saved views, checks, decisions and signatures with the rows of the audit that say who put or deleted
 * them. Internal to server/store. */
#include <sqlite3.h>
#include <stdint.h>

#include "core/base/error.h"

/* Inside a transaction. n: of items and records that were compared. errors ERROR_FORMAT, those of sql_fail */
NODISCARD bool verify_items(sqlite3 *db, int64_t *n, struct error *err);
