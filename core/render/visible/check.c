/* The check of a segmentation on a slice pane: pixels enclosed by the surface against pixels in univels. */
#include "core/render/visible/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

static const uint8_t added_rgb[3] = { 0xff, 0xb0, 0x00 }, left_out_rgb[3] = { 0x10, 0x70, 0xff };

/* Where the surface's lines cross the middles of the picture's rows. */
struct crossings {
    double *x;                    /* in pixels, sorted within a row */
    size_t *starts;               /* [height + 1] row y has x[starts[y]] .. x[starts[y + 1] - 1] */
    double low_px[2], high_px[2]; /* box around all lines */
};

static struct vec3 to_pixels(const struct camera *camera, const struct image *image, const double p[3])
{
    struct vec3 clip = mat4_project(&camera->clip_from_lps_mm, vec3(p[0], p[1], p[2]));
    return vec3((clip.x + 1) / 2 * image->width_px, (1 - clip.y) / 2 * image->height_px, 0);
}

/* The rows whose middle lies between the ends of a line, the lower end included: so a corner of an outline belongs to
 * one of the two lines that meet there. False if there is none. */
static bool rows_of(const struct vec3 *a, const struct vec3 *b, int height, int *first, int *last)
{
    double low = fmin(a->y, b->y), high = fmax(a->y, b->y);
    *first = (int)fmin(fmax(ceil(low - 0.5 - CHECK_NUDGE), 0), height);
    *last = (int)fmin(fmax(ceil(high - 0.5 - CHECK_NUDGE) - 1, -1), height - 1);
    return *first <= *last;
}

static int compare(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

static void widen(struct crossings *box, const struct vec3 *p)
{
    box->low_px[0] = fmin(box->low_px[0], p->x);
    box->low_px[1] = fmin(box->low_px[1], p->y);
    box->high_px[0] = fmax(box->high_px[0], p->x);
    box->high_px[1] = fmax(box->high_px[1], p->y);
}

static bool find_crossings(const struct cut_lines *lines, const struct camera *camera, const struct image *image,
                           struct crossings *out, struct error *err)
{
    int height = image->height_px, first, last;
    struct vec3(*ends)[2] = mem_array(lines->n, sizeof *ends, UINT64_MAX, err);
    out->x = NULL;
    out->starts = ends ? mem_array((size_t)height + 2, sizeof *out->starts, UINT64_MAX, err) : NULL;
    if (!out->starts) {
        free(ends);
        return false;
    }
    memset(out->starts, 0, ((size_t)height + 2) * sizeof *out->starts);
    for (size_t i = 0; i < lines->n; i++) {
        for (int end = 0; end < 2; end++) {
            ends[i][end] = to_pixels(camera, image, lines->ends_lps_mm[i][end]);
            widen(out, &ends[i][end]);
        }
        if (rows_of(&ends[i][0], &ends[i][1], height, &first, &last))
            for (int y = first; y <= last; y++)
                out->starts[y + 2]++;
    }
    for (int y = 0; y < height; y++)
        out->starts[y + 2] += out->starts[y + 1];
    out->x = mem_array(out->starts[height + 1], sizeof *out->x, UINT64_MAX, err);
    for (size_t i = 0; out->x && i < lines->n; i++) {
        const struct vec3 *a = &ends[i][0], *b = &ends[i][1];
        if (rows_of(a, b, height, &first, &last))
            for (int y = first; y <= last;
                 y++) /* starts[y + 1] is the row's fill position; once the row is full it is the start of row y + 1 */
                out->x[out->starts[y + 1]++] = a->x + (y + 0.5 + CHECK_NUDGE - a->y) / (b->y - a->y) * (b->x - a->x);
    }
    for (int y = 0; out->x && y < height; y++)
        qsort(out->x + out->starts[y], out->starts[y + 1] - out->starts[y], sizeof *out->x, compare);
    free(ends);
    if (!out->x)
        free(out->starts);
    return out->x != NULL;
}

static void mark(struct image *image, int x, int y, bool is_added, int period)
{
    uint8_t *pixel = &image->rgba[4 * ((size_t)y * (size_t)image->width_px + (size_t)x)];
    const uint8_t *rgb = is_added ? added_rgb : left_out_rgb;
    int along = is_added ? x + y : x - y + 64 * IMAGE_MAX_SIDE_PX;
    int weight = along % period < (period + 2) / 3 ? 240 : 110; /* of 256 */
    for (int c = 0; c < 3; c++)
        pixel[c] = (uint8_t)((rgb[c] * weight + pixel[c] * (256 - weight)) >> 8);
}

bool check_paint(const struct cut_region *univels, const struct cut_lines *surface, const struct camera *camera,
                 const struct plane *plane, struct image *image, double scale, struct check_counts *check,
                 struct error *err)
{
    struct crossings crossings = { .low_px = { INFINITY, INFINITY }, .high_px = { -INFINITY, -INFINITY } };
    if (!find_crossings(surface, camera, image, &crossings, err))
        return false;
    const double *m = camera->lps_mm_from_clip.m; /* linear, as a pane's projection is parallel */
    struct vec3 across = vec3_scale(vec3(m[0], m[1], m[2]), 2.0 / image->width_px),
                down = vec3_scale(vec3(m[4], m[5], m[6]), -2.0 / image->height_px);
    struct vec3 middle = plane_nearest(plane, camera->target_lps_mm);
    for (int corner = 0; corner < 8; corner++) { /* pixels outside both boxes cannot differ */
        const struct box3 *box = &univels->bounds_lps_mm;
        const double p[3] = { corner & 1 ? box->high.x : box->low.x, corner & 2 ? box->high.y : box->low.y,
                              corner & 4 ? box->high.z : box->low.z };
        struct vec3 pixel = to_pixels(camera, image, p);
        widen(&crossings, &pixel);
    }
    int low_x = (int)fmax(0, fmin(crossings.low_px[0] - 1, image->width_px)),
        high_x = (int)fmin(image->width_px - 1, fmax(crossings.high_px[0] + 1, -1));
    int low_y = (int)fmax(0, fmin(crossings.low_px[1] - 1, image->height_px)),
        high_y = (int)fmin(image->height_px - 1, fmax(crossings.high_px[1] + 1, -1));
    int period = (int)fmax(4, round(7 * scale));
    for (int y = low_y; y <= high_y; y++) {
        const double *x_crossed = crossings.x + crossings.starts[y];
        size_t n = crossings.starts[y + 1] - crossings.starts[y], passed = 0;
        for (int x = low_x; n % 2 == 0 && x <= high_x; x++) {
            double at = x + 0.5 + CHECK_NUDGE;
            while (passed < n && x_crossed[passed] <= at)
                passed++;
            struct vec3 p =
                vec3_add(middle, vec3_add(vec3_scale(across, at - image->width_px / 2.0),
                                          vec3_scale(down, y + 0.5 + CHECK_NUDGE - image->height_px / 2.0)));
            bool is_enclosed = passed % 2 == 1, is_univel = cut_region_holds(univels, p);
            if (is_enclosed == is_univel)
                continue;
            mark(image, x, y, is_enclosed, period);
            check->n_added += is_enclosed;
            check->n_left_out += is_univel;
        }
    }
    free(crossings.x);
    free(crossings.starts);
    return true;
}
