#pragma once
/* The files of the page, read into memory at start: they are few and small, and no path from a request reaches the file
 * system. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { FILES_MAX = 500, FILES_MAX_BYTES = 8 << 20 /* of one file */ };

struct file {
    char path[200]; /* "/js/main.js" */
    const char *media_type;
    char etag[24]; /* hash of the contents, with quotes */
    uint8_t *bytes;
    size_t n_bytes;
};
struct files;

/* Reads every file below folder that has a known ending and is not hidden.
 *   errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND (no index.html) */
NODISCARD struct files *files_create(const char *folder, struct error *err);
void files_destroy(struct files *files);
/* The file of a decoded path; "/" is /index.html. NULL: there is none. */
const struct file *files_find(const struct files *files, const char *path);
