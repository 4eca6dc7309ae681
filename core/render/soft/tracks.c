/* Prepares particle tracks: what the loops of a picture need, and chunks of lines sorted into bands. */
#include "core/render/soft/tracks.h"

#include <stdlib.h>
#include <string.h>

#include "core/render/soft/chunk.h"
#include "core/render/soft/frame.h"
#include "core/render/soft/track_line.h"

/* ---- the picture ------------------------------------------------------------------------------------------------ */

/* A clip plane over a sample's place and depth: the height below it, times 1 / w of the sample, which is positive. */
static void cut_row(const struct camera *camera, const struct clip_plane *clip, int width, int height, float row[4])
{
    /* an uncapped plane does not cut off what lies in it; wider than single precision rounds */
    const double in_plane_mm = clip->is_capped ? 0 : 1e-4;
    const struct vec3 *n = &clip->plane.normal;
    const double below[4] = { -n->x, -n->y, -n->z, plane_position_mm(&clip->plane) + in_plane_mm };
    double of_clip[4] = { 0 };
    for (int column = 0; column < 4; column++)
        for (int r = 0; r < 4; r++)
            of_clip[column] += below[r] * camera->lps_mm_from_clip.m[4 * column + r];
    row[0] = (float)(2 * of_clip[0] / width);
    row[1] = (float)(-2 * of_clip[1] / height);
    row[2] = (float)of_clip[2];
    row[3] = (float)(of_clip[3] - of_clip[0] + of_clip[1]);
}

static void init_cuts(struct soft_track_view *view, const struct clip_set *clip, const struct camera *camera)
{
    view->cuts = soft_cuts_of(clip);
    for (size_t i = 0, n = 0; i < clip->n_planes; i++)
        if (clip_set_has(clip, i))
            cut_row(camera, &clip->planes[i], view->width, view->height, view->cut_rows[n++]);
}

static void init_looks(struct soft_track_view *view, double samples_per_px)
{
    for (int class = 0; class < TRACK_N_CLASSES; class ++) {
        const struct track_look look = track_class_look((enum track_class) class);
        const double period_px = look.on_px + look.off_px;
        if (look.off_px > 0) {
            view->periods[class] = (float)(1 / (period_px * samples_per_px));
            view->dashes[class] = (float)(look.on_px / period_px);
        }
        view->special |= (uint32_t)look.has_cross << class;
        for (uint32_t level = 0; level < SOFT_TRACK_LEVELS; level++) {
            uint32_t color = SOFT_OPAQUE;
            for (int c = 0; c < 3; c++)
                color |= ((look.color_rgb >> (16 - 8 * c) & 255) * level + 127) / 255 << 8 * c;
            view->colors[class][level] = color;
        }
    }
}

void soft_track_view_init(struct soft_track_view *view, const struct draw *draw, const struct draw_scope *scope,
                          int width, int height, int n_bands)
{
    const struct camera *camera = scope->camera;
    const struct draw_tracks *tracks = &draw->tracks;
    const double samples_per_px = width / snapshot_line_width(scope->snapshot);
    const struct vec3 *f = &camera->forward;
    *view = (struct soft_track_view){ .tracks = tracks, .width = width, .height = height, .n_bands = n_bands };
    for (int column = 0; column < 4; column++) {
        const double *m = &camera->clip_from_lps_mm.m[4 * column];
        view->row_x[column] = (float)(0.5 * width * (m[3] + m[0]));
        view->row_y[column] = (float)(0.5 * height * (m[3] - m[1]));
        view->row_z[column] = (float)m[2];
        view->row_w[column] = (float)m[3];
    }
    const double ahead_mm = -vec3_dot(camera->eye_lps_mm, *f) - tracks->nearest_mm;
    const bool is_endless = tracks->nearest_mm == -INFINITY;
    const float ahead[4] = { (float)f->x, (float)f->y, (float)f->z, (float)ahead_mm }, always[4] = { 0, 0, 0, 1 };
    memcpy(view->row_ahead, is_endless ? always : ahead, sizeof view->row_ahead);
    const float cue[4] = { (float)tracks->cue.x, (float)tracks->cue.y, (float)tracks->cue.z, (float)tracks->cue.w };
    memcpy(view->row_cue, cue, sizeof view->row_cue);
    view->line_width = (float)draw_tracks_width(tracks, samples_per_px);
    view->is_thin = draw_tracks_are_thin(tracks, samples_per_px);
    view->cross = (float)(DRAW_TRACKS_CROSS_PX * samples_per_px) + view->line_width / 2;
    view->margin = view->cross + view->line_width + 2;
    /* a sample is largest at the far plane */
    const double *m = camera->clip_from_lps_mm.m, side = width * sqrt(m[0] * m[0] + m[4] * m[4] + m[8] * m[8]) / 2;
    view->near_cut_mm = (float)((camera->is_parallel ? 1 : camera->far_mm) / side) * (view->line_width / 2 + 1);
    init_cuts(view, &draw->clip, camera);
    init_looks(view, samples_per_px);
}

