/* Anti-aliased lines over a picture: coverage is collected stroke by stroke, then blended once. */
#include "core/render/visible/paint.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* Longer lines are painted in pieces of this length: the box around a slanted piece holds few pixels beside it. */
#define PIECE_PX 24.0

struct paint {
    struct image *image;
    uint8_t *cover;                   /* [height][width] coverage of each pixel, 0..255 */
    int low_x, high_x, low_y, high_y; /* box of the pixels covered so far, inclusive */
};

static void reset(struct paint *paint)
{
    paint->low_x = paint->low_y = INT32_MAX;
    paint->high_x = paint->high_y = -1;
}

struct paint *paint_create(struct image *image, struct error *err)
{
    struct paint *paint = mem_new(sizeof *paint);
    paint->image = image;
    paint->cover = mem_array((size_t)image->width_px * (size_t)image->height_px, 1, UINT64_MAX, err);
    if (!paint->cover) {
        free(paint);
        return NULL;
    }
    memset(paint->cover, 0, (size_t)image->width_px * (size_t)image->height_px);
    reset(paint);
    return paint;
}

void paint_destroy(struct paint *paint)
{
    if (!paint)
        return;
    free(paint->cover);
    free(paint);
}

/* Comparisons, as fmin and fmax are calls. */
static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static inline double clamp(double value, double low, double high)
{
    return smaller(larger(value, low), high);
}

static void widen(struct paint *paint, int low_x, int high_x, int low_y, int high_y)
{
    paint->low_x = low_x < paint->low_x ? low_x : paint->low_x;
    paint->low_y = low_y < paint->low_y ? low_y : paint->low_y;
    paint->high_x = high_x > paint->high_x ? high_x : paint->high_x;
    paint->high_y = high_y > paint->high_y ? high_y : paint->high_y;
}

/* Coverage falls linearly from 1, half a pixel inside the line's edge, to 0, half a pixel outside. */
static void paint_piece(struct paint *paint, struct paint_point a, struct paint_point b, double radius)
{
    const int width = paint->image->width_px, height = paint->image->height_px;
    double reach = radius + 0.5;
    /* the pixels whose centres are within reach along each axis */
    int low_x = (int)clamp(ceil(smaller(a.x, b.x) - reach - 0.5), 0, width),
        high_x = (int)clamp(floor(larger(a.x, b.x) + reach - 0.5), -1, width - 1);
    int low_y = (int)clamp(ceil(smaller(a.y, b.y) - reach - 0.5), 0, height),
        high_y = (int)clamp(floor(larger(a.y, b.y) + reach - 0.5), -1, height - 1);
    if (low_x > high_x || low_y > high_y)
        return;
    widen(paint, low_x, high_x, low_y, high_y);
    double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy, inverse = square > 0 ? 1 / square : 0;
    double most = smaller(1, 2 * radius);
    for (int y = low_y; y <= high_y; y++) {
        uint8_t *row = paint->cover + (size_t)y * (size_t)width;
        for (int x = low_x; x <= high_x; x++) {
            double px = x + 0.5 - a.x, py = y + 0.5 - a.y, t = clamp((px * dx + py * dy) * inverse, 0, 1);
            double off_x = px - t * dx, off_y = py - t * dy, far = off_x * off_x + off_y * off_y;
            if (far >= reach * reach)
                continue;
            double covered = clamp(reach - sqrt(far), 0, most);
            uint8_t level = (uint8_t)(covered * 255 + 0.5);
            row[x] = level > row[x] ? level : row[x];
        }
    }
}

/* Narrows t0..t1 to where a + t (b - a) lies in low..high; false: nowhere. */
static bool narrow(double a, double b, double low, double high, double *t0, double *t1)
{
    double d = b - a;
    if (d == 0)
        return a >= low && a <= high;
    double ta = (low - a) / d, tb = (high - a) / d;
    *t0 = fmax(*t0, fmin(ta, tb));
    *t1 = fmin(*t1, fmax(ta, tb));
    return *t0 <= *t1;
}

void paint_line(struct paint *paint, struct paint_point a, struct paint_point b, double width_px)
{
    double radius = width_px / 2, reach = radius + 1, t0 = 0, t1 = 1;
    if (!isfinite(a.x) || !isfinite(a.y) || !isfinite(b.x) || !isfinite(b.y) ||
        !narrow(a.x, b.x, -reach, paint->image->width_px + reach, &t0, &t1) ||
        !narrow(a.y, b.y, -reach, paint->image->height_px + reach, &t0, &t1))
        return;
    struct paint_point from = { a.x + t0 * (b.x - a.x), a.y + t0 * (b.y - a.y) },
                       to = { a.x + t1 * (b.x - a.x), a.y + t1 * (b.y - a.y) };
    int n = (int)ceil(hypot(to.x - from.x, to.y - from.y) / PIECE_PX);
    n = n < 1 ? 1 : n;
    for (int i = 0; i < n; i++) {
        double s0 = (double)i / n, s1 = (i + 1.0) / n;
        paint_piece(paint, (struct paint_point){ from.x + s0 * (to.x - from.x), from.y + s0 * (to.y - from.y) },
                    (struct paint_point){ from.x + s1 * (to.x - from.x), from.y + s1 * (to.y - from.y) }, radius);
    }
}

