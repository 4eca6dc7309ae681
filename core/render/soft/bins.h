#pragma once
/* Which triangles can be seen, and in which bands of the picture. A surface is taken in chunks, each by one thread; bands then go
 * through the chunks in order, so that pictures do not depend on the number of threads. */
#include "core/base/error.h"
#include "core/render/soft/cache.h"

enum { SOFT_CHUNK_TRIANGLES = 4096 };

/* A surface to draw. */
struct soft_item {
    const struct soft_surface *surface;
    struct soft_lighting lighting;
    bool is_opaque, is_flat; /* flat: lit by each triangle's own plane */
    struct soft_vertex *vertices;
    size_t first_chunk, n_chunks;
};

struct soft_kept {
    uint32_t ref;
    uint16_t first_band, last_band;
};

struct soft_chunk {
    const struct soft_item *item;
    size_t first, n; /* triangles */
    struct soft_kept *kept;
    size_t n_kept, kept_capacity;
    struct soft_vertex *extras; /* corners of triangles that are not the surface's own: clipped or flat ones */
    size_t n_extras, extras_capacity;
    uint32_t *refs; /* by band; band b has starts[b] .. starts[b + 1] */
    size_t refs_capacity;
    uint32_t *starts;
    size_t starts_capacity;
};
void soft_chunk_finish(struct soft_chunk *chunk);

/* Sorts the chunk's triangles that face the viewer and hold a sample into n_bands bands of a picture of width x height samples.
 * errors ERROR_MEMORY */
NODISCARD bool soft_chunk_sort(struct soft_chunk *chunk, int width, int height, int n_bands);
