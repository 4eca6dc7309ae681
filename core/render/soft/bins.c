#include "core/render/soft/bins.h"

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

/* Room for n things of size bytes at *array; keeps what is there. */
static bool reserve(void *array, size_t *capacity, size_t n, size_t size)
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
    const double guard = SOFT_GUARD / 2; /* well inside what can be drawn */
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

/* I. E. Sutherland, G. W. Hodgman, Reentrant Polygon Clipping, CACM 1974. */
static void clip(struct soft_polygon *polygon)
{
    for (int plane = 0; plane < SOFT_CLIP_PLANES; plane++) {
        struct soft_polygon kept = { 0 };
        for (int i = 0; i < polygon->n; i++) {
            const struct soft_corner *a = &polygon->corners[i], *b = &polygon->corners[(i + 1) % polygon->n];
            double fa = inside(a, plane), fb = inside(b, plane);
            if (fa >= 0 && kept.n < SOFT_MAX_CORNERS)
                kept.corners[kept.n++] = *a;
            if ((fa >= 0) != (fb >= 0) &&
                kept.n < SOFT_MAX_CORNERS) /* from the inner one, so that a neighbour gets the same point */
                kept.corners[kept.n++] = fa >= 0 ? between(a, b, fa / (fa - fb)) : between(b, a, fb / (fb - fa));
        }
        *polygon = kept;
    }
}

static struct soft_vertex to_vertex(const struct soft_corner *corner)
{
    if (corner->own && corner->own->x != SOFT_CLIPPED)
        return *corner->own;
    struct soft_vertex vertex = { (int32_t)lround(corner->x / corner->w), (int32_t)lround(corner->y / corner->w),
                                  (float)(corner->z / corner->w), 0 };
    for (int c = 0; c < 4; c++)
        vertex.shade |= (uint32_t)(corner->shade[c] + 0.5) << 8 * c;
    return vertex;
}

/* Whether a triangle faces the viewer and its box holds a sample, and in which bands. */
static bool can_be_seen(const struct soft_vertex *a, const struct soft_vertex *b, const struct soft_vertex *c,
                        int width, int height, struct soft_kept *kept)
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

static bool keep(struct soft_chunk *chunk, const struct soft_vertex corners[3], uint32_t kind, struct soft_kept kept)
{
    if (!reserve(&chunk->extras, &chunk->extras_capacity, 3 * (chunk->n_extras + 1), sizeof *chunk->extras) ||
        !reserve(&chunk->kept, &chunk->kept_capacity, chunk->n_kept + 1, sizeof *chunk->kept))
        return false;
    memcpy(&chunk->extras[3 * chunk->n_extras], corners, 3 * sizeof *corners);
    kept.ref = kind | (uint32_t)chunk->n_extras++;
    chunk->kept[chunk->n_kept++] = kept;
    return true;
}

bool soft_keep_triangle(struct soft_chunk *chunk, const struct soft_vertex triangle[3], int width, int height)
{
    struct soft_kept kept;
    return !can_be_seen(&triangle[0], &triangle[1], &triangle[2], width, height, &kept) ||
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

/* The light on a triangle of its own plane, seen from its middle; from behind, where that can be, the plane's other
 * side. */
static uint32_t flat_shade(const struct soft_item *item, const uint32_t *corners)
{
    const struct soft_points *points = &item->shape->points;
    const float *viewer = item->lighting.viewer;
    struct vec3 p[3];
    for (int i = 0; i < 3; i++)
        p[i] = vec3((double)points->x[corners[i]], (double)points->y[corners[i]], (double)points->z[corners[i]]);
    struct vec3 middle = vec3_scale(vec3_add(vec3_add(p[0], p[1]), p[2]), 1 / 3.0);
    struct vec3 n = vec3_normalize(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])));
    struct vec3 t = vec3_normalize(
        vec3_sub(vec3((double)viewer[0], (double)viewer[1], (double)viewer[2]), vec3_scale(middle, (double)viewer[3])));
    return soft_light(&item->lighting, (float[3]){ (float)n.x, (float)n.y, (float)n.z },
                      (float[3]){ (float)t.x, (float)t.y, (float)t.z });
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

/* A corner's light: of the triangle, and as far as the look wants it of the corner's own normal. */
static uint32_t round_off(const struct soft_item *item, uint32_t flat, uint32_t own)
{
    uint32_t share = (uint32_t)lround(256 * item->look.rounding), mixed = 0;
    for (int shift = 0; shift < 32; shift += 8)
        mixed |= ((flat >> shift & 255) * (256 - share) + (own >> shift & 255) * share + 128) >> 8 << shift;
    return mixed;
}

static bool keep_clipped(struct soft_chunk *chunk, const uint32_t *corners, const uint32_t *shade, int width,
                         int height)
{
    const struct soft_item *item = chunk->item;
    const struct soft_points *points = &item->shape->points;
    struct soft_polygon polygon = { .n = 3 };
    for (int i = 0; i < 3; i++) {
        struct soft_corner *corner = &polygon.corners[i];
        soft_project(&item->lighting, (double)points->x[corners[i]], (double)points->y[corners[i]],
                     (double)points->z[corners[i]], corner);
        corner->own = &item->vertices[corners[i]];
        uint32_t own = shade ? round_off(item, *shade, corner->own->shade) : corner->own->shade;
        for (int c = 0; c < 4; c++)
            corner->shade[c] = (double)(own >> 8 * c & 255);
        if (item->look.rounding > 0)
            corner->own = NULL; /* its light is not this */
    }
    return soft_keep_polygon(chunk, &polygon, item->look.rounding > 0 ? NULL : shade, width, height);
}

