#pragma once
/* Finds where the body of a request ends: by its Content-Length, or by chunks (RFC 9112 7.1). Chunks are read strictly,
 * so that no other reader finds a different end. Keeps no bytes. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/wire/problem.h"

enum {
    BODY_MAX_CHUNK_DIGITS = 15, /* hexadecimal digits of a chunk's size: less than 2^63 */
    BODY_MAX_CHUNK_LINE = 1024, /* the size with its extensions */
    BODY_MAX_TRAILERS = 8 << 10 /* all fields after the last chunk */
};

enum body_place {
    BODY_DATA,
    BODY_SIZE,
    BODY_EXTENSION,
    BODY_SIZE_LF,
    BODY_DATA_CR,
    BODY_DATA_LF,
    BODY_TRAILER,
    BODY_TRAILER_LF,
    BODY_ENDED
};

struct body {
    enum body_place place;
    bool is_chunked;
    uint64_t n_left;    /* data bytes that are still to come, of the body or of the chunk */
    unsigned n_digits;  /* of the chunk size that is being read */
    size_t n_line;      /* bytes of the size line, or of the trailers, so far */
    bool is_line_empty; /* the present line of the trailers has no bytes yet */
};

/* length: of a body that is not chunked; 0: no body. */
void body_begin(struct body *body, bool is_chunked, uint64_t length);
static inline bool body_is_ended(const struct body *body)
{
    return body->place == BODY_ENDED;
}
/* Reads the next bytes; *n_taken of them belong to the body, fewer than n only when it has ended. Returns false with
 * problem when they break the chunked coding. */
NODISCARD bool body_take(struct body *body, const char *bytes, size_t n, size_t *n_taken, struct problem *problem);
