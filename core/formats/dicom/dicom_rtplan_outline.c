/* Makes the outline of a field's opening, as polygons in the plane of the isocentre. */
#include <string.h>

#include "core/formats/dicom/dicom_rtplan_opening.h"

static size_t n_in_last(const struct beam_outline *outline, size_t n_points)
{
    return n_points - beam_outline_n_points(outline);
}

/* Adds a point to the polygon that is being made; of points on one line along an axis only the ends stay. */
static void add_point(struct beam_outline *outline, size_t *n_points, double x, double y)
{
    float(*points)[2] = outline->points_mm, at[2] = { (float)x, (float)y };
    size_t n = *n_points, of_this = n_in_last(outline, n);
    if (of_this >= 1 && points[n - 1][0] == at[0] && points[n - 1][1] == at[1])
        return;
    for (int axis = 0; axis < 2; axis++)
        if (of_this >= 2 && points[n - 1][axis] == at[axis] && points[n - 2][axis] == at[axis]) {
            memcpy(points[n - 1], at, sizeof at);
            return;
        }
    if (n < BEAM_OUTLINE_MAX_POINTS)
        memcpy(points[(*n_points)++], at, sizeof at);
}

static void end_polygon(struct beam_outline *outline, size_t n_points)
{
    if (n_in_last(outline, n_points) >= 3 && outline->n_polygons < BEAM_OUTLINE_MAX_POLYGONS)
        outline->ends[outline->n_polygons++] = (uint16_t)n_points;
}

/* ---- leaves ------------------------------------------------------------------------------------------------------ */
/* Adds the polygon of neighbouring pairs: up along one side, down along the other. */
static void add_pairs(struct beam_outline *outline, const struct opening_device *device,
                      const struct opening_rectangle *jaws, size_t first, size_t last)
{
    bool is_x = opening_moves_along_x(device);
    size_t n = beam_outline_n_points(outline);
    for (int side = 1; side >= 0; side--)
        for (size_t i = 0; i <= last - first; i++) {
            struct opening_rectangle gap;
            if (!opening_between(device, side ? first + i : last - i, jaws, &gap))
                continue;
            const double *along = is_x ? gap.x : gap.y, *across = is_x ? gap.y : gap.x;
            for (int end = 0; end < 2; end++) {
                double at = across[side ? end : 1 - end];
                add_point(outline, &n, is_x ? along[side] : at, is_x ? at : along[side]);
            }
        }
    end_polygon(outline, n);
}

static void outline_leaves(struct beam_outline *outline, const struct opening_device *device,
                           const struct opening_rectangle *jaws)
{
    bool is_x = opening_moves_along_x(device), was_open = false;
    struct opening_rectangle gap = *jaws, before = *jaws;
    size_t first = 0;
    outline->kind = BEAM_OUTLINE_LEAVES;
    outline->n_polygons = 0;
    for (size_t pair = 0; pair <= device->n_pairs; pair++) {
        bool is_open = pair < device->n_pairs && opening_between(device, pair, jaws, &gap);
        const double *a = is_x ? before.x : before.y, *b = is_x ? gap.x : gap.y;
        bool is_joined = was_open && is_open && a[0] < b[1] && b[0] < a[1];
        if (was_open && !is_joined)
            add_pairs(outline, device, jaws, first, pair - 1);
        if (!is_joined)
            first = pair;
        was_open = is_open;
        before = gap;
    }
}

/* ---- jaws and blocks --------------------------------------------------------------------------------------------- */
static void outline_jaws(struct beam_outline *outline, const struct opening_rectangle *jaws)
{
    size_t n = 0;
    outline->kind = BEAM_OUTLINE_JAWS;
    outline->n_polygons = 0;
    if (!(jaws->x[0] < jaws->x[1] && jaws->y[0] < jaws->y[1]))
        return;
    for (int i = 0; i < 4; i++)
        add_point(outline, &n, jaws->x[i == 1 || i == 2], jaws->y[i >= 2]);
    end_polygon(outline, n);
}

enum { CLIPPED_MAX = 5 * BEAM_OUTLINE_MAX_POINTS };

/* Keeps the part of a polygon on one side of a line along an axis (I. Sutherland, G. Hodgman, Reentrant polygon
 * clipping, CACM 17 (1974) 32). sign 1: values of at least limit. Returns the number of points. */
