/* Where crosshair and aperture ring are in pictures along a beam, and their lines. */
#include "core/render/visible/beam_eye_marks.h"

static const uint32_t ink_rgb = 0xffffff, planned_rgb = 0xc9ced6, halo_rgb = 0x07080a;
static const double halo_px = 1, crosshair_strength = 0.9, crosshair_halo_strength = 0.55;
static const double planned_px = 1.4, dash_px = 6, dash_gap_px = 5, planned_arm_px = 6;
static const double ring_tick_px = 7, dot_px = 5;
/* An arc is a chord where it is this close to it. */
static const double chord_px = 0.01;

/* ---- places ----------------------------------------------------------------------------------------------------- */

static struct paint_point place_of(const struct beam_eye_marks *marks, const struct camera *camera, struct vec3 p)
{
    struct vec3 clip = mat4_project(&camera->clip_from_lps_mm, p);
    return (struct paint_point){ (clip.x + 1) / 2 * marks->size_px[0], (1 - clip.y) / 2 * marks->size_px[1] };
}

/* Pixels to the millimetre in a plane across the line of sight; 0: it is not before the eye. */
static double scale_at(const struct snapshot *snapshot, const struct camera *camera, struct vec3 p)
{
    const struct view *view = &snapshot->view;
    double depth_mm = vec3_dot(vec3_sub(p, camera->eye_lps_mm), camera->forward);
    if (camera->is_parallel)
        return camera->pixels_per_mm;
    double smaller = fmin(view->size_px[0], view->size_px[1]);
    return depth_mm > 1e-3 ? smaller / (2 * depth_mm * tan(view->camera.fov_deg / 2 * MATH_PI / 180)) : 0;
}

static void add_planned(struct beam_eye_marks *marks, const struct snapshot *snapshot, const struct camera *camera)
{
    if (!snapshot->beam.is_draft || snapshot->beam.beam < 0)
        return;
    struct beam_shown planned = beam_planned(snapshot->plan, (size_t)snapshot->beam.beam);
    if (!(scale_at(snapshot, camera, planned.entry_lps_mm) > 0))
        return;
    marks->has_planned = true;
    marks->planned_entry = place_of(marks, camera, planned.entry_lps_mm);
    marks->planned_plane = beam_plane(&planned, 0);
    if (marks->ring_mm > 0)
        marks->planned_mm = planned.aperture_mm > 0 ? planned.aperture_mm : marks->ring_mm;
}

bool beam_eye_marks_of(const struct snapshot *snapshot, const struct camera *camera, struct beam_eye_marks *marks)
{
    const struct beam_shown *beam = snapshot_beam(snapshot);
    const struct view *view = &snapshot->view;
    bool is_eye = view->kind == SCENE_KIND_BEAM;
    if (!beam)
        return false;
    *marks = (struct beam_eye_marks){ .size_px = { view->size_px[0], view->size_px[1] },
                                      .has_crosshair = view->beam.crosshair,
                                      .ring_mm = view->beam.has_aperture_mm ? view->beam.aperture_mm : 0 };
    struct vec3 at = is_eye ? beam->target_lps_mm : beam_point(beam, snapshot->scene.beam.slice.along_mm);
    marks->pixels_per_mm = scale_at(snapshot, camera, at);
    marks->middle =
        is_eye ? (struct paint_point){ marks->size_px[0] / 2, marks->size_px[1] / 2 } : place_of(marks, camera, at);
    if (!marks->has_crosshair && !(marks->ring_mm > 0))
        return false;
    if (is_eye)
        add_planned(marks, snapshot, camera);
    return true;
}

double beam_eye_tick_px(const struct beam_eye_marks *marks, int64_t fives)
{
    int64_t step = fives % 10 == 0 ? 10 : fives % 2 == 0 ? 2 : 1;
    if (5.0 * (double)step * marks->pixels_per_mm < BEAM_EYE_LEAST_STEP_PX)
        return 0;
    return step == 10 ? 9 : step == 2 ? 6 : 3;
}

/* The part of an axis of the picture, 0: x, 1: y, that the crosshair takes. */
static void reach_of(const struct beam_eye_marks *marks, int axis, double *low, double *high)
{
    double margin = fmin(BEAM_EYE_MARGIN_PX, marks->size_px[axis] / 10);
    *low = margin;
    *high = marks->size_px[axis] - margin;
}

