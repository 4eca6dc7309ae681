#pragma once
/* A whole file at once, or not at all. Knows nothing of what is inside. */
#include <stddef.h>

#include "core/base/error.h"

/* Writes beside path and renames, so a reader sees the old file or the new one, never half of it. Two threads may write
 * different paths; the folder must be there. errors ERROR_LIMIT a path too long, ERROR_IO with the system's reason */
NODISCARD bool file_write(const char *path, const void *bytes, size_t n_bytes, struct error *err);
