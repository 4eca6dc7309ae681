#pragma once
/* Unpacks gzip streams in memory, of one or several members. The length in a stream is never trusted: the caller gives
 * the limit. A stream is always read to its end, and checksum and length of every member are compared, so the bytes
 * that are returned are the bytes that were packed. Zero bytes after the last member are padding; anything else there
 * is refused, since it may be a member whose first bytes were damaged. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/formats/folder.h"

bool gzip_is(const uint8_t *data, size_t size);

/* Unpacks the first bytes, up to capacity; data may be cut short. Returns how many; 0 when the stream is damaged from
 * the start, or without memory (error_n_memory). */
size_t gzip_head(const uint8_t *data, size_t size, uint8_t *out, size_t capacity);

/* Bytes that a stream may hold beyond the size that the caller requested. */
#define GZIP_MOST_MORE ((uint64_t)64 << 20)

/* Unpacks the first n bytes to out. n_more: how many bytes follow; they are checked and discarded.
 * errors ERROR_FORMAT damaged, with the place, or fewer than n bytes inside; ERROR_LIMIT more than GZIP_MOST_MORE
 *        follow; ERROR_MEMORY */
NODISCARD bool gzip_exact(const uint8_t *data, size_t size, const char *name, uint8_t *out, size_t n, uint64_t *n_more,
                          struct error *err);

/* Unpacks everything, at most limit bytes. errors ERROR_FORMAT, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool gzip_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out,
                        struct error *err);

/* The most bytes that n compressed bytes can hold: deflate reaches at most 1032 to 1. */
uint64_t gzip_most(uint64_t compressed_bytes);

/* True if the bytes after a stream are all zero, or there are none. */
bool gzip_is_padding(const uint8_t *data, size_t size);
