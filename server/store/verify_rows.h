#pragma once
/* Checks rows of the audit in a file, as GET /audit?format=ndjson gives them: one a line, each with its hash and that
 * of the row before it. Internal to server/store. */
#include "server/store/verify.h"

/* The number and the time with which a row's text begins; false: it begins otherwise. */
bool verify_row_beginning(const char *text, int64_t *n, int64_t *time_ms);
bool verify_is_rows(const char *path); /* the file is no database, and begins as such a line */
/* Each row must have its hash, and two rows whose numbers follow each other, in either order, must be a chain. Rows may
 * be missing between them, as where only some were asked for: n_gaps counts that. head: one row must have this hash;
 * NULL: none.
 *   errors  ERROR_FORMAT  the sentence names the first line that does not fit, and how
 *           ERROR_IO */
NODISCARD bool verify_rows(const char *path, const char *head, struct audit_facts *facts, struct error *err);
