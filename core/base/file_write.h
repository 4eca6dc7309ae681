#pragma once
/* A whole file, or folder, at once or not at all. Knows nothing of what is inside. */
#include <limits.h>
#include <stddef.h>

#include "core/base/error.h"

/* Writes beside path and renames, so a reader sees the old file or the new one, never half of it. Two threads may write
 * different paths; the folder must be there. errors ERROR_LIMIT a path too long, ERROR_IO with the system's reason */
NODISCARD bool file_write(const char *path, const void *bytes, size_t n_bytes, struct error *err);

enum { FILE_FOLDER_SIZE = PATH_MAX - 64 }; /* longest path of a folder, with its end; names beside it are longer */

/* A folder's path without slashes at its end, and the path beside it where it is built before it is renamed to its
 * place. errors ERROR_RANGE an empty path, or one too long */
NODISCARD bool file_folder_paths(const char *folder, char place[FILE_FOLDER_SIZE], char partial[PATH_MAX],
                                 struct error *err);
