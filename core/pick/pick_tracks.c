/* Finds the particle track near a pixel: one pass over all segments in the picture's space. */
#include "core/pick/pick_tracks.h"

#include <math.h>
#include <string.h>

#include "core/pick/pick.h"
#include "core/scene/tracks_shown.h"

/* The pixels around the one that is asked for, where surfaces may hide a segment. */
enum { AROUND = (int)PICK_TRACK_PX + 1, SIDE = 2 * AROUND + 1 };
/* Less of the light than this: what lies behind is hidden. */
#define HIDDEN_LIGHT 0.1
/* A line that lies in a surface is seen. */
#define SLACK_MM 0.01

/* Rows that give, of a point (x, y, z, 1): its place in pixels from the one asked for, times w; w; its depth in mm. */
struct frame {
    double right[4], down[4], w[4], depth[4];
};

struct search {
    const struct snapshot *snapshot;
    struct camera camera;
    struct frame frame;
    double px, py;
    double half_width_px;
    double nearest_mm; /* depth before which nothing is drawn */
    size_t n_clips;
    double hidden_from_mm[SIDE][SIDE]; /* by pixel: depth from which on all is hidden; NaN: not looked up yet */
    bool is_found;
    double best_depth_mm;
    struct pick_track_hit best;
};

static double row_of(const double row[4], const float p[3])
{
    return row[0] * (double)p[0] + row[1] * (double)p[1] + row[2] * (double)p[2] + row[3];
}

static void make_frame(struct search *search)
{
    const double *m = search->camera.clip_from_lps_mm.m;
    const int *size = search->snapshot->view.size_px;
    double x = 2 * search->px / size[0] - 1, y = 1 - 2 * search->py / size[1];
    for (int c = 0; c < 4; c++) {
        search->frame.right[c] = (m[4 * c] - x * m[4 * c + 3]) * size[0] / 2;
        search->frame.down[c] = (y * m[4 * c + 3] - m[4 * c + 1]) * size[1] / 2;
        search->frame.w[c] = m[4 * c + 3];
    }
    const struct vec3 forward = search->camera.forward;
    const double depth[4] = { forward.x, forward.y, forward.z, -vec3_dot(forward, search->camera.eye_lps_mm) };
    memcpy(search->frame.depth, depth, sizeof depth);
}

/* Nearest depth at which tracks are drawn: a view in perspective begins shortly before its near plane, and a beam's-eye
 * view at the eye. */
static double nearest_depth_mm(const struct search *search)
{
    if (!search->camera.is_parallel)
        return 0.1 * search->camera.near_mm;
    return search->snapshot->view.kind == SCENE_KIND_BEAM ? fmin(search->camera.near_mm, 0) : -INFINITY;
}

/* True if no point of the segment can be within reach: both ends lie beyond the same side of the square around the
 * pixel. Compares before the division by w, so it holds behind the eye as well. */
static bool is_outside(const struct frame *frame, const struct track_segment *segment, double reach_px)
{
    double w0 = row_of(frame->w, segment->from_lps_mm) * reach_px, w1 = row_of(frame->w, segment->to_lps_mm) * reach_px;
    double x0 = row_of(frame->right, segment->from_lps_mm), x1 = row_of(frame->right, segment->to_lps_mm);
    if ((x0 > w0 && x1 > w1) || (x0 < -w0 && x1 < -w1))
        return true;
    double y0 = row_of(frame->down, segment->from_lps_mm), y1 = row_of(frame->down, segment->to_lps_mm);
    return (y0 > w0 && y1 > w1) || (y0 < -w0 && y1 < -w1);
}