/* ---- lines that need more than a projection --------------------------------------------------------------------- */

/* A point of a segment in the picture, before places are rounded to floats. */
struct place {
    double x, y, z, cue;
};

static struct place between(const struct place *a, const struct place *b, double t)
{
    return (struct place){ a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), a->z + t * (b->z - a->z),
                           a->cue + t * (b->cue - a->cue) };
}

static double apply(const float row[4], struct vec3 p)
{
    return (double)row[0] * p.x + (double)row[1] * p.y + (double)row[2] * p.z + (double)row[3];
}

/* Narrows the part of a line where a + t (b - a) >= 0. */
static void narrow(double a, double b, double *low, double *high)
{
    if (a < 0 && b < 0)
        *high = -1;
    else if (a < 0)
        *low = fmax(*low, a / (a - b));
    else if (b < 0)
        *high = fmin(*high, a / (a - b));
}

/* The part of a segment that clip planes and the eye leave. False: none. is_near: a clip plane is. */
static bool cut(const struct soft_track_view *view, struct vec3 p, struct vec3 q, double *low, double *high,
                bool *is_near)
{
    *is_near = false;
    *low = 0;
    *high = 1;
    for (int c = 0; c < view->cuts.n; c++) {
        const float *n = view->cuts.normal[c], row[4] = { -n[0], -n[1], -n[2], view->cuts.position[c] };
        double a = apply(row, p), b = apply(row, q);
        if (a <= 0 && b <= 0)
            return false;
        *is_near |= fmin(a, b) <= (double)view->near_cut_mm;
        narrow(a, b, low, high);
    }
    narrow(apply(view->row_ahead, p), apply(view->row_ahead, q), low, high);
    return *low <= *high;
}

static struct place project(const struct soft_track_view *view, struct vec3 p)
{
    double w = apply(view->row_w, p);
    return (struct place){ apply(view->row_x, p) / w, apply(view->row_y, p) / w, apply(view->row_z, p) / w,
                           255 * fmin(1, fmax(VISIBLE_DARKEST, apply(view->row_cue, p))) };
}

static bool reserve(struct soft_track_scratch *scratch, size_t n)
{
    return soft_reserve(&scratch->lines, &scratch->lines_capacity, n, sizeof *scratch->lines) &&
           soft_reserve(&scratch->reaches, &scratch->reaches_capacity, n, sizeof *scratch->reaches);
}

/* Leaves out the first and last samples of a chain that rounding has put outside of the picture. */
static void trim(struct track_chain *chain, int width, int height)
{
    const int n_along = chain->is_tall ? height : width, n_across = chain->is_tall ? width : height;
    while (chain->n > 0 && (chain->first < 0 || chain->at >> 16 < 0 || chain->at >> 16 >= n_across)) {
        chain->first++;
        chain->n--;
        chain->at += chain->step;
        chain->z += chain->z_step;
        chain->cue += chain->cue_step;
    }
    for (int last; chain->n > 0; chain->n--) {
        last = (chain->at + (chain->n - 1) * chain->step) >> 16;
        if (chain->first + chain->n <= n_along && last >= 0 && last < n_across)
            break;
    }
    int a = chain->at >> 16, b = (chain->at + (chain->n - 1) * chain->step) >> 16;
    chain->low_row = chain->is_tall ? chain->first : a < b ? a : b;
    chain->high_row = chain->is_tall ? chain->first + chain->n - 1 : a < b ? b : a;
}

