#pragma once
/* Bare zlib streams, SERA's ".sz": no length anywhere, so the caller says how much there may be. Read to the end, where
 * the Adler-32 is compared (a weak sum: a few small changes in a row can leave it as it is); zero bytes behind it are
 * padding, anything else is refused. */
#include "core/base/error.h"
#include "core/formats/folder.h"

/* Everything, at most limit bytes, with a zero behind. errors ERROR_FORMAT, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool zlib_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out,
                        struct error *err);

/* A file as SERA packs it: gzip by its first bytes or the ending .gz, a bare zlib stream by the ending .sz (raw voxels
 * may begin like one); else out is empty and is_packed false. errors as zlib_all and gzip_all; ERROR_FORMAT named .gz
 * and no gzip stream */
NODISCARD bool sera_unpack(const struct bytes *file, const char *name, uint64_t limit, bool *is_packed,
                           struct bytes *out, struct error *err);
