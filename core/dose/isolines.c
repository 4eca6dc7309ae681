/* Isolines by marching squares: segments cell by cell, row after row, then joined at their common points. */
#include "core/dose/isolines.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

static const uint32_t no_point = UINT32_MAX;

/* A point on an edge of the lattice, and the points that segments join it with: two at most, as an edge has a cell on
 * each side. */
struct crossing {
    double at[2];
    uint32_t next[2];
};

struct tracing {
    const struct isoline_samples *samples;
    double level;
    struct crossing *crossings;
    uint32_t n, capacity;
    uint32_t *on_row[2]; /* [width] crossings of the edges along u, in the rows below and above the cells */
    uint32_t *on_column; /* [width] crossings of the edges along v between these rows */
    uint8_t *above[2];   /* [width + 8] 1: the sample is above the level; of the same rows; padded with zeros */
    uint8_t *codes;      /* [width + 8] bits of the cell's corners that are above */
};

void isolines_finish(struct isolines *lines)
{
    free(lines->points);
    free(lines->ends);
    *lines = (struct isolines){ 0 };
}

/* ---- cells ------------------------------------------------------------------------------------------------------ */

/* The crossing on the edge between samples a < b at (u, v) and one further along the axis. */
static bool add_crossing(struct tracing *tracing, size_t a, size_t b, uint32_t u, uint32_t v, int axis, uint32_t *index,
                         struct error *err)
{
    const struct isoline_samples *samples = tracing->samples;
    if (*index != no_point)
        return true;
    if (tracing->n == tracing->capacity) {
        uint32_t capacity = 2 * tracing->capacity + 1024;
        struct crossing *grown = realloc(tracing->crossings, capacity * sizeof *grown);
        if (!grown)
            return error_set(err, ERROR_MEMORY, "no memory for %u points of isodose lines", (unsigned)capacity);
        tracing->crossings = grown;
        tracing->capacity = capacity;
    }
    double from = samples->values[a], to = samples->values[b];
    double share = samples->kinds && samples->kinds[a] != samples->kinds[b]
                       ? samples->jump(samples->context, a, b, tracing->level)
                       : (tracing->level - from) / (to - from);
    struct crossing *crossing = &tracing->crossings[tracing->n];
    *crossing = (struct crossing){ { u, v }, { no_point, no_point } };
    crossing->at[axis] += share;
    *index = tracing->n++;
    return true;
}

static void join(struct tracing *tracing, uint32_t a, uint32_t b)
{
    struct crossing *p = &tracing->crossings[a], *q = &tracing->crossings[b];
    p->next[p->next[0] != no_point] = b;
    q->next[q->next[0] != no_point] = a;
}

/* Edges of a cell: 0 bottom, 1 right, 2 top, 3 left. Corner bits: 1 (u, v), 2 (u + 1, v), 4 (u + 1, v + 1), 8 (u, v +
 * 1). Segments by code; of the crosswise codes 5 and 10 those that join the corners above. */
static const int8_t segments_of[16][4] = {
    { -1, -1, -1, -1 }, { 3, 0, -1, -1 }, { 0, 1, -1, -1 }, { 3, 1, -1, -1 },   { 1, 2, -1, -1 }, { 0, 1, 2, 3 },
    { 0, 2, -1, -1 },   { 3, 2, -1, -1 }, { 2, 3, -1, -1 }, { 0, 2, -1, -1 },   { 3, 0, 1, 2 },   { 1, 2, -1, -1 },
    { 1, 3, -1, -1 },   { 0, 1, -1, -1 }, { 0, 3, -1, -1 }, { -1, -1, -1, -1 },
};

static bool trace_cell(struct tracing *tracing, uint32_t u, uint32_t v, int code, struct error *err)
{
    const struct isoline_samples *samples = tracing->samples;
    size_t width = samples->size[0], corner[4];
    corner[0] = u + width * v;
    corner[1] = corner[0] + 1;
    corner[2] = corner[1] + width;
    corner[3] = corner[0] + width;
    double value[4], sum = 0;
    for (int i = 0; i < 4; i++)
        sum += value[i] = samples->values[corner[i]];
    if (isnan(sum))
        return true;
    const int8_t *segments = segments_of[code];
    if (code == 5 || code == 10) {
        double saddle = (value[0] * value[2] - value[1] * value[3]) / (value[0] + value[2] - value[1] - value[3]);
        if (!(saddle >= tracing->level))
            segments = segments_of[15 - code];
    }
    uint32_t *const points[4] = { &tracing->on_row[0][u], &tracing->on_column[u + 1], &tracing->on_row[1][u],
                                  &tracing->on_column[u] };
    for (int i = 0; i < 4 && segments[i] >= 0; i++)
        switch (segments[i]) {
        case 0:
            if (!add_crossing(tracing, corner[0], corner[1], u, v, 0, points[0], err))
                return false;
            break;
        case 1:
            if (!add_crossing(tracing, corner[1], corner[2], u + 1, v, 1, points[1], err))
                return false;
            break;
        case 2:
            if (!add_crossing(tracing, corner[3], corner[2], u, v + 1, 0, points[2], err))
                return false;
            break;
        default:
            if (!add_crossing(tracing, corner[0], corner[3], u, v, 1, points[3], err))
                return false;
        }
    join(tracing, *points[segments[0]], *points[segments[1]]);
    if (segments[2] >= 0)
        join(tracing, *points[segments[2]], *points[segments[3]]);
    return true;
}