/* Adds the part of a line that is in the picture. phase: at a, in periods. */
static bool add(const struct soft_track_view *view, const struct place *a, const struct place *b, uint8_t class,
                uint8_t flags, double phase, struct soft_track_scratch *scratch)
{
    /* a thin line ends at the picture's edge, another one beyond it, so that its end is not seen */
    const double out = view->is_thin ? 0 : (double)view->margin;
    double low = 0, high = 1;
    narrow(a->x + out, b->x + out, &low, &high);
    narrow(view->width + out - a->x, view->width + out - b->x, &low, &high);
    narrow(a->y + out, b->y + out, &low, &high);
    narrow(view->height + out - a->y, view->height + out - b->y, &low, &high);
    if (!(low <= high))
        return true;
    const struct place ends_at[2] = { between(a, b, low), between(a, b, high) };
    const float periods = flags & SOFT_TRACK_DASHED ? view->periods[class] : 0;
    phase += low * hypot(b->x - a->x, b->y - a->y) * (double)periods;
    phase -= floor(phase);
    struct track_ends ends;
    for (int i = 0; i < 2; i++) {
        ends.x[i] = (float)ends_at[i].x;
        ends.y[i] = (float)ends_at[i].y;
        ends.z[i] = (float)ends_at[i].z;
        ends.cue[i] = (float)ends_at[i].cue;
    }
    if (!reserve(scratch, scratch->n + 1))
        return false;
    struct soft_track_line *line = &scratch->lines[scratch->n];
    struct soft_track_reach *reach = &scratch->reaches[scratch->n];
    line->class = class;
    line->flags = flags;
    if (!view->is_thin) {
        bool is_tall = fabsf(ends.y[1] - ends.y[0]) > fabsf(ends.x[1] - ends.x[0]);
        line->flags |= is_tall ? SOFT_TRACK_TALL : 0;
        track_line_wide(line, &ends, (float)phase);
        scratch->n += track_reach_wide(reach, view, &ends);
        return true;
    }
    struct track_chain chain;
    track_chain_make(ends.x[0], ends.y[0], ends.z[0], ends.cue[0], ends.x[1], ends.y[1], ends.z[1], ends.cue[1],
                     &chain);
    line->flags |= chain.is_tall ? SOFT_TRACK_TALL : 0;
    const int first = chain.first;
    struct soft_track_line dash = { 0 };
    if (periods > 0)
        track_line_dash(&dash, &chain, &ends, periods, (float)phase);
    trim(&chain, view->width, view->height);
    if (chain.n == 0)
        return true;
    track_line_thin(line, &chain);
    line->thin.phase_step = dash.thin.phase_step;
    line->thin.phase = (uint16_t)(dash.thin.phase + (uint32_t)(chain.first - first) * dash.thin.phase_step);
    scratch->n += track_reach(reach, chain.low_row, chain.high_row, view->height);
    return true;
}

/* Adds a line in up to three parts, of which the first and the last have the depth of the near or the far plane. */
static bool add_in_depth(const struct soft_track_view *view, const struct place *a, const struct place *b,
                         uint8_t class, uint8_t flags, struct soft_track_scratch *scratch)
{
    const double far = 2 * DRAW_TRACKS_FAR - 1, ends[2] = { -1, far };
    const double periods = flags & SOFT_TRACK_DASHED ? (double)view->periods[class] : 0;
    const double whole = hypot(b->x - a->x, b->y - a->y) * periods;
    double at[4] = { 0, 1, 1, 1 };
    int n = 1;
    for (int i = 0; i < 2; i++) {
        double t = (ends[i] - a->z) / (b->z - a->z);
        if (t > 0 && t < 1)
            at[n++] = t;
    }
    if (n == 3 && at[2] < at[1]) {
        double t = at[1];
        at[1] = at[2];
        at[2] = t;
    }
    at[n] = 1;
    for (int i = 0; i < n; i++) {
        struct place from = between(a, b, at[i]), to = between(a, b, at[i + 1]);
        from.z = fmin(far, fmax(-1, from.z));
        to.z = fmin(far, fmax(-1, to.z));
        if (!add(view, &from, &to, class, flags, at[i] * whole, scratch))
            return false;
    }
    return true;
}

bool soft_track_special(const struct soft_track_view *view, size_t segment, struct soft_track_scratch *scratch)
{
    const struct track_segment *s = &view->tracks->set->segments[segment];
    struct vec3 p = vec3((double)s->from_lps_mm[0], (double)s->from_lps_mm[1], (double)s->from_lps_mm[2]),
                q = vec3((double)s->to_lps_mm[0], (double)s->to_lps_mm[1], (double)s->to_lps_mm[2]);
    double low, high;
    bool is_near;
    if (!vec3_is_finite(p) || !vec3_is_finite(q) || !cut(view, p, q, &low, &high, &is_near))
        return true;
    struct vec3 way = vec3_sub(q, p);
    struct place a = project(view, vec3_add(p, vec3_scale(way, low))),
                 b = project(view, vec3_add(p, vec3_scale(way, high)));
    uint8_t dashed = view->periods[s->class] > 0 ? SOFT_TRACK_DASHED : 0, is_cut = is_near ? SOFT_TRACK_CUT : 0;
    if (!add_in_depth(view, &a, &b, s->class, dashed | is_cut, scratch))
        return false;
    if (!(view->special >> s->class & 1) || high < 1)
        return true;
    for (int arm = -1; arm <= 1; arm += 2) {
        struct place from = b, to = b;
        const double side = (double)view->cross;
        from.x -= side;
        from.y -= arm * side;
        to.x += side;
        to.y += arm * side;
        if (!add_in_depth(view, &from, &to, s->class, is_cut, scratch))
            return false;
    }
    return true;
}