static bool is_in_picture(const struct soft_vertex *a, const struct soft_vertex *b, const struct soft_vertex *c)
{
    return (a->x != SOFT_CLIPPED) & (b->x != SOFT_CLIPPED) & (c->x != SOFT_CLIPPED);
}

/* One that the mesh's own corners cannot stand for. */
static bool keep_special(struct soft_chunk *chunk, const uint32_t *corners, int width, int height)
{
    const struct soft_item *item = chunk->item;
    bool is_flat = item->look.is_flat || item->shape->is_faceted;
    const struct soft_vertex *vertices = item->vertices;
    struct soft_vertex triangle[3] = { vertices[corners[0]], vertices[corners[1]], vertices[corners[2]] };
    if (!is_in_picture(&triangle[0], &triangle[1], &triangle[2])) {
        uint32_t shade = is_flat ? flat_shade(item, corners) : 0, behind[3] = { corners[0], corners[2], corners[1] };
        return keep_clipped(chunk, corners, is_flat ? &shade : NULL, width, height) &&
               (!item->look.is_two_sided || keep_clipped(chunk, behind, is_flat ? &shade : NULL, width, height));
    }
    struct soft_kept kept;
    bool is_seen = can_be_seen(&triangle[0], &triangle[1], &triangle[2], width, height, &kept);
    if (!is_seen && item->look.is_two_sided) {
        triangle[1] = vertices[corners[2]];
        triangle[2] = vertices[corners[1]];
        is_seen = can_be_seen(&triangle[0], &triangle[1], &triangle[2], width, height, &kept);
    }
    if (is_seen && is_flat) {
        uint32_t flat = flat_shade(item, corners);
        for (int i = 0; i < 3; i++)
            triangle[i].shade = round_off(item, flat, triangle[i].shade);
    }
    return !is_seen || soft_keep_triangle(chunk, triangle, width, height);
}

static bool keep_triangles(struct soft_chunk *chunk, int width, int height)
{
    const struct soft_item *item = chunk->item;
    bool is_special = item->look.is_flat || item->shape->is_faceted || item->look.is_two_sided;
    for (size_t t = chunk->first; t < chunk->first + chunk->n; t++) {
        const uint32_t *corners = item->shape->indices + 3 * t;
        const struct soft_vertex *a = &item->vertices[corners[0]], *b = &item->vertices[corners[1]],
                                 *c = &item->vertices[corners[2]];
        if (is_special | !is_in_picture(a, b, c)) {
            if (!keep_special(chunk, corners, width, height))
                return false;
        } else {
            if (chunk->n_kept == chunk->kept_capacity &&
                !reserve(&chunk->kept, &chunk->kept_capacity, chunk->n_kept + SOFT_CHUNK_PRIMITIVES,
                         sizeof *chunk->kept))
                return false;
            struct soft_kept *kept = &chunk->kept[chunk->n_kept]; /* written anyway: a branch less */
            kept->ref = (uint32_t)t;
            chunk->n_kept += can_be_seen(a, b, c, width, height, kept);
        }
    }
    return true;
}

static bool keep_all(struct soft_chunk *chunk, int width, int height)
{
    chunk->n_kept = chunk->n_extras = 0;
    switch (chunk->item->shape->kind) {
    case SHAPE_TRIANGLES: return keep_triangles(chunk, width, height);
    case SHAPE_LINES: return soft_keep_lines(chunk, width, height);
    case SHAPE_POINTS: return soft_keep_points(chunk, width, height);
    }
    return true;
}

bool soft_chunk_sort(struct soft_chunk *chunk, int width, int height, int n_bands)
{
    size_t n_starts = (size_t)n_bands + 1;
    if (!keep_all(chunk, width, height) ||
        !reserve(&chunk->starts, &chunk->starts_capacity, n_starts, sizeof *chunk->starts))
        return false;
    /* count[b + 1], summed up to ends, then filled from the back of each band so that ends become starts */
    uint32_t *starts = chunk->starts;
    memset(starts, 0, n_starts * sizeof *starts);
    for (size_t i = 0; i < chunk->n_kept; i++)
        for (int band = chunk->kept[i].first_band; band <= chunk->kept[i].last_band; band++)
            starts[band]++;
    uint64_t n_refs = 0;
    for (int band = 0; band < n_bands; band++) {
        n_refs += starts[band];
        starts[band] = (uint32_t)n_refs;
    }
    starts[n_bands] = (uint32_t)n_refs;
    if (n_refs > UINT32_MAX || !reserve(&chunk->refs, &chunk->refs_capacity, (size_t)n_refs, sizeof *chunk->refs))
        return false;
    for (size_t i = chunk->n_kept; i-- > 0;)
        for (int band = chunk->kept[i].first_band; band <= chunk->kept[i].last_band; band++)
            chunk->refs[--starts[band]] = chunk->kept[i].ref;
    return true;
}