/* Finds which samples of a row are above the level. */
static void compare_row(const struct tracing *tracing, uint32_t v, uint8_t *above)
{
    const float *values = tracing->samples->values + (size_t)tracing->samples->size[0] * v;
    for (uint32_t u = 0; u < tracing->samples->size[0]; u++)
        above[u] = values[u] >= tracing->level;
}

/* True if none of 8 cells has a line. */
static inline bool are_plain(const uint8_t codes[8])
{
    uint64_t all;
    memcpy(&all, codes, sizeof all);
    return all == 0 || all == 0x0f0f0f0f0f0f0f0fu;
}

static bool trace_row(struct tracing *tracing, uint32_t v, struct error *err)
{
    uint32_t n = tracing->samples->size[0] - 1;
    const uint8_t *below = tracing->above[0], *above = tracing->above[1];
    uint8_t *codes = tracing->codes;
    for (uint32_t u = 0; u < n; u++)
        codes[u] = (uint8_t)(below[u] | below[u + 1] << 1 | above[u + 1] << 2 | above[u] << 3);
    for (uint32_t u = 0; u < n; u++) {
        while (u + 8 <= n && are_plain(codes + u))
            u += 8;
        if (u < n && codes[u] != 0 && codes[u] != 15 && !trace_cell(tracing, u, v, codes[u], err))
            return false;
    }
    return true;
}

static bool trace_cells(struct tracing *tracing, struct error *err)
{
    size_t width = tracing->samples->size[0], n_bytes = width * sizeof(uint32_t);
    memset(tracing->on_row[1], 0xff, n_bytes);
    compare_row(tracing, 0, tracing->above[1]);
    for (uint32_t v = 0; v + 1 < tracing->samples->size[1]; v++) {
        uint32_t *row = tracing->on_row[0];
        uint8_t *above = tracing->above[0];
        tracing->on_row[0] = tracing->on_row[1];
        tracing->on_row[1] = row;
        tracing->above[0] = tracing->above[1];
        tracing->above[1] = above;
        memset(row, 0xff, n_bytes);
        memset(tracing->on_column, 0xff, n_bytes);
        compare_row(tracing, v + 1, above);
        if (!trace_row(tracing, v, err))
            return false;
    }
    return true;
}

/* ---- polylines -------------------------------------------------------------------------------------------------- */

/* Appends the line that begins at a crossing, and marks its crossings as used up: next[0] is no_point. */
static void follow(struct tracing *tracing, uint32_t first, struct isolines *lines)
{
    uint32_t at = first, before = no_point;
    while (at != no_point) {
        struct crossing *crossing = &tracing->crossings[at];
        uint32_t next = crossing->next[0] != before ? crossing->next[0] : crossing->next[1];
        memcpy(lines->points[lines->n_points++], crossing->at, sizeof crossing->at);
        bool is_back = at == first && before != no_point;
        crossing->next[0] = crossing->next[1] = no_point;
        if (is_back)
            break;
        before = at;
        at = next;
    }
    lines->ends[lines->n_lines++] = lines->n_points;
}

static bool join_crossings(struct tracing *tracing, struct isolines *lines, struct error *err)
{
    size_t n = tracing->n;
    /* a line has at least two crossings; a closed one has its first point twice */
    if (lines->points_capacity < n + n / 2 + 1 || lines->lines_capacity < n / 2 + 1) {
        isolines_finish(lines);
        lines->points_capacity = n + n / 2 + 1;
        lines->lines_capacity = n / 2 + 1;
        lines->points = mem_array(lines->points_capacity, sizeof *lines->points, UINT64_MAX, err);
        lines->ends = lines->points ? mem_array(lines->lines_capacity, sizeof *lines->ends, UINT64_MAX, err) : NULL;
        if (!lines->ends)
            return false;
    }
    lines->n_points = lines->n_lines = 0;
    for (uint32_t i = 0; i < tracing->n; i++) /* the ends of open lines, then the rest */
        if (tracing->crossings[i].next[0] != no_point && tracing->crossings[i].next[1] == no_point)
            follow(tracing, i, lines);
    for (uint32_t i = 0; i < tracing->n; i++)
        if (tracing->crossings[i].next[0] != no_point)
            follow(tracing, i, lines);
    return true;
}

bool isolines_trace(const struct isoline_samples *samples, double level, struct isolines *lines, struct error *err)
{
    size_t width = samples->size[0];
    struct tracing tracing = { .samples = samples, .level = level };
    assert(width >= 1 && width <= ISOLINES_MAX_SIDE && samples->size[1] >= 1 && samples->size[1] <= ISOLINES_MAX_SIDE);
    uint32_t *points = mem_array(3 * width, sizeof *points, UINT64_MAX, err);
    uint8_t *bytes = points ? mem_array(3 * (width + 8), 1, UINT64_MAX, err) : NULL;
    bool is_good = bytes != NULL;
    if (is_good) {
        tracing.on_row[0] = points;
        tracing.on_row[1] = points + width;
        tracing.on_column = points + 2 * width;
        tracing.above[0] = bytes;
        tracing.above[1] = bytes + width + 8;
        tracing.codes = bytes + 2 * (width + 8);
        is_good = trace_cells(&tracing, err) && join_crossings(&tracing, lines, err);
    }
    free(bytes);
    free(points);
    free(tracing.crossings);
    return is_good;
}
