/* Keeps the triangles of a chunk that can be seen. */
#include "core/render/soft/triangles.h"

#include <math.h>

/* The shaded colour of a triangle by its own normal, at its middle. */
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

/* A corner's colour: the triangle's, mixed with the vertex's own by the look's rounding. */
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
            corner->own = NULL; /* its shade differs */
    }
    return soft_keep_polygon(chunk, &polygon, item->look.rounding > 0 ? NULL : shade, width, height);
}

/* Keeps what the clip planes leave of a triangle. */
static bool keep_cut(struct soft_chunk *chunk, const uint32_t *corners, const uint32_t *flat, int width, int height)
{
    const struct soft_item *item = chunk->item;
    uint32_t shades[3];
    for (int i = 0; i < 3; i++) {
        uint32_t own = item->vertices[corners[i]].shade;
        shades[i] = flat ? round_off(item, *flat, own) : own;
    }
    struct soft_polygon polygon;
    soft_cut_polygon(item, corners, 3, shades, &polygon);
    return soft_keep_polygon(chunk, &polygon, NULL, width, height);
}

static bool is_in_picture(const struct soft_vertex *a, const struct soft_vertex *b, const struct soft_vertex *c)
{
    return (a->x != SOFT_CLIPPED) & (b->x != SOFT_CLIPPED) & (c->x != SOFT_CLIPPED);
}

/* Keeps a triangle that needs corners of its own: clipped, flat, or seen from behind. */
static bool keep_special(struct soft_chunk *chunk, const uint32_t *corners, int width, int height)
{
    const struct soft_item *item = chunk->item;
    bool is_flat = item->look.is_flat || item->shape->is_faceted;
    const struct soft_vertex *vertices = item->vertices;
    struct soft_vertex triangle[3] = { vertices[corners[0]], vertices[corners[1]], vertices[corners[2]] };
    if (!is_in_picture(&triangle[0], &triangle[1], &triangle[2])) {
        bool is_cut = false;
        if (item->above) {
            const uint8_t *above = item->above;
            if (above[corners[0]] & above[corners[1]] & above[corners[2]])
                return true;
            is_cut = above[corners[0]] | above[corners[1]] | above[corners[2]];
        }
        bool (*keep)(struct soft_chunk *, const uint32_t *, const uint32_t *, int, int) =
            is_cut ? keep_cut : keep_clipped;
        uint32_t shade = is_flat ? flat_shade(item, corners) : 0, behind[3] = { corners[0], corners[2], corners[1] };
        return keep(chunk, corners, is_flat ? &shade : NULL, width, height) &&
               (!item->look.is_two_sided || keep(chunk, behind, is_flat ? &shade : NULL, width, height));
    }
    struct soft_kept kept;
    bool is_seen = soft_can_be_seen(&triangle[0], &triangle[1], &triangle[2], width, height, &kept);
    if (!is_seen && item->look.is_two_sided) {
        triangle[1] = vertices[corners[2]];
        triangle[2] = vertices[corners[1]];
        is_seen = soft_can_be_seen(&triangle[0], &triangle[1], &triangle[2], width, height, &kept);
    }
    if (is_seen && is_flat) {
        uint32_t flat = flat_shade(item, corners);
        for (int i = 0; i < 3; i++)
            triangle[i].shade = round_off(item, flat, triangle[i].shade);
    }
    return !is_seen || soft_keep_triangle(chunk, triangle, width, height);
}

bool soft_keep_triangles(struct soft_chunk *chunk, int width, int height)
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
                !soft_reserve(&chunk->kept, &chunk->kept_capacity, chunk->n_kept + SOFT_CHUNK_PRIMITIVES,
                              sizeof *chunk->kept))
                return false;
            struct soft_kept *kept = &chunk->kept[chunk->n_kept]; /* always written: saves a branch */
            kept->ref = (uint32_t)t;
            chunk->n_kept += soft_can_be_seen(a, b, c, width, height, kept);
        }
    }
    return true;
}
