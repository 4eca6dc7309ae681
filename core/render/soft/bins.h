#pragma once
/* Which triangles can be seen, and in which bands of the picture; lines and points become triangles here. A shape is
 * taken in chunks, each by one thread; bands then go through the chunks in order, so that pictures do not depend on the
 * number of threads. */
#include "core/base/error.h"
#include "core/render/soft/cache.h"
#include "core/render/visible/visible.h"

enum { SOFT_CHUNK_PRIMITIVES = 4096 };

/* A shape to draw. */
struct soft_item {
    const struct soft_shape *shape;
    struct soft_lighting lighting;
    bool is_opaque;
    struct visible_look look;
    struct visible_cue cue; /* lines */
    double size;            /* look.size_px in sub-samples */
    struct soft_vertex *vertices;
    size_t first_chunk, n_chunks;
};

struct soft_kept {
    uint32_t ref;
    uint16_t first_band, last_band;
};

struct soft_chunk {
    const struct soft_item *item;
    size_t first, n; /* triangles, segments or points */
    struct soft_kept *kept;
    size_t n_kept, kept_capacity;
    struct soft_vertex
        *extras; /* corners of triangles that are not the mesh's own: clipped or flat ones, lines, points */
    size_t n_extras, extras_capacity;
    uint32_t *refs; /* by band; band b has starts[b] .. starts[b + 1] */
    size_t refs_capacity;
    uint32_t *starts;
    size_t starts_capacity;
};
void soft_chunk_finish(struct soft_chunk *chunk);

/* Sorts the chunk's triangles that face the viewer (or are seen from both sides) and hold a sample into n_bands bands
 * of a picture of width x height samples. errors ERROR_MEMORY */
NODISCARD bool soft_chunk_sort(struct soft_chunk *chunk, int width, int height, int n_bands);

/* Inside core/render/soft: triangles for a chunk. False: no memory. */
struct soft_corner { /* place times w in sub-samples, depth times w, w, and its light by component */
    double x, y, z, w, shade[4];
    const struct soft_vertex *own; /* already rounded as its neighbours see it, or NULL */
};
enum { SOFT_CLIP_PLANES = 5, SOFT_MAX_CORNERS = 4 + SOFT_CLIP_PLANES };
struct soft_polygon {
    int n;
    struct soft_corner corners[SOFT_MAX_CORNERS];
};
void soft_project(const struct soft_lighting *lighting, double x, double y, double z, struct soft_corner *corner);
NODISCARD bool soft_keep_triangle(struct soft_chunk *chunk, const struct soft_vertex triangle[3], int width,
                                  int height);
/* From low to high, of low's depth and colour. */
NODISCARD bool soft_keep_rectangle(struct soft_chunk *chunk, const struct soft_vertex *low,
                                   const struct soft_vertex *high, int width, int height);
/* Cuts off what lies before the near plane or too far out. shade: of all of it, or NULL: the corners'. */
NODISCARD bool soft_keep_polygon(struct soft_chunk *chunk, struct soft_polygon *polygon, const uint32_t *shade,
                                 int width, int height);
NODISCARD bool soft_keep_lines(struct soft_chunk *chunk, int width, int height);
NODISCARD bool soft_keep_points(struct soft_chunk *chunk, int width, int height);
