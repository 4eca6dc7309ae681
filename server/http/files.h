#pragma once
/* The page's files, read into memory at start: few, small, and then no path from outside ever reaches the file system.
 */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { FILES_MAX = 500, FILES_MAX_BYTES = 8 << 20 /* of one */ };

struct file {
    char path[200]; /* "/js/main.js" */
    const char *media_type;
    char etag[24]; /* of the contents */
    uint8_t *bytes;
    size_t n_bytes;
};
struct files;

/* Everything below folder with a known ending, hidden files left out. errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND (no
 * index.html) */
NODISCARD struct files *files_create(const char *folder, struct error *err);
void files_destroy(struct files *files);
/* "/" is /index.html. NULL: no such file. */
const struct file *files_find(const struct files *files, const char *path);
