#pragma once
/* Atomic writing: a file or a folder appears under its name complete, or not at all. Knows nothing of the content. */
#include <limits.h>
#include <stddef.h>

#include "core/base/error.h"

/* Writes n_bytes to "<path>.partial-<pid>" and renames it to path, so a reader sees either the old file or the new one.
 * After a failure the partial file is removed. The folder must exist.
 *   errors  ERROR_LIMIT  the path is too long
 *           ERROR_IO     with the system's reason
 *   thread  any; two threads must not write the same path */
NODISCARD bool file_write(const char *path, const void *bytes, size_t n_bytes, struct error *err);

/* Longest path of a folder, final zero included; leaves room for the suffix. */
enum { FILE_FOLDER_SIZE = PATH_MAX - 64 };

/* Fills place with the folder's path without trailing slashes, and partial with "<place>.partial-<pid>": the folder is
 * built there and then renamed to place.
 *   errors  ERROR_RANGE  the path is empty or too long */
NODISCARD bool file_folder_paths(const char *folder, char place[FILE_FOLDER_SIZE], char partial[PATH_MAX],
                                 struct error *err);
