/* Draws caps: outlines projected and sorted into bands; inside by the even-odd rule; rows sampled. */
#include "core/render/soft/caps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/soft/volume.h"

/* ---- outlines in the picture ------------------------------------------------------------------------------------ */

/* Outlines that the near plane opens are closed along it: every point where one meets it is joined to the first. */
struct projector {
    const struct soft_lighting *rows;
    const struct clip_set *clip;
    double height; /* of the picture, in sub-samples */
    struct soft_corner first_cut;
    bool has_cut;
};

static bool add_edge(struct soft_cap_region *region, double x0, double y0, double x1, double y1)
{
    if (!(y0 < y1 || y1 < y0))
        return true;
    if (!soft_reserve(&region->edges, &region->capacity, region->n_edges + 1, sizeof *region->edges))
        return false;
    const struct soft_cap_edge down = { llround(x0), llround(x1), (int32_t)lround(y0), (int32_t)lround(y1) };
    region->edges[region->n_edges++] =
        down.y0 < down.y1 ? down : (struct soft_cap_edge){ down.x1, down.x0, down.y1, down.y0 };
    region->n_edges -= down.y0 == down.y1;
    return true;
}

/* Shortens an edge to the rows of the picture, so that its numbers stay small; sideways parts are needed. */
static bool add_projected(struct soft_cap_region *region, const struct projector *to, const struct soft_corner *a,
                          const struct soft_corner *b)
{
    const double far = (double)SOFT_GUARD, widest = 0x1p40, low = -(double)SOFT_SUB, high = to->height + SOFT_SUB;
    double x[2] = { a->x / a->w, b->x / b->w }, y[2] = { a->y / a->w, b->y / b->w };
    if ((y[0] < low && y[1] < low) || (y[0] > high && y[1] > high))
        return true;
    for (int i = 0; i < 2; i++)
        if (fabs(y[i]) > far) {
            double row = y[i] < 0 ? low : high, t = (row - y[i]) / (y[1 - i] - y[i]);
            x[i] += t * (x[1 - i] - x[i]);
            y[i] = row;
        }
    for (int i = 0; i < 2; i++)
        x[i] = fmin(fmax(x[i], -widest), widest);
    return add_edge(region, x[0], y[0], x[1], y[1]);
}

static struct soft_corner meet_near(const struct soft_corner *ahead, const struct soft_corner *before)
{
    double fa = ahead->z + ahead->w, fb = before->z + before->w, t = fa / (fa - fb);
    return (struct soft_corner){ ahead->x + t * (before->x - ahead->x),
                                 ahead->y + t * (before->y - ahead->y),
                                 ahead->z + t * (before->z - ahead->z),
                                 ahead->w + t * (before->w - ahead->w),
                                 { 0 },
                                 NULL };
}

static bool add_ahead(struct soft_cap_region *region, struct projector *to, struct vec3 p, struct vec3 q)
{
    struct soft_corner a, b;
    soft_project(to->rows, p.x, p.y, p.z, &a);
    soft_project(to->rows, q.x, q.y, q.z, &b);
    bool is_a_ahead = a.z + a.w >= 0 && a.w > 0, is_b_ahead = b.z + b.w >= 0 && b.w > 0;
    if (is_a_ahead && is_b_ahead)
        return add_projected(region, to, &a, &b);
    if (!is_a_ahead && !is_b_ahead)
        return true;
    struct soft_corner near = is_a_ahead ? meet_near(&a, &b) : meet_near(&b, &a);
    if (!to->has_cut)
        to->first_cut = near;
    to->has_cut = true;
    return add_projected(region, to, is_a_ahead ? &a : &b, &near) && add_projected(region, to, &near, &to->first_cut);
}

