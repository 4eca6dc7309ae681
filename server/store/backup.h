#pragma once
/* A copy of the database while it is in use, by SQLite's online backup. */
#include "core/base/error.h"

/* Copies the database at path to file, which then is whole or as it was before: written beside it under another name,
 * checked, flushed and renamed. Other processes go on writing meanwhile; the copy is of one moment.
 *   errors  ERROR_NOT_FOUND  there is no database
 *           ERROR_FORMAT     it is damaged
 *           ERROR_LIMIT, ERROR_IO */
NODISCARD bool store_backup(const char *path, const char *file, struct error *err);
