#pragma once
/* A chunk: up to SOFT_CHUNK_PRIMITIVES triangles, lines or points of one shape, of which those are kept for rasterising
 * that face the viewer and hold a sample, as triangles and rectangles clipped at the near plane. Knows no kind of
 * shape. */
#include "core/base/error.h"
#include "core/render/soft/drawables.h"
#include "core/render/visible/visible.h"

enum { SOFT_CHUNK_PRIMITIVES = 4096 };

struct soft_paint;
struct clip_set; /* core/render/visible/draw.h */

/* A shape of the draw list, as the rasteriser draws it. */
struct soft_item {
    const struct soft_shape *shape;
    struct soft_lighting lighting;
    struct visible_look look;
    struct visible_cue cue;         /* lines */
    double size;                    /* look.size_px in sub-samples */
    const struct soft_paint *paint; /* laid over its samples; NULL: none */
    struct soft_vertex *vertices;
    struct soft_cuts cuts;
    uint8_t *above; /* by vertex, bits of cuts; NULL: nothing is cut off */
    size_t first_chunk, n_chunks;
};

/* A triangle or rectangle that is kept. */
struct soft_kept {
    uint32_t ref; /* as in soft_triangles */
    uint16_t first_band, last_band;
};

struct soft_chunk {
    const struct soft_item *item;
    size_t first, n; /* triangles, segments or points */
    struct soft_kept *kept;
    size_t n_kept, kept_capacity;
    struct soft_vertex *extras; /* [n_extras][3] corners that are not the mesh's own: clipped, flat, lines, points */
    size_t n_extras, extras_capacity;
    uint32_t *refs; /* by band: band b has refs[starts[b]] .. refs[starts[b + 1] - 1] */
    size_t refs_capacity;
    uint32_t *starts;
    size_t starts_capacity;
};
void soft_chunk_finish(struct soft_chunk *chunk);

/* Grows an array to n elements of size bytes at least. array: address of the pointer to it. False: no memory. */
NODISCARD bool soft_reserve(void *array, size_t *capacity, size_t n, size_t size);

/* True if a triangle faces the viewer and its box holds a sample of the picture. Always fills the bands. */
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

/* A corner before the division by w and rounding. */
struct soft_corner {
    double x, y, z, w;             /* x, y: sub-samples times w; z: depth times w */
    double shade[4];               /* red, green, blue, alpha, 0..255 */
    const struct soft_vertex *own; /* the same corner rounded, as the triangles around it use it; or NULL. Its shade is
                                      not used */
};
enum { SOFT_CLIP_PLANES = 5, SOFT_MAX_CORNERS = 4 + SOFT_CLIP_PLANES + SOFT_MAX_CUTS };
struct soft_polygon {
    int n;
    struct soft_corner corners[SOFT_MAX_CORNERS];
};
void soft_project(const struct soft_lighting *lighting, double x, double y, double z, struct soft_corner *corner);
/* The planes of a set. A capped plane cuts off what lies in it, which the cap covers; another one does not. */
struct soft_cuts soft_cuts_of(const struct clip_set *clip);
/* Cuts the part above the item's planes off a polygon of mesh vertices, and projects what is left. Neighbours at an
 * edge get the same corners, which are those of cut_mesh. shades: of the corners, 0..255; vertices: at most 4. */
void soft_cut_polygon(const struct soft_item *item, const uint32_t *vertices, int n, const uint32_t *shades,
                      struct soft_polygon *polygon);
/* Cuts the part above the item's planes off a segment between mesh vertices. False: nothing is left. */
bool soft_cut_segment(const struct soft_item *item, const uint32_t vertices[2], struct vec3 ends_lps_mm[2]);
NODISCARD bool soft_keep_triangle(struct soft_chunk *chunk, const struct soft_vertex triangle[3], int width,
                                  int height);
/* Adds the rectangle with the corners low (left, top) and high; depth and colour are those of low. */
NODISCARD bool soft_keep_rectangle(struct soft_chunk *chunk, const struct soft_vertex *low,
                                   const struct soft_vertex *high, int width, int height);
/* Clips the polygon at the near plane and at the rasteriser's range. shade: of the whole polygon; NULL: the corners'.
 */
NODISCARD bool soft_keep_polygon(struct soft_chunk *chunk, struct soft_polygon *polygon, const uint32_t *shade,
                                 int width, int height);