/* ---- chunks ----------------------------------------------------------------------------------------------------- */

void soft_track_scratch_finish(struct soft_track_scratch *scratch)
{
    free(scratch->lines);
    free(scratch->reaches);
}

void soft_track_chunk_finish(struct soft_track_chunk *chunk)
{
    free(chunk->lines);
    free(chunk->starts);
}

bool soft_track_chunks_resize(struct soft_track_chunks *chunks, size_t n, struct error *err)
{
    if (n <= chunks->n)
        return true;
    struct soft_track_chunk *grown = realloc(chunks->chunks, n * sizeof *grown);
    if (!grown)
        return error_set(err, ERROR_MEMORY, "no memory for %zu pieces of tracks", n);
    memset(grown + chunks->n, 0, (n - chunks->n) * sizeof *grown);
    *chunks = (struct soft_track_chunks){ grown, n };
    return true;
}

void soft_track_chunks_finish(struct soft_track_chunks *chunks)
{
    for (size_t i = 0; i < chunks->n; i++)
        soft_track_chunk_finish(&chunks->chunks[i]);
    free(chunks->chunks);
}

/* Sorts the lines by band, then flat before tall: a counting sort, as in bins.c. */
static bool sort_lines(struct soft_track_chunk *chunk, const struct soft_track_scratch *scratch, int n_bands)
{
    size_t n_starts = 2 * (size_t)n_bands + 1;
    if (!soft_reserve(&chunk->starts, &chunk->starts_capacity, n_starts, sizeof *chunk->starts))
        return false;
    uint32_t *starts = chunk->starts, n_lines = 0;
    memset(starts, 0, n_starts * sizeof *starts);
    for (size_t i = 0; i < scratch->n; i++)
        for (int band = scratch->reaches[i].first_band; band <= scratch->reaches[i].last_band; band++)
            starts[2 * band + (scratch->lines[i].flags & SOFT_TRACK_TALL)]++;
    for (size_t bin = 0; bin < n_starts; bin++) {
        n_lines += starts[bin];
        starts[bin] = n_lines;
    }
    if (!soft_reserve(&chunk->lines, &chunk->lines_capacity, n_lines, sizeof *chunk->lines))
        return false;
    for (size_t i = scratch->n; i-- > 0;)
        for (int band = scratch->reaches[i].first_band; band <= scratch->reaches[i].last_band; band++)
            chunk->lines[--starts[2 * band + (scratch->lines[i].flags & SOFT_TRACK_TALL)]] = scratch->lines[i];
    return true;
}

void soft_tracks_draw(const struct soft_track_view *view, const struct soft_track_kernels *kernels,
                      const struct soft_track_chunks *chunks, size_t n, const struct soft_band *band, int index)
{
    float farthest[SOFT_TRACK_TILES];
    for (size_t c = 0; c < n; c++) {
        const struct soft_track_chunk *chunk = &chunks->chunks[c];
        const uint32_t *bins = chunk->starts + 2 * index;
        if (c % SOFT_TRACK_LOOK == 0)
            kernels->find_farthest(band, farthest);
        for (int is_tall = 0; is_tall < 2; is_tall++)
            kernels->raster(view, band, farthest, chunk->lines + bins[is_tall], bins[is_tall + 1] - bins[is_tall],
                            is_tall);
    }
}

bool soft_track_chunk_sort(struct soft_track_chunk *chunk, size_t index, const struct soft_track_view *view,
                           const struct soft_track_kernels *kernels, struct soft_track_scratch *scratch)
{
    const struct tracks_shown *shown = &view->tracks->shown;
    size_t first = shown->first + index * SOFT_TRACK_CHUNK, n = shown->end - first, n_special;
    n = n < SOFT_TRACK_CHUNK ? n : SOFT_TRACK_CHUNK;
    if (!reserve(scratch, SOFT_TRACK_CHUNK))
        return false;
    scratch->n = kernels->project(view, first, n, scratch->lines, scratch->reaches, scratch->special, &n_special);
    for (size_t i = 0; i < n_special; i++)
        if (!soft_track_special(view, scratch->special[i], scratch))
            return false;
    return sort_lines(chunk, scratch, view->n_bands);
}