size_t beam_eye_numbers(const struct beam_eye_marks *marks, double text_px,
                        struct beam_eye_number numbers[BEAM_EYE_MAX_NUMBERS])
{
    static const int shown_mm[] = { 20, 40, 80 };
    size_t n = 0;
    double low[2], high[2], aside_px = 9 + text_px;
    const double middle[2] = { marks->middle.x, marks->middle.y };
    if (!marks->has_crosshair || !(marks->pixels_per_mm > 0))
        return 0;
    for (int axis = 0; axis < 2; axis++)
        reach_of(marks, axis, &low[axis], &high[axis]);
    for (int i = 0; i < 3; i++) {
        int before_mm = i ? shown_mm[i - 1] : 0;
        for (int arm = 0; arm < 4 && (shown_mm[i] - before_mm) * marks->pixels_per_mm >= 2 * text_px; arm++) {
            int axis = arm / 2;
            double at[2] = { middle[0], middle[1] };
            at[axis] += (arm % 2 ? -1 : 1) * shown_mm[i] * marks->pixels_per_mm;
            at[!axis] += aside_px;
            bool is_in_picture = at[axis] >= low[axis] && at[axis] <= high[axis] && at[!axis] >= text_px &&
                                 at[!axis] <= marks->size_px[!axis] - text_px;
            if (is_in_picture)
                numbers[n++] = (struct beam_eye_number){ { at[0], at[1] }, shown_mm[i] };
        }
    }
    return n;
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

/* Where lines go: `wider` for their halos. */
struct pen {
    const struct beam_eye_marks *marks;
    struct paint *paint;
    double scale, wider_px;
};

static void line(const struct pen *pen, struct paint_point a, struct paint_point b, double width_px)
{
    struct paint_point from = { a.x * pen->scale, a.y * pen->scale }, to = { b.x * pen->scale, b.y * pen->scale };
    paint_line(pen->paint, from, to, fmax(1, (width_px + pen->wider_px) * pen->scale));
}

/* A line along an axis of the picture, 0: x, 1: y; across: its other coordinate. */
static void straight(const struct pen *pen, int axis, double across, double from, double to, double width_px)
{
    struct paint_point a = { axis ? across : from, axis ? from : across },
                       b = { axis ? across : to, axis ? to : across };
    if (to > from)
        line(pen, a, b, width_px);
}

static void ticks(const struct pen *pen, int axis, double middle, double across, double low, double high)
{
    double step_px = 5 * pen->marks->pixels_per_mm;
    if (10 * step_px < BEAM_EYE_LEAST_STEP_PX)
        return;
    /* a picture of 4096 pixels has at most 10240 places of ticks, from its margin on */
    int64_t first = (int64_t)ceil((low - middle) / step_px), last = (int64_t)floor((high - middle) / step_px);
    for (int64_t i = first; i <= last; i++) {
        double half = beam_eye_tick_px(pen->marks, i), at = middle + (double)i * step_px;
        if (half > 0 && fabs(at - middle) > BEAM_EYE_GAP_PX)
            straight(pen, !axis, at, across - half, across + half, BEAM_EYE_LINE_PX);
    }
}

static void crosshair(const struct pen *pen)
{
    const struct beam_eye_marks *marks = pen->marks;
    const double middle[2] = { marks->middle.x, marks->middle.y };
    for (int axis = 0; axis < 2; axis++) {
        double low, high, at = middle[axis], across = middle[!axis];
        reach_of(marks, axis, &low, &high);
        straight(pen, axis, across, low, fmin(high, at - BEAM_EYE_GAP_PX), BEAM_EYE_LINE_PX);
        straight(pen, axis, across, fmax(low, at + BEAM_EYE_GAP_PX), high, BEAM_EYE_LINE_PX);
        ticks(pen, axis, at, across, low, high);
    }
    line(pen, marks->middle, marks->middle, dot_px);
}

/* Chords of a circle of this radius that are nowhere further than chord_px from it. */
static int n_chords(double radius_px)
{
    return (int)fmin(fmax(ceil(MATH_PI * sqrt(radius_px / (2 * chord_px))), 24), 16384);
}

static void ring(const struct pen *pen)
{
    const struct beam_eye_marks *marks = pen->marks;
    double radius = marks->ring_mm / 2 * marks->pixels_per_mm;
    int n = n_chords(radius);
    struct paint_point m = marks->middle, before = { m.x + radius, m.y };
    for (int i = 1; i <= n; i++) {
        double turn = 2 * MATH_PI * i / n;
        struct paint_point at = { m.x + radius * cos(turn), m.y + radius * sin(turn) };
        line(pen, before, at, BEAM_EYE_RING_PX);
        before = at;
    }
    for (int axis = 0; axis < 2; axis++)
        for (int side = -1; side <= 1; side += 2) {
            double from = (axis ? m.y : m.x) + side * radius, to = from + side * ring_tick_px;
            straight(pen, axis, axis ? m.x : m.y, fmin(from, to), fmax(from, to), BEAM_EYE_RING_PX);
        }
}

/* A dash ends where its round caps do. */
static void dash(const struct pen *pen, struct paint_point a, struct paint_point b, double from, double to)
{
    double length = hypot(b.x - a.x, b.y - a.y);
    if (!(to > from) || !(length > 0))
        return;
    struct paint_point p = { a.x + from / length * (b.x - a.x), a.y + from / length * (b.y - a.y) },
                       q = { a.x + to / length * (b.x - a.x), a.y + to / length * (b.y - a.y) };
    line(pen, p, q, planned_px);
}

/* The dashes of a chord that begins `run` pixels after the first dash did; returns where it ends. */
static double dashes(const struct pen *pen, struct paint_point a, struct paint_point b, double run)
{
    double length = hypot(b.x - a.x, b.y - a.y), period = dash_px + dash_gap_px;
    double on = planned_px / 2, off = dash_px - planned_px / 2;
    for (double start = floor(run / period) * period; start < run + length; start += period)
        dash(pen, a, b, fmax(0, start + on - run), fmin(length, start + off - run));
    return run + length;
}

/* The planned beam's ring, as far as it is within reach of the picture: a zoomed one has too many dashes elsewhere. */
static void planned_ring(const struct pen *pen, const struct camera *camera)
{
    const struct beam_eye_marks *marks = pen->marks;
    const struct plane *plane = &marks->planned_plane;
    double radius = marks->planned_mm / 2, run = 0, far_px = marks->size_px[0] + marks->size_px[1];
    int n = n_chords(radius * marks->pixels_per_mm);
    struct paint_point before = { 0, 0 };
    for (int i = 0; i <= n; i++) {
        double turn = 2 * MATH_PI * i / n;
        struct vec3 p = vec3_add(plane->origin_lps_mm, vec3_add(vec3_scale(plane->right, radius * cos(turn)),
                                                                vec3_scale(plane->up, radius * sin(turn))));
        struct paint_point at = place_of(marks, camera, p);
        bool is_near = fabs(at.x) < far_px && fabs(at.y) < far_px && fabs(before.x) < far_px && fabs(before.y) < far_px;
        if (i > 0)
            run = is_near ? dashes(pen, before, at, run) : run + hypot(at.x - before.x, at.y - before.y);
        before = at;
    }
}

static void planned(const struct pen *pen, const struct camera *camera)
{
    struct paint_point at = pen->marks->planned_entry;
    if (pen->marks->planned_mm > 0)
        planned_ring(pen, camera);
    for (int axis = 0; axis < 2; axis++)
        straight(pen, axis, axis ? at.x : at.y, (axis ? at.y : at.x) - planned_arm_px,
                 (axis ? at.y : at.x) + planned_arm_px, planned_px);
}

void beam_eye_paint(const struct beam_eye_marks *marks, const struct camera *camera, double scale, struct paint *paint)
{
    for (int is_ink = 0; is_ink < 2; is_ink++) { /* all halos before the first line, so that none covers a line */
        const struct pen pen = { marks, paint, scale, is_ink ? 0 : 2 * halo_px };
        if (marks->has_crosshair)
            crosshair(&pen);
        paint_flush(paint, is_ink ? ink_rgb : halo_rgb, is_ink ? crosshair_strength : crosshair_halo_strength);
        if (marks->has_planned)
            planned(&pen, camera);
        paint_flush(paint, is_ink ? planned_rgb : halo_rgb, 1);
        if (marks->ring_mm > 0 && marks->pixels_per_mm > 0)
            ring(&pen);
        paint_flush(paint, is_ink ? ink_rgb : halo_rgb, 1);
    }
}