static struct vec3 point_of(const float p[3])
{
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

/* Keeps the part of a segment, from *low to *high of its length, where a value that goes evenly from at_0 to at_1 is at
 * least 0. False: nothing is left. */
static bool keep_positive(double at_0, double at_1, double *low, double *high)
{
    if (at_0 < 0 && at_1 < 0)
        return false;
    if (at_0 < 0)
        *low = fmax(*low, at_0 / (at_0 - at_1));
    else if (at_1 < 0)
        *high = fmin(*high, at_0 / (at_0 - at_1));
    return *low <= *high;
}

/* The part of the segment that clip planes and the eye leave. */
static bool clip_segment(const struct search *search, const struct track_segment *segment, double *low, double *high)
{
    const struct vec3 from = point_of(segment->from_lps_mm), to = point_of(segment->to_lps_mm);
    *low = 0;
    *high = 1;
    if (isfinite(search->nearest_mm) &&
        !keep_positive(row_of(search->frame.depth, segment->from_lps_mm) - search->nearest_mm,
                       row_of(search->frame.depth, segment->to_lps_mm) - search->nearest_mm, low, high))
        return false;
    for (size_t i = 0; i < search->n_clips; i++) {
        const struct plane *plane = &search->snapshot->clips[i].plane;
        if (!keep_positive(CLIP_SLACK_MM - plane_height_mm(plane, from), CLIP_SLACK_MM - plane_height_mm(plane, to),
                           low, high))
            return false;
    }
    return true;
}

/* A point of a segment, `part` of its length from its first end, in the picture. */
struct place {
    double right_px, down_px, w;
};

static struct place place_of(const struct search *search, const struct track_segment *segment, double part)
{
    const struct frame *frame = &search->frame;
    double w = (1 - part) * row_of(frame->w, segment->from_lps_mm) + part * row_of(frame->w, segment->to_lps_mm);
    double right =
        (1 - part) * row_of(frame->right, segment->from_lps_mm) + part * row_of(frame->right, segment->to_lps_mm);
    double down =
        (1 - part) * row_of(frame->down, segment->from_lps_mm) + part * row_of(frame->down, segment->to_lps_mm);
    return (struct place){ right / w, down / w, w };
}

/* The depth from which on surfaces hide everything under a pixel. */
static double hidden_from_mm(struct search *search, double right_px, double down_px)
{
    int i = (int)floor(search->px + right_px) - (int)floor(search->px) + AROUND,
        j = (int)floor(search->py + down_px) - (int)floor(search->py) + AROUND;
    double *known = &search->hidden_from_mm[j][i];
    if (!isnan(*known))
        return *known;
    struct pick_hit hits[PICK_MAX_HITS];
    size_t n =
        snapshot_pick(search->snapshot, floor(search->px + right_px) + 0.5, floor(search->py + down_px) + 0.5, hits);
    double light = 1;
    *known = INFINITY;
    for (size_t h = 0; h < n && !isfinite(*known); h++) {
        if (hits[h].subject.kind == SUBJECT_BEAM) /* a line, which is hit beside it as well */
            continue;
        light *= 1 - hits[h].alpha;
        if (light < HIDDEN_LIGHT)
            *known = vec3_dot(vec3_sub(hits[h].point_lps_mm, search->camera.eye_lps_mm), search->camera.forward);
    }
    return *known;
}

static void look_at(struct search *search, size_t index)
{
    const struct track_segment *segment = &search->snapshot->plan->tracks.segments[index];
    double low, high;
    if (!clip_segment(search, segment, &low, &high))
        return;
    struct place a = place_of(search, segment, low), b = place_of(search, segment, high);
    double x = b.right_px - a.right_px, y = b.down_px - a.down_px, square = x * x + y * y;
    double along = square > 0 ? fmin(1, fmax(0, -(a.right_px * x + a.down_px * y) / square)) : 0;
    double right_px = a.right_px + along * x, down_px = a.down_px + along * y;
    double off_px = hypot(right_px, down_px), beside_px = fmax(0, off_px - search->half_width_px);
    if (!(off_px <= PICK_TRACK_PX) || (search->is_found && beside_px > search->best.distance_px))
        return;
    /* what runs evenly along the line in the picture does not in space, in perspective */
    double near = along * a.w, far = (1 - along) * b.w;
    double part = low + (high - low) * (near + far > 0 ? near / (near + far) : along);
    struct vec3 from = point_of(segment->from_lps_mm), to = point_of(segment->to_lps_mm),
                point = vec3_add(from, vec3_scale(vec3_sub(to, from), part));
    double depth_mm = vec3_dot(vec3_sub(point, search->camera.eye_lps_mm), search->camera.forward);
    if (search->is_found && beside_px == search->best.distance_px && depth_mm >= search->best_depth_mm)
        return;
    if (depth_mm > hidden_from_mm(search, right_px, down_px) + SLACK_MM)
        return;
    search->is_found = true;
    search->best_depth_mm = depth_mm;
    search->best =
        (struct pick_track_hit){ index, point, vec3_length(vec3_sub(point, search->camera.eye_lps_mm)), beside_px };
}

bool pick_track(const struct snapshot *snapshot, double px, double py, struct pick_track_hit *hit)
{
    const struct scene_track_style *style = &snapshot->scene.tracks;
    const struct track_set *set = &snapshot->plan->tracks;
    if (snapshot_is_pane(snapshot) || !style->visible || !fit_is_used(&snapshot->fits.tracks))
        return false;
    struct search search = { .snapshot = snapshot,
                             .px = px,
                             .py = py,
                             .half_width_px = fmax(1, style->width_px) / 2,
                             .n_clips = style->clipped ? snapshot->n_clips : 0 };
    camera_resolve(snapshot, &search.camera);
    search.nearest_mm = nearest_depth_mm(&search);
    make_frame(&search);
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            search.hidden_from_mm[j][i] = NAN;
    struct tracks_shown shown = tracks_shown_of(set, style);
    for (size_t i = shown.first; i < shown.end; i++)
        if (track_is_shown(&shown, &set->segments[i]) && !is_outside(&search.frame, &set->segments[i], PICK_TRACK_PX))
            look_at(&search, i);
    *hit = search.best;
    return search.is_found;
}