/* Other clip planes cut the triangles along an outline, whose corners there are rounded: the outline gets them too. */
static bool add_segment(struct soft_cap_region *region, struct projector *to, double ends[2][3])
{
    struct vec3 points[2 + SOFT_MAX_CUTS] = { { ends[0][0], ends[0][1], ends[0][2] },
                                              { ends[1][0], ends[1][1], ends[1][2] } };
    int n = 2;
    for (size_t i = 0; i < to->clip->n_planes; i++) {
        const struct plane *plane = &to->clip->planes[i].plane;
        for (int at = 0; clip_set_has(to->clip, i) && at + 1 < n; at++) {
            double a = plane_height_mm(plane, points[at]), b = plane_height_mm(plane, points[at + 1]);
            if ((a >= 0) == (b >= 0))
                continue;
            struct vec3 between = a < b ? cut_between(points[at], points[at + 1], cut_share(a, b, 0))
                                        : cut_between(points[at + 1], points[at], cut_share(b, a, 0));
            memmove(points + at + 2, points + at + 1, (size_t)(n - at - 1) * sizeof *points);
            points[at + 1] = between;
            n++;
            break; /* a plane meets a line once */
        }
    }
    for (int i = 0; i + 1 < n; i++)
        if (!add_ahead(region, to, points[i], points[i + 1]))
            return false;
    return true;
}

/* The first row of samples whose middle is at or below y. */
static int first_row(int32_t y)
{
    return (y + SOFT_SUB / 2 - 1) >> SOFT_SUB_BITS;
}

static void bands_of(const struct soft_cap_edge *edge, int n_bands, int *first, int *last)
{
    int top = first_row(edge->y0), bottom = first_row(edge->y1) - 1;
    *first = top > 0 ? top / SOFT_BAND_ROWS : 0;
    *last = top > bottom ? -1 : bottom / SOFT_BAND_ROWS;
    *last = bottom < 0 ? -1 : *last < n_bands ? *last : n_bands - 1;
}

static bool sort_edges(struct soft_cap_region *region, int n_bands, struct error *err)
{
    int first, last;
    uint64_t n_refs = 0;
    region->starts = mem_array((size_t)n_bands + 1, sizeof *region->starts, UINT64_MAX, err);
    if (!region->starts)
        return false;
    for (size_t i = 0; i < region->n_edges; i++) {
        bands_of(&region->edges[i], n_bands, &first, &last);
        for (int band = first; band <= last; band++)
            region->starts[band]++;
    }
    for (int band = 0; band < n_bands; band++) {
        n_refs += region->starts[band];
        region->starts[band] = (uint32_t)n_refs;
    }
    region->starts[n_bands] = (uint32_t)n_refs;
    region->refs = mem_array((size_t)n_refs, sizeof *region->refs, (uint64_t)UINT32_MAX * sizeof *region->refs, err);
    if (!region->refs)
        return false;
    for (size_t i = region->n_edges; i-- > 0;) {
        bands_of(&region->edges[i], n_bands, &first, &last);
        for (int band = first; band <= last; band++)
            region->refs[--region->starts[band]] = (uint32_t)i;
    }
    return true;
}

bool soft_cap_init(struct soft_cap *cap, const struct draw *draw, const struct soft_lighting *projection, int height,
                   int n_bands, struct error *err)
{
    cap->draw = draw;
    cap->regions = mem_array(draw->cap.n_regions, sizeof *cap->regions, UINT64_MAX, err);
    if (!cap->regions)
        return false;
    for (size_t r = 0; r < draw->cap.n_regions; r++) {
        struct projector to = { .rows = projection, .clip = &draw->clip, .height = (double)height * SOFT_SUB };
        const struct cut_lines *lines = draw->cap.regions[r].lines;
        for (size_t i = 0; i < lines->n; i++)
            if (!add_segment(&cap->regions[r], &to, lines->ends_lps_mm[i]))
                return error_set(err, ERROR_MEMORY, "no memory for %zu lines of a cap", lines->n);
        if (!sort_edges(&cap->regions[r], n_bands, err))
            return false;
    }
    return true;
}

void soft_cap_finish(struct soft_cap *cap)
{
    for (size_t r = 0; cap->regions && r < cap->draw->cap.n_regions; r++) {
        free(cap->regions[r].edges);
        free(cap->regions[r].refs);
        free(cap->regions[r].starts);
    }
    free(cap->regions);
    cap->regions = NULL;
}

