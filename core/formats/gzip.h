#pragma once
/* Gzip streams in memory, of one or several members. The length a stream claims for itself is never trusted: the caller
 * says how much there may be. A stream is always read to its end, and the checksum and length of every member are
 * compared: bytes that are handed out are the bytes that were packed. Zero bytes behind the last member are padding;
 * anything else there is refused, since it may be a member whose first bytes were damaged. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/formats/folder.h"

bool gzip_is(const uint8_t *data, size_t size);

/* The first bytes of what is inside, as many as there are up to capacity; data may itself be cut short.
 * Returns how many; 0 when the stream is broken from the start. */
size_t gzip_head(const uint8_t *data, size_t size, uint8_t *out, size_t capacity);

/* How many bytes more than the caller asked for a stream may hold. */
#define GZIP_MOST_MORE ((uint64_t)64 << 20)

/* The first n bytes into out; n_more: how many follow them inside, which are checked and left.
 * errors ERROR_FORMAT damaged, with the place, or fewer than n bytes inside; ERROR_LIMIT more than GZIP_MOST_MORE
 * follow; ERROR_MEMORY */
NODISCARD bool gzip_exact(const uint8_t *data, size_t size, const char *name, uint8_t *out, size_t n, uint64_t *n_more,
                          struct error *err);

/* Everything, at most limit bytes. errors ERROR_FORMAT, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool gzip_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out,
                        struct error *err);

/* Most that so many compressed bytes can hold: deflate never does better than 1032 to 1. */
uint64_t gzip_most(uint64_t compressed_bytes);

/* Whether what follows a stream is nothing but zero bytes, or nothing at all. */
bool gzip_is_padding(const uint8_t *data, size_t size);
