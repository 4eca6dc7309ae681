#pragma once
/* The archive's bytes as the library that reads it takes them. Undoes gzip itself: the library does not look at gzip's
 * check sums. Never gives more than is allowed, and stops when asked. */
#include <archive.h>
#include <zlib.h>

#include "server/renderer/unpack.h"

struct unpack_source {
    int file;
    uint64_t n_bytes;                  /* of the file */
    uint64_t at;                       /* next to be read */
    uint64_t n_read;                   /* so far, some perhaps twice */
    uint64_t n_plain;                  /* gzip: undone so far */
    uint64_t most;                     /* bytes undone that are allowed */
    bool is_gzip, is_open, is_between; /* between: no member of the gzip file has begun */
    bool (*goes_on)(void *context);
    void *context;
    struct problem problem; /* why it stopped; type PROBLEM_NONE: it did not */
    z_stream inflate;
    uint8_t bytes[16384];
    uint8_t plain[65536];
};

/* goes_on: asked at every block; when it says no, problem says why. */
NODISCARD bool unpack_source_open(struct unpack_source *source, struct archive *archive, int file, uint64_t most,
                                  bool (*goes_on)(void *context), void *context);
/* Whether the bytes at an offset are these. Where they cannot be read: false, and problem says why. */
bool unpack_source_has(struct unpack_source *source, uint64_t at, const void *expected, size_t n);
/* The first bytes, at most n; how many there are. */
size_t unpack_source_first(const struct unpack_source *source, uint8_t *bytes, size_t n);
/* How many entries a zip's directory says it has; false: there is none, or they are too many for its plain form. */
bool unpack_source_zip_entries(const struct unpack_source *source, uint32_t *n_entries);
/* gzip: reads on to its end, so that all of it has been checked. */
NODISCARD bool unpack_source_drain(struct unpack_source *source);
void unpack_source_finish(struct unpack_source *source);