static size_t clip_side(double (*out)[2], double (*in)[2], size_t n, int axis, double sign, double limit)
{
    size_t n_out = 0;
    for (size_t i = 0; i < n; i++) {
        const double *a = in[i], *b = in[(i + 1) % n];
        double before = sign * (a[axis] - limit), after = sign * (b[axis] - limit);
        if (before >= 0 && n_out < CLIPPED_MAX)
            memcpy(out[n_out++], a, 2 * sizeof *a);
        if ((before < 0) == (after < 0) || before == 0 || after == 0 || n_out >= CLIPPED_MAX)
            continue;
        double share = before / (before - after);
        out[n_out][axis] = limit;
        out[n_out][1 - axis] = a[1 - axis] + share * (b[1 - axis] - a[1 - axis]);
        n_out++;
    }
    return n_out;
}

/* The blocks' outline inside the jaws. */
static void outline_blocks(struct beam_outline *outline, const struct beam_outline *blocks,
                           const struct opening_rectangle *jaws)
{
    double buffers[2][CLIPPED_MAX][2];
    outline->kind = BEAM_OUTLINE_BLOCKS;
    outline->n_polygons = 0;
    for (size_t polygon = 0; polygon < blocks->n_polygons; polygon++) {
        size_t from = beam_outline_begin(blocks, polygon), n = blocks->ends[polygon] - from,
               at = beam_outline_n_points(outline);
        for (size_t i = 0; i < n; i++)
            for (int axis = 0; axis < 2; axis++)
                buffers[0][i][axis] = (double)blocks->points_mm[from + i][axis];
        n = clip_side(buffers[1], buffers[0], n, 0, 1, jaws->x[0]);
        n = clip_side(buffers[0], buffers[1], n, 0, -1, jaws->x[1]);
        n = clip_side(buffers[1], buffers[0], n, 1, 1, jaws->y[0]);
        n = clip_side(buffers[0], buffers[1], n, 1, -1, jaws->y[1]);
        for (size_t i = 0; i < n; i++)
            add_point(outline, &at, buffers[0][i][0], buffers[0][i][1]);
        end_polygon(outline, at);
        if (at >= BEAM_OUTLINE_MAX_POINTS) { /* the jaws made too many corners: rather none than a part */
            outline->n_polygons = 0;
            return;
        }
    }
}

/* ---- which ------------------------------------------------------------------------------------------------------- */
static double area_mm2(const struct beam_outline *outline)
{
    double doubled = 0;
    for (size_t polygon = 0; polygon < outline->n_polygons; polygon++) {
        size_t from = beam_outline_begin(outline, polygon), n = outline->ends[polygon] - from;
        double of_this = 0;
        for (size_t i = 0; i < n; i++) {
            const float *a = outline->points_mm[from + i], *b = outline->points_mm[from + (i + 1) % n];
            of_this += (double)a[0] * (double)b[1] - (double)b[0] * (double)a[1];
        }
        doubled += fabs(of_this);
    }
    return doubled / 2;
}

/* Takes a candidate that leaves less open than the outline found so far. */
static void take_smaller(struct beam_outline *outline, double *least_mm2, const struct beam_outline *candidate)
{
    double mm2 = area_mm2(candidate);
    if (!(mm2 < *least_mm2))
        return;
    *least_mm2 = mm2;
    *outline = *candidate;
}

void opening_outline(const struct opening *opening, struct beam_outline *outline)
{
    bool has_x, has_y;
    struct opening_rectangle jaws = opening_jaws(opening, &has_x, &has_y);
    struct beam_outline candidate = { .n_polygons = 0 }; /* whole: plans are compared and kept as bytes */
    double least_mm2 = INFINITY;
    *outline = candidate;
    if (opening->has_lost_blocks)
        return;
    if (has_x && has_y) {
        outline_jaws(&candidate, &jaws);
        take_smaller(outline, &least_mm2, &candidate);
    }
    for (size_t d = 0; d < opening->n_devices; d++)
        if (opening_is_leaves(&opening->devices[d]) && opening->devices[d].is_placed) {
            outline_leaves(&candidate, &opening->devices[d], &jaws);
            take_smaller(outline, &least_mm2, &candidate);
        }
    if (opening->blocks.n_polygons > 0) {
        outline_blocks(&candidate, &opening->blocks, &jaws);
        take_smaller(outline, &least_mm2, &candidate);
    }
    if (outline->n_polygons == 0)
        outline->kind = BEAM_OUTLINE_NONE;
}