static inline bool is_clear(const uint8_t cover[8])
{
    uint64_t all;
    memcpy(&all, cover, sizeof all);
    return all == 0;
}

/* ---- strokes that are kept ---------------------------------------------------------------------------------------- */

/* Neighbouring pixels of a row that are covered. */
struct span {
    uint32_t at; /* the first one, counted through the picture */
    uint32_t n;
};

struct paint_strokes {
    struct span *spans;
    uint8_t *levels; /* of the spans' pixels, one after the other */
    size_t n_spans, n_levels;
    size_t n_pixels; /* of the picture */
    int low_x, high_x, low_y, high_y;
};

/* The next covered pixel of a row's part, or its end. */
static int skip_clear(const uint8_t *row, int x, int end)
{
    while (x + 8 <= end && is_clear(row + x))
        x += 8;
    while (x < end && row[x] == 0)
        x++;
    return x;
}

static int skip_covered(const uint8_t *row, int x, int end)
{
    while (x < end && row[x] != 0)
        x++;
    return x;
}

/* Counts the spans and their pixels; with room for them fills them in and clears the coverage. */
static void find_spans(struct paint *paint, struct paint_strokes *strokes, bool has_room)
{
    strokes->n_spans = strokes->n_levels = 0;
    for (int y = paint->low_y; y <= paint->high_y; y++) {
        const int end = paint->high_x + 1;
        size_t first = (size_t)y * (size_t)paint->image->width_px;
        uint8_t *row = paint->cover + first;
        for (int x = skip_clear(row, paint->low_x, end); x < end; x = skip_clear(row, x, end)) {
            int to = skip_covered(row, x, end);
            size_t n = (size_t)(to - x);
            if (has_room) {
                strokes->spans[strokes->n_spans] = (struct span){ (uint32_t)(first + (size_t)x), (uint32_t)n };
                memcpy(strokes->levels + strokes->n_levels, row + x, n);
                memset(row + x, 0, n);
            }
            strokes->n_spans++;
            strokes->n_levels += n;
            x = to;
        }
    }
}

struct paint_strokes *paint_take(struct paint *paint, struct error *err)
{
    struct paint_strokes *strokes = mem_new(sizeof *strokes);
    strokes->n_pixels = (size_t)paint->image->width_px * (size_t)paint->image->height_px;
    strokes->low_x = paint->low_x;
    strokes->high_x = paint->high_x;
    strokes->low_y = paint->low_y;
    strokes->high_y = paint->high_y;
    find_spans(paint, strokes, false);
    strokes->spans = mem_array(strokes->n_spans, sizeof *strokes->spans, UINT64_MAX, err);
    strokes->levels = strokes->spans ? mem_array(strokes->n_levels, 1, UINT64_MAX, err) : NULL;
    if (!strokes->levels) {
        paint_strokes_destroy(strokes);
        return NULL;
    }
    find_spans(paint, strokes, true);
    reset(paint);
    return strokes;
}

void paint_queue(struct paint *paint, const struct paint_strokes *strokes)
{
    assert(strokes->n_pixels == (size_t)paint->image->width_px * (size_t)paint->image->height_px);
    widen(paint, strokes->low_x, strokes->high_x, strokes->low_y, strokes->high_y);
    const uint8_t *level = strokes->levels;
    for (size_t i = 0; i < strokes->n_spans; i++) {
        uint8_t *cover = paint->cover + strokes->spans[i].at;
        size_t n = strokes->spans[i].n;
        for (size_t k = 0; k < n; k++)
            cover[k] = level[k] > cover[k] ? level[k] : cover[k];
        level += n;
    }
}

size_t paint_strokes_bytes(const struct paint_strokes *strokes)
{
    return strokes ? sizeof *strokes + strokes->n_spans * sizeof *strokes->spans + strokes->n_levels : 0;
}

void paint_strokes_destroy(struct paint_strokes *strokes)
{
    if (!strokes)
        return;
    free(strokes->spans);
    free(strokes->levels);
    free(strokes);
}

void paint_flush(struct paint *paint, uint32_t rgb, double opacity)
{
    const int color[3] = { (int)(rgb >> 16 & 255), (int)(rgb >> 8 & 255), (int)(rgb & 255) };
    const int weight = (int)(opacity * 256 + 0.5);
    size_t width = (size_t)paint->image->width_px;
    for (int y = paint->low_y; y <= paint->high_y; y++)
        for (int x = paint->low_x; x <= paint->high_x; x++) {
            const uint8_t *row = &paint->cover[(size_t)y * width];
            while (x + 8 <= paint->high_x && is_clear(row + x)) /* most pixels of the box */
                x += 8;
            uint8_t *cover = &paint->cover[(size_t)y * width + (size_t)x],
                    *pixel = &paint->image->rgba[4 * ((size_t)y * width + (size_t)x)];
            int alpha = *cover * weight >> 8;
            for (int c = 0; alpha && c < 3; c++)
                pixel[c] = (uint8_t)((color[c] * alpha + pixel[c] * (255 - alpha) + 127) / 255);
            *cover = 0;
        }
    reset(paint);
}
