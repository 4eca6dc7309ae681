#pragma once
/* Bare zlib streams, SERA's ".sz": no length anywhere, so the caller says how much there may be. */
#include "core/base/error.h"
#include "core/formats/folder.h"

/* Everything, at most limit bytes, with a zero behind. errors ERROR_FORMAT, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool zlib_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out, struct error *err);

/* A file as SERA packs it: gzip by its first bytes, a bare zlib stream by the ending .sz (raw voxels may begin like one); else out is
 * empty and is_packed false. errors as zlib_all and gzip_all */
NODISCARD bool sera_unpack(const struct bytes *file, const char *name, uint64_t limit, bool *is_packed, struct bytes *out,
                           struct error *err);