bool soft_cap_scratch_resize(struct soft_cap_scratch *scratch, int width, struct error *err)
{
    size_t n_words = (size_t)(width + 63) / 64, n = SOFT_BAND_ROWS * n_words;
    if (scratch->n_words >= n_words && scratch->tints)
        return true;
    soft_cap_scratch_finish(scratch);
    scratch->n_words = n_words;
    scratch->inside = mem_array(n, sizeof *scratch->inside, UINT64_MAX, err);
    scratch->all = scratch->inside ? mem_array(n, sizeof *scratch->all, UINT64_MAX, err) : NULL;
    scratch->tints = scratch->all ? mem_array(64 * n, sizeof *scratch->tints, UINT64_MAX, err) : NULL;
    return scratch->tints != NULL;
}

void soft_cap_scratch_finish(struct soft_cap_scratch *scratch)
{
    free(scratch->inside);
    free(scratch->all);
    free(scratch->tints);
    *scratch = (struct soft_cap_scratch){ 0 };
}

/* ---- inside ----------------------------------------------------------------------------------------------------- */

static int64_t divide_down(int64_t a, int64_t b)
{
    return a / b - (a % b < 0);
}

/* Toggles a bit in each row of the band that the edge crosses: that of the first sample whose middle is at or right of
 * the edge. A triangle owns its left and upper edges in the same way. odd: counts the edges of each row. */
static void cross_rows(const struct soft_cap_edge *edge, const struct soft_band *band, uint64_t *inside, size_t n_words,
                       uint8_t *odd)
{
    int first = first_row(edge->y0), last = first_row(edge->y1) - 1;
    first = first > band->first_row ? first : band->first_row;
    last = last < band->first_row + band->n_rows - 1 ? last : band->first_row + band->n_rows - 1;
    if (first > last)
        return;
    const int64_t height = (int64_t)edge->y1 - edge->y0, width = edge->x1 - edge->x0, whole = height * SOFT_SUB;
    const int64_t from_top = (int64_t)first * SOFT_SUB + SOFT_SUB / 2 - edge->y0;
    const int64_t at = (edge->x0 - SOFT_SUB / 2) * height + from_top * width + whole - 1;
    const int64_t step = divide_down(width * SOFT_SUB, whole), step_rest = width * SOFT_SUB - step * whole;
    int64_t sample = divide_down(at, whole), rest = at - sample * whole;
    for (int y = first; y <= last; y++) {
        int64_t bit = sample > 0 ? sample : 0;
        odd[y - band->first_row] ^= 1;
        if (bit < band->width)
            inside[(size_t)(y - band->first_row) * n_words + (size_t)bit / 64] ^= (uint64_t)1 << bit % 64;
        sample += step;
        rest += step_rest;
        if (rest >= whole) {
            rest -= whole;
            sample++;
        }
    }
}

/* Replaces a row's toggles by bits of the pixels inside: their running xor. */
static void fill_row(uint64_t *words, size_t n_words)
{
    uint64_t carry = 0;
    for (size_t i = 0; i < n_words; i++) {
        uint64_t w = words[i];
        for (int shift = 1; shift < 64; shift *= 2)
            w ^= w << shift;
        words[i] = w ^ carry;
        carry = words[i] >> 63 ? UINT64_MAX : 0;
    }
}

/* The first place from `at` on, before end, where the bit is set or not set; end: there is none. */
static int next_bit(const uint64_t *words, int at, int end, bool is_set)
{
    for (; at < end; at = (at / 64 + 1) * 64) {
        uint64_t word = (is_set ? words[at / 64] : ~words[at / 64]) >> at % 64;
        if (word) {
            at += __builtin_ctzll(word);
            break;
        }
    }
    return at < end ? at : end;
}

/* The next run of set bits from *first on, before end. False: there is none. */
static bool next_run(const uint64_t *words, int *first, int *last, int end)
{
    *first = next_bit(words, *first, end, true);
    *last = next_bit(words, *first, end, false) - 1;
    return *first < end;
}

static void paint_row(const uint64_t *words, int width, uint32_t color, uint32_t *tints)
{
    for (int first = 0, last; next_run(words, &first, &last, width); first = last + 1)
        for (int x = first; x <= last; x++)
            tints[x] = color;
}

static uint32_t color_of(uint32_t rgb)
{
    return rgb >> 16 | (rgb & 0xff00) | (rgb & 255) << 16 | 0xff000000u;
}

