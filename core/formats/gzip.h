#pragma once
/* Gzip streams in memory, of one or several members. The length a stream claims for itself is never trusted: the caller
 * says how much there may be. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/formats/folder.h"

bool gzip_is(const uint8_t *data, size_t size);

/* The first bytes of what is inside, as many as there are up to capacity; data may itself be cut short.
 * Returns how many; 0 when the stream is broken from the start. */
size_t gzip_head(const uint8_t *data, size_t size, uint8_t *out, size_t capacity);

/* Exactly n bytes from the start; what follows them is left. out holds n.
 * errors ERROR_FORMAT broken, or fewer than n bytes inside; ERROR_MEMORY */
NODISCARD bool gzip_exact(const uint8_t *data, size_t size, const char *name, uint8_t *out, size_t n, struct error *err);

/* Everything, at most limit bytes. errors ERROR_FORMAT, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool gzip_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out, struct error *err);

/* Most that so many compressed bytes can hold: deflate never does better than 1032 to 1. */
uint64_t gzip_most(uint64_t compressed_bytes);
