#pragma once
/* The files of the page, read into memory at start: they are few and small, and no path from a request reaches the file
 * system. A compressed copy beside a file, FILE.gz or FILE.br, is another form of that file and has no path of its own;
 * the build writes file and copies together (deploy/page.mjs). */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "server/http/coding.h"

enum { FILES_MAX = 1000, FILES_MAX_BYTES = 8 << 20 /* of one file, and of one compressed copy */ };

/* The contents of a file in one content coding. */
struct file_form {
    uint8_t *bytes; /* NULL: the file has no such form */
    size_t n_bytes;
    char etag[24]; /* hash of the bytes as they are sent, with quotes: each form has its own */
};

struct file {
    char path[200]; /* "/js/main.js" */
    const char *media_type;
    bool is_immutable;                 /* in /page/: its name changes with its contents */
    bool has_forms;                    /* in more than one coding */
    struct file_form forms[N_CODINGS]; /* CODING_IDENTITY is always there */
};
struct files;

/* Reads every file below folder that has a known ending and is not hidden.
 *   errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND (no index.html) */
NODISCARD struct files *files_create(const char *folder, struct error *err);
void files_destroy(struct files *files);
/* The file of a decoded path; "/", "/rooms/{room}" and where people sign in, "/signin", "/signin/first",
 * "/signin/done", are /index.html, also of a room that does not exist: the page says so. "/display/{room}" is
 * /display.html. NULL: there is none. */
const struct file *files_find(const struct files *files, const char *path);
/* The coding in which to send a file to a client that sent this Accept-Encoding, NULL when it sent none. */
enum content_coding file_coding(const struct file *file, const char *accept);
