/* Keeps the lines and points of a chunk as rectangles that face the viewer. */
#include "core/render/soft/quads.h"

#include <math.h>

static uint32_t pack(const float color[3], float light, float opacity)
{
    uint32_t packed = (uint32_t)(opacity * 255.0f + 0.5f) << 24;
    for (int c = 0; c < 3; c++)
        packed |= (uint32_t)(color[c] * light * 255.0f + 0.5f) << 8 * c;
    return packed;
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

static float cue_at(const struct visible_cue *cue, double x, double y, double z)
{
    return (float)fmin(1, fmax(VISIBLE_DARKEST, cue->x * x + cue->y * y + cue->z * z + cue->w));
}

/* Moves b to the near plane if it lies in front of it; false: a does too. */
static bool cut(const struct soft_corner *a, struct soft_corner *b)
{
    double fa = a->z + a->w, fb = b->z + b->w, t;
    if (fb >= 0)
        return true;
    if (!(fa > 0))
        return false;
    t = fa / (fa - fb);
    *b = (struct soft_corner){ a->x + t * (b->x - a->x),
                               a->y + t * (b->y - a->y),
                               a->z + t * (b->z - a->z),
                               a->w + t * (b->w - a->w),
                               { 0 },
                               NULL };
    return true;
}

static bool is_beside(double a, double b, double margin, double last)
{
    return (a < -margin && b < -margin) || (a > last + margin && b > last + margin);
}

/* Keeps the rectangle around a segment. It is longer by half its width at both ends, so that there are no gaps between
 * the segments of a line. */
static bool keep_line(struct soft_chunk *chunk, struct soft_corner a, struct soft_corner b, uint32_t shade, int width,
                      int height)
{
    const double half = chunk->item->size / 2, guard = SOFT_GUARD / 4;
    if (!cut(&a, &b) || !cut(&b, &a) || !(a.w > 0) || !(b.w > 0))
        return true;
    double ax = a.x / a.w, ay = a.y / a.w, az = a.z / a.w - 2 * VISIBLE_LINE_DEPTH, bx = b.x / b.w, by = b.y / b.w,
           bz = b.z / b.w - 2 * VISIBLE_LINE_DEPTH;
    if (is_beside(ax, bx, 2 * half, (double)width * SOFT_SUB) || is_beside(ay, by, 2 * half, (double)height * SOFT_SUB))
        return true;
    double length = hypot(bx - ax, by - ay), dx = length > 1e-9 ? (bx - ax) / length * half : half,
           dy = length > 1e-9 ? (by - ay) / length * half : 0;
    /* counter-clockwise as seen, y down */
    const double x[4] = { ax - dx - dy, bx + dx - dy, bx + dx + dy, ax - dx + dy };
    const double y[4] = { ay - dy + dx, by + dy + dx, by + dy - dx, ay - dy - dx };
    struct soft_polygon polygon = { .n = 4 };
    bool is_far = false;
    for (int i = 0; i < 4; i++) {
        double z = i == 0 || i == 3 ? az : bz;
        polygon.corners[i] = (struct soft_corner){ x[i], y[i], z, 1, { 0 }, NULL };
        is_far |= fabs(x[i]) > guard || fabs(y[i]) > guard;
    }
    if (is_far)
        return soft_keep_polygon(chunk, &polygon, &shade, width, height);
    struct soft_vertex v[4];
    for (int i = 0; i < 4; i++)
        v[i] = (struct soft_vertex){ (int32_t)lround(x[i]), (int32_t)lround(y[i]), (float)polygon.corners[i].z, shade };
    return soft_keep_triangle(chunk, (struct soft_vertex[3]){ v[0], v[1], v[2] }, width, height) &&
           soft_keep_triangle(chunk, (struct soft_vertex[3]){ v[0], v[2], v[3] }, width, height);
}

bool soft_keep_lines(struct soft_chunk *chunk, int width, int height)
{
    const struct soft_item *item = chunk->item;
    const struct soft_points *points = &item->shape->points;
    for (size_t s = chunk->first; s < chunk->first + chunk->n; s++) {
        struct soft_corner ends[2];
        float cue = 0;
        const uint32_t *v = &item->shape->indices[2 * s];
        struct vec3 p[2];
        for (int i = 0; i < 2; i++)
            p[i] = vec3((double)points->x[v[i]], (double)points->y[v[i]], (double)points->z[v[i]]);
        if (item->above && item->above[v[0]] | item->above[v[1]] && !soft_cut_segment(item, v, p))
            continue;
        for (int i = 0; i < 2; i++) {
            soft_project(&item->lighting, p[i].x, p[i].y, p[i].z, &ends[i]);
            cue += cue_at(&item->cue, p[i].x, p[i].y, p[i].z) / 2;
        }
        if (!keep_line(chunk, ends[0], ends[1], pack(item->lighting.color, cue, item->lighting.opacity), width, height))
            return false;
    }
    return true;
}

/* ---- points ----------------------------------------------------------------------------------------------------- */

/* Half the extent of a voxel in the picture along x and y, in sub-samples: at least to its farthest corner. */
static void cover(const struct soft_item *item, const struct soft_corner *middle, double half[2])
{
    const struct soft_lighting *l = &item->lighting;
    double x = middle->x / middle->w, y = middle->y / middle->w, across[2] = { 0, 0 }, towards = 0;
    for (int i = 0; i < 3; i++) {
        const struct vec3 *e = &item->shape->edge_lps_mm[i];
        double ex = (double)l->row_x[0] * e->x + (double)l->row_x[1] * e->y + (double)l->row_x[2] * e->z;
        double ey = (double)l->row_y[0] * e->x + (double)l->row_y[1] * e->y + (double)l->row_y[2] * e->z;
        double ew = (double)l->row_w[0] * e->x + (double)l->row_w[1] * e->y + (double)l->row_w[2] * e->z;
        across[0] += fabs(ex - x * ew) / 2;
        across[1] += fabs(ey - y * ew) / 2;
        towards += fabs(ew) / 2;
    }
    double w = fmax(middle->w - towards, middle->w / 8); /* bounded for a voxel around the eye */
    half[0] = across[0] / w;
    half[1] = across[1] / w;
}

/* A border voxel of a part one voxel thin has no normal: it is shaded as if it faced the viewer. */
static uint32_t live_shade(const struct soft_item *item, size_t p)
{
    const struct soft_points *points = &item->shape->points;
    if (points->nx[p] | points->ny[p] | points->nz[p])
        return item->vertices[p].shade;
    const float *viewer = item->lighting.viewer;
    struct vec3 t = vec3_normalize(vec3((double)(viewer[0] - viewer[3] * points->x[p]),
                                        (double)(viewer[1] - viewer[3] * points->y[p]),
                                        (double)(viewer[2] - viewer[3] * points->z[p])));
    const float towards[3] = { (float)t.x, (float)t.y, (float)t.z };
    return soft_light(&item->lighting, towards, towards);
}

/* The extent along x or y in whole sub-samples: at least one sample, and at most 4 samples beyond the picture. */
static void extent(double middle, double half, bool is_covering, int n_samples, int32_t range[2])
{
    const double least = -4.0 * SOFT_SUB, most = (n_samples + 4.0) * SOFT_SUB;
    double side = fmax(2 * half, SOFT_SUB), low = middle - side / 2, high = low + side;
    low = fmin(fmax(is_covering ? floor(low) : round(low), least), most);
    high = fmin(fmax(is_covering ? ceil(high) : low + round(side), least), most);
    range[0] = (int32_t)low;
    range[1] = (int32_t)high;
}

bool soft_keep_points(struct soft_chunk *chunk, int width, int height)
{
    const struct soft_item *item = chunk->item;
    const struct soft_points *points = &item->shape->points;
    for (size_t p = chunk->first; p < chunk->first + chunk->n; p++) {
        struct soft_corner middle;
        if (item->above && item->above[p])
            continue;
        soft_project(&item->lighting, (double)points->x[p], (double)points->y[p], (double)points->z[p], &middle);
        if (!(middle.z + middle.w >= 0) || !(middle.w > 0))
            continue;
        double half[2] = { item->size / 2, item->size / 2 };
        if (item->look.is_covering)
            cover(item, &middle, half);
        int32_t x[2], y[2];
        extent(middle.x / middle.w, half[0], item->look.is_covering, width, x);
        extent(middle.y / middle.w, half[1], item->look.is_covering, height, y);
        float z = (float)(middle.z / middle.w);
        uint32_t shade = item->look.is_baked
                             ? pack(item->lighting.color, (float)item->shape->shade[p] / 255.0f, item->lighting.opacity)
                             : live_shade(item, p);
        if (!soft_keep_rectangle(chunk, &(struct soft_vertex){ x[0], y[0], z, shade },
                                 &(struct soft_vertex){ x[1], y[1], z, shade }, width, height))
            return false;
    }
    return true;
}
