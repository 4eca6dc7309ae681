#pragma once
/* Unpacks bare zlib streams, SERA's ".sz". They hold no length, so the caller gives a limit. Streams are read to the
 * end, where the Adler-32 is compared (a weak checksum: a few small changes in a row can leave it unchanged). Zero
 * bytes after it are padding; anything else is refused. */
#include "core/base/error.h"
#include "core/formats/folder.h"

/* Unpacks everything, at most limit bytes, and adds a zero byte. errors ERROR_FORMAT, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool zlib_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out,
                        struct error *err);

/* Unpacks a file as SERA packs it: gzip by its first bytes or the ending .gz, a bare zlib stream by the ending .sz
 * alone, as raw voxels may begin like one. Else out is empty and is_packed false. errors as zlib_all and gzip_all;
 * ERROR_FORMAT a file named .gz that is no gzip stream */
NODISCARD bool sera_unpack(const struct bytes *file, const char *name, uint64_t limit, bool *is_packed,
                           struct bytes *out, struct error *err);
