#pragma once
/* Feeds an archive's bytes to libarchive. Decompresses gzip itself, because libarchive does not verify gzip's check
 * sums. Stops at a limit of decompressed bytes, and when goes_on says so. */
#include <archive.h>
#include <zlib.h>

#include "server/wire/problem.h"

struct unpack_source {
    int file;
    uint64_t n_bytes;                  /* of the file */
    uint64_t at;                       /* offset of the next read */
    uint64_t n_read;                   /* bytes read so far; some may be read twice */
    uint64_t n_plain;                  /* gzip: bytes decompressed so far */
    uint64_t most;                     /* limit of decompressed bytes */
    bool is_gzip, is_open, is_between; /* is_between: not inside a member of the gzip file */
    bool (*goes_on)(void *context);
    void *context;
    struct problem problem; /* why reading stopped; PROBLEM_NONE: it did not */
    z_stream inflate;
    uint8_t bytes[16384];
    uint8_t plain[65536];
};

/* goes_on: called at every block; when it returns false it has filled problem. most: see the struct. */
NODISCARD bool unpack_source_open(struct unpack_source *source, struct archive *archive, int file, uint64_t most,
                                  bool (*goes_on)(void *context), void *context);
/* True if the n bytes at an offset equal expected. False with source->problem where they cannot be read. */
bool unpack_source_has(struct unpack_source *source, uint64_t at, const void *expected, size_t n);
/* Copies the first bytes, at most n; returns their number. */
size_t unpack_source_first(const struct unpack_source *source, uint8_t *bytes, size_t n);
/* The number of entries in a zip's directory. False: there is no directory, or the number is in its ZIP64 form. */
bool unpack_source_zip_entries(const struct unpack_source *source, uint32_t *n_entries);
/* gzip: reads to the end of the file, so that every check sum is verified. */
NODISCARD bool unpack_source_drain(struct unpack_source *source);
void unpack_source_finish(struct unpack_source *source);
