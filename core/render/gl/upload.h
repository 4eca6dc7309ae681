#pragma once
/* A shape to the graphics card, for cache.c. */
#include "core/render/gl/cache.h"

/* n_passes: of shading_normals. Adds what it takes to *n_bytes. On failure what was made is the caller's to delete.
 * errors ERROR_GL, ERROR_MEMORY, ERROR_LIMIT */
NODISCARD bool gl_upload_shape(const struct gl *gl, const struct shape *shape, int n_passes, struct gl_shape *out,
                               uint64_t *n_bytes, struct error *err);
