#pragma once
/* A chunk: up to SOFT_CHUNK_PRIMITIVES triangles, lines or points of one shape, and the triangles and rectangles that
 * are kept of them: what faces the viewer and holds a sample. Clips at the near plane. Knows no kind of shape. */
#include "core/base/error.h"
#include "core/render/soft/drawables.h"
#include "core/render/visible/visible.h"

enum { SOFT_CHUNK_PRIMITIVES = 4096 };

/* A shape to draw. */
struct soft_item {
    const struct soft_shape *shape;
    struct soft_lighting lighting;
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

/* Makes room for n elements of size bytes at *array, a pointer; keeps what is there. False: no memory. */
NODISCARD bool soft_reserve(void *array, size_t *capacity, size_t n, size_t size);

/* Whether a triangle faces the viewer and its box holds a sample, and in which bands. */
static inline bool soft_can_be_seen(const struct soft_vertex *a, const struct soft_vertex *b,
                                    const struct soft_vertex *c, int width, int height, struct soft_kept *kept)
{
    int32_t low_x = a->x, high_x = a->x, low_y = a->y, high_y = a->y;
    low_x = b->x < low_x ? b->x : low_x;
    high_x = b->x > high_x ? b->x : high_x;
    low_y = b->y < low_y ? b->y : low_y;
    high_y = b->y > high_y ? b->y : high_y;
    low_x = c->x < low_x ? c->x : low_x;
    high_x = c->x > high_x ? c->x : high_x;
    low_y = c->y < low_y ? c->y : low_y;
    high_y = c->y > high_y ? c->y : high_y;
    int left = (low_x + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS, right = (high_x - SOFT_SUB / 2) >> SOFT_SUB_BITS;
    int top = (low_y + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS, bottom = (high_y - SOFT_SUB / 2) >> SOFT_SUB_BITS;
    top = top > 0 ? top : 0;
    bottom = bottom < height ? bottom : height - 1;
    int64_t area = (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(b->y - a->y) * (c->x - a->x);
    kept->first_band = (uint16_t)(top / SOFT_BAND_ROWS);
    kept->last_band = (uint16_t)(bottom / SOFT_BAND_ROWS);
    return (area < 0) & (left <= right) & (top <= bottom) & (left < width) &
           (right >= 0); /* y is down: counter-clockwise is negative */
}

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
