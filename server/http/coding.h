#pragma once
/* Content codings of the page's files, and the choice among them by a request's Accept-Encoding (RFC 9110 12.5.3).
 * Knows no files. */
#include <stdbool.h>

enum content_coding { CODING_IDENTITY, CODING_GZIP, CODING_BR, N_CODINGS };

/* The value of Content-Encoding; NULL for CODING_IDENTITY, which has none. */
const char *coding_name(enum content_coding coding);
/* The coding that the client prefers among those that exist; of equally preferred ones the smallest: br, gzip,
 * identity.
 *
 *   accept   the value of Accept-Encoding; NULL when it was not sent. Elements that break its grammar are ignored.
 *   exists   by coding; identity is always there
 *   returns  CODING_IDENTITY also when the client accepts nothing that exists: any answer is more use than none */
enum content_coding coding_choose(const char *accept, const bool exists[N_CODINGS]);
