/* The triangles and rectangles that are kept of a chunk: visibility, clipping, storing. */
#include "core/render/soft/chunk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void soft_chunk_finish(struct soft_chunk *chunk)
{
    free(chunk->kept);
    free(chunk->extras);
    free(chunk->refs);
    free(chunk->starts);
}

bool soft_reserve(void *array, size_t *capacity, size_t n, size_t size)
{
    if (n <= *capacity)
        return true;
    size_t grown = n + n / 2 + 64;
    void *old, *moved = NULL;
    memcpy(&old, array, sizeof old);
    if (grown <= SIZE_MAX / size)
        moved = realloc(old, grown * size);
    if (!moved)
        return false;
    memcpy(array, &moved, sizeof moved);
    *capacity = grown;
    return true;
}

static double inside(const struct soft_corner *corner, int plane)
{
    const double guard = SOFT_GUARD / 2; /* well inside the range that can be rasterised */
    switch (plane) {
    case 0: return corner->z + corner->w;
    case 1: return corner->x + guard * corner->w;
    case 2: return guard * corner->w - corner->x;
    case 3: return corner->y + guard * corner->w;
    default: return guard * corner->w - corner->y;
    }
}

static struct soft_corner between(const struct soft_corner *a, const struct soft_corner *b, double t)
{
    struct soft_corner out = { a->x + t * (b->x - a->x),
                               a->y + t * (b->y - a->y),
                               a->z + t * (b->z - a->z),
                               a->w + t * (b->w - a->w),
                               { 0 },
                               NULL };
    for (int c = 0; c < 4; c++)
        out.shade[c] = a->shade[c] + t * (b->shade[c] - a->shade[c]);
    return out;
}

/* Source: I. E. Sutherland, G. W. Hodgman, Reentrant Polygon Clipping, CACM 1974. */
static void clip(struct soft_polygon *polygon)
{
    for (int plane = 0; plane < SOFT_CLIP_PLANES; plane++) {
        bool is_whole = true;
        for (int i = 0; i < polygon->n; i++)
            is_whole &= inside(&polygon->corners[i], plane) >= 0;
        if (is_whole)
            continue;
        struct soft_polygon kept;
        kept.n = 0;
        for (int i = 0; i < polygon->n; i++) {
            const struct soft_corner *a = &polygon->corners[i], *b = &polygon->corners[(i + 1) % polygon->n];
            double fa = inside(a, plane), fb = inside(b, plane);
            if (fa >= 0 && kept.n < SOFT_MAX_CORNERS)
                kept.corners[kept.n++] = *a;
            if ((fa >= 0) != (fb >= 0) && kept.n < SOFT_MAX_CORNERS) /* from the inner corner, so that the neighbour at
                                                                        this edge gets the same point */
                kept.corners[kept.n++] = fa >= 0 ? between(a, b, fa / (fa - fb)) : between(b, a, fb / (fb - fa));
        }
        *polygon = kept;
    }
}

static struct soft_vertex to_vertex(const struct soft_corner *corner)
{
    struct soft_vertex vertex;
    if (corner->own && corner->own->x != SOFT_CLIPPED)
        vertex = *corner->own;
    else
        vertex = (struct soft_vertex){ (int32_t)lround(corner->x / corner->w), (int32_t)lround(corner->y / corner->w),
                                       (float)(corner->z / corner->w), 0 };
    vertex.shade = 0;
    for (int c = 0; c < 4; c++)
        vertex.shade |= (uint32_t)(corner->shade[c] + 0.5) << 8 * c;
    return vertex;
}

static bool keep(struct soft_chunk *chunk, const struct soft_vertex corners[3], uint32_t kind, struct soft_kept kept)
{
    if (!soft_reserve(&chunk->extras, &chunk->extras_capacity, 3 * (chunk->n_extras + 1), sizeof *chunk->extras) ||
        !soft_reserve(&chunk->kept, &chunk->kept_capacity, chunk->n_kept + 1, sizeof *chunk->kept))
        return false;
    memcpy(&chunk->extras[3 * chunk->n_extras], corners, 3 * sizeof *corners);
    kept.ref = kind | (uint32_t)chunk->n_extras++;
    chunk->kept[chunk->n_kept++] = kept;
    return true;
}

bool soft_keep_triangle(struct soft_chunk *chunk, const struct soft_vertex triangle[3], int width, int height)
{
    struct soft_kept kept;
    return !soft_can_be_seen(&triangle[0], &triangle[1], &triangle[2], width, height, &kept) ||
           keep(chunk, triangle, SOFT_EXTRA, kept);
}

bool soft_keep_rectangle(struct soft_chunk *chunk, const struct soft_vertex *low, const struct soft_vertex *high,
                         int width, int height)
{
    int left = (low->x + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS,
        right = ((high->x + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS) - 1;
    int top = (low->y + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS,
        bottom = ((high->y + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS) - 1;
    top = top > 0 ? top : 0;
    bottom = bottom < height ? bottom : height - 1;
    if (left > right || top > bottom || left >= width || right < 0)
        return true;
    const struct soft_vertex corners[3] = { *low, *high, *high };
    return keep(chunk, corners, SOFT_EXTRA | SOFT_RECTANGLE,
                (struct soft_kept){ 0, (uint16_t)(top / SOFT_BAND_ROWS), (uint16_t)(bottom / SOFT_BAND_ROWS) });
}

static double apply(const float row[4], double x, double y, double z)
{
    return (double)row[0] * x + (double)row[1] * y + (double)row[2] * z + (double)row[3];
}

void soft_project(const struct soft_lighting *l, double x, double y, double z, struct soft_corner *corner)
{
    *corner = (struct soft_corner){ apply(l->row_x, x, y, z),
                                    apply(l->row_y, x, y, z),
                                    apply(l->row_z, x, y, z),
                                    apply(l->row_w, x, y, z),
                                    { 0 },
                                    NULL };
}

bool soft_keep_polygon(struct soft_chunk *chunk, struct soft_polygon *polygon, const uint32_t *shade, int width,
                       int height)
{
    clip(polygon);
    for (int i = 2; i < polygon->n; i++) {
        struct soft_vertex triangle[3] = { to_vertex(&polygon->corners[0]), to_vertex(&polygon->corners[i - 1]),
                                           to_vertex(&polygon->corners[i]) };
        for (int corner = 0; shade && corner < 3; corner++)
            triangle[corner].shade = *shade;
        if (!soft_keep_triangle(chunk, triangle, width, height))
            return false;
    }
    return true;
}