/* Fills scratch->all, and tints if the cap has any. A row in which an outline is not closed is left out. */
static void find_inside(const struct soft_cap *cap, const struct soft_band *band, int index,
                        const struct soft_cap_scratch *scratch)
{
    const size_t n_words = (size_t)(band->width + 63) / 64, n_bytes = (size_t)band->n_rows * n_words * sizeof(uint64_t);
    memset(scratch->all, 0, n_bytes);
    for (size_t r = 0; r < cap->draw->cap.n_regions; r++) {
        const struct soft_cap_region *region = &cap->regions[r];
        uint8_t odd[SOFT_BAND_ROWS] = { 0 };
        if (region->starts[index] == region->starts[index + 1])
            continue;
        memset(scratch->inside, 0, n_bytes);
        for (uint32_t i = region->starts[index]; i < region->starts[index + 1]; i++)
            cross_rows(&region->edges[region->refs[i]], band, scratch->inside, n_words, odd);
        for (int y = 0; y < band->n_rows; y++) {
            uint64_t *inside = scratch->inside + (size_t)y * n_words, *all = scratch->all + (size_t)y * n_words;
            if (odd[y])
                continue;
            fill_row(inside, n_words);
            for (size_t i = 0; i < n_words; i++)
                all[i] |= inside[i];
            if (cap->draw->cap.tint > 0)
                paint_row(inside, band->width, color_of(cap->draw->cap.regions[r].color_rgb),
                          scratch->tints + (size_t)y * 64 * n_words);
        }
    }
}

/* ---- rows ------------------------------------------------------------------------------------------------------- */

/* How much nearer than its plane a cap is drawn. Corners of triangles that end in the plane are moved by up to half a
 * sub-sample each way and keep their depth: they must not come out before the cap where they bound an inner region. */
static float nearer(const struct soft_plane *plane)
{
    return (float)(2 * VISIBLE_CAP_DEPTH + (fabs(plane->at[4][0]) + fabs(plane->at[4][1])) / SOFT_SUB);
}

static int to_sample(double x, int width)
{
    return (int)fmin(fmax(x, -1), width);
}

void soft_cap_draw(const struct soft_cap *cap, const struct soft_kernels *kernels, const struct soft_band *band,
                   int index, const struct soft_cap_scratch *scratch)
{
    const struct draw_cap *draw = &cap->draw->cap;
    if (cap->plane.is_empty)
        return;
    const size_t n_words = (size_t)(band->width + 63) / 64;
    const bool has_grid = cap->plane.texture.voxels != NULL;
    find_inside(cap, band, index, scratch);
    for (int y = 0; y < band->n_rows; y++) {
        double low, high;
        struct soft_row row = soft_plane_row(&cap->plane, band->first_row + y, band->width, &low, &high);
        int first = (int)ceil(fmin(low, band->width)), end = (int)floor(fmax(high, -1)) + 1;
        soft_plane_narrow(&cap->plane, &row, &low, &high);
        const size_t at = (size_t)y * (size_t)band->stride;
        float *depth = band->depth + at;
        uint32_t *color = band->color + at;
        struct soft_cover cover = {
            .texture = has_grid ? &cap->plane.texture : NULL,
            .image_first = has_grid ? to_sample(ceil(low), band->width) : 0,
            .image_end = has_grid ? to_sample(floor(high), band->width) + 1 : 0,
            .tints = draw->tint > 0 ? scratch->tints + (size_t)y * 64 * n_words : NULL,
            .tint = (uint32_t)lround(256 * draw->tint),
            .dark = cap->dark,
            .nearer = nearer(&cap->plane),
            .mark = cap->wash ? SOFT_OPAQUE ^ SOFT_MARK : 0,
        };
        for (int last; next_run(scratch->all + (size_t)y * n_words, &first, &last, end); first = last + 1) {
            kernels->cover(&cover, &row, first, last - first + 1, depth, color);
            if (cap->wash)
                soft_volume_kernels_of(kernels)->wash(cap->wash, first, band->first_row + y, last - first + 1,
                                                      SOFT_MARK, color);
        }
    }
}
