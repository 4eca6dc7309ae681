/* Anti-aliased lines over a picture: coverage is collected stroke by stroke, then blended once. */
#include "core/render/visible/paint.h"

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
    paint->low_x = low_x < paint->low_x ? low_x : paint->low_x;
    paint->low_y = low_y < paint->low_y ? low_y : paint->low_y;
    paint->high_x = high_x > paint->high_x ? high_x : paint->high_x;
    paint->high_y = high_y > paint->high_y ? high_y : paint->high_y;
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
