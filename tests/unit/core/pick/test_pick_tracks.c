/* Picking particle tracks: nearest in the picture, then nearest to the eye; never what is filtered, cut off or hidden.
 */
#include "core/pick/pick.h"
#include "core/pick/pick_tracks.h"
#include "core/scene/tracks_shown.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

enum { SIDE_PX = 401 };
#define EYE_Y_MM (-500.0)
#define FOV_DEG 30.0

/* A ball of 60 mm around the origin. */
static double ball(struct vec3 p)
{
    return vec3_length(p) < 60 ? 1 : 0;
}

static struct plan *tracks_plan(bool has_ball, size_t n)
{
    static const struct made_region body = { "body", -1, 0xff0000 };
    struct grid grid =
        made_grid(80, 80, 80,
                  made_affine(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 2), (uint32_t[3]){ 80, 80, 80 }, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, ball, &body, has_ball ? 1 : 0);
    plan->tracks.segments = mem_new((n + 1) * sizeof *plan->tracks.segments);
    return plan;
}

static void add(struct plan *plan, struct vec3 a, struct vec3 b, enum track_class class, double energy_mev)
{
    plan->tracks.segments[plan->tracks.n_segments++] = (struct track_segment){ { (float)a.x, (float)a.y, (float)a.z },
                                                                               { (float)b.x, (float)b.y, (float)b.z },
                                                                               (uint8_t) class,
                                                                               (float)energy_mev };
    plan->tracks.n_of_class[class]++;
}

/* Looks from EYE_Y_MM towards posterior, superior up: right in the picture is the patient's left. */
static struct snapshot *look(struct plan *plan, void (*change)(struct scene *scene, struct view *view))
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    scene.tracks.visible = true;
    view.size_px[0] = view.size_px[1] = SIDE_PX;
    view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_up = true;
    view.camera.position_mm = vec3(0, EYE_Y_MM, 0);
    view.camera.target_mm = vec3(0, 0, 0);
    view.camera.up = vec3(0, 0, 1);
    view.camera.fov_deg = FOV_DEG;
    if (change)
        change(&scene, &view);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

/* The pixel of a point, from the pinhole's similar triangles. */
static void pixel_of(struct vec3 p, double pixel[2])
{
    double focal_px = SIDE_PX / 2.0 / tan(FOV_DEG / 2 * MATH_PI / 180), depth_mm = p.y - EYE_Y_MM;
    pixel[0] = SIDE_PX / 2.0 + focal_px * p.x / depth_mm;
    pixel[1] = SIDE_PX / 2.0 - focal_px * p.z / depth_mm;
}

static bool pick_at(const struct snapshot *snapshot, struct vec3 p, struct pick_track_hit *hit)
{
    double pixel[2];
    pixel_of(p, pixel);
    return pick_track(snapshot, pixel[0], pixel[1], hit);
}

static void finish(struct plan *plan, struct snapshot *snapshot)
{
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static double draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static struct vec3 draw_point(uint64_t *seed)
{
    return vec3(160 * draw(seed) - 80, 160 * draw(seed) - 80, 160 * draw(seed) - 80);
}

static struct vec3 end_of(const float p[3])
{
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

/* Distance of a segment's picture from a pixel, by 4000 points of the segment; at: the nearest of them. */
static double sampled_px(const struct track_segment *segment, const double pixel[2], struct vec3 *at)
{
    enum { N = 4000 };
    struct vec3 a = end_of(segment->from_lps_mm), b = end_of(segment->to_lps_mm);
    double least = INFINITY;
    for (int i = 0; i <= N; i++) {
        struct vec3 p = vec3_add(a, vec3_scale(vec3_sub(b, a), (double)i / N));
        double place[2];
        pixel_of(p, place);
        double off = hypot(place[0] - pixel[0], place[1] - pixel[1]);
        if (off < least) {
            least = off;
            *at = p;
        }
    }
    return least;
}

/* 80 segments, 120 pixels, without surfaces. A segment is as long as 350 px at most, so samples are 0.1 px apart. */
static void the_segment_found_is_the_nearest_of_all_by_brute_force(void **state)
{
    (void)state;
    enum { N = 80, PIXELS = 120 };
    struct plan *plan = tracks_plan(false, N);
    uint64_t seed = 7;
    for (int i = 0; i < N; i++)
        add(plan, draw_point(&seed), draw_point(&seed), TRACK_NEUTRON_LOW, NAN);
    struct snapshot *snapshot = look(plan, NULL);
    const double half_width_px = snapshot->scene.tracks.width_px / 2, tolerance_px = 0.1;
    int n_found = 0, n_sure = 0;
    for (int k = 0; k < PIXELS; k++) {
        double pixel[2] = { SIDE_PX * (0.25 + draw(&seed) / 2), SIDE_PX * (0.25 + draw(&seed) / 2) }, px[N],
               least = INFINITY, second = INFINITY;
        struct vec3 at[N];
        for (int i = 0; i < N; i++) {
            px[i] = sampled_px(&plan->tracks.segments[i], pixel, &at[i]);
            double beside = fmax(0, px[i] - half_width_px);
            second = fmin(second, fmax(beside, least));
            least = fmin(least, beside);
        }
        struct pick_track_hit hit;
        bool is_found = pick_track(snapshot, pixel[0], pixel[1], &hit);
        if (least + half_width_px < PICK_TRACK_PX - tolerance_px ||
            least + half_width_px > PICK_TRACK_PX + tolerance_px)
            assert_int_equal(is_found, least + half_width_px < PICK_TRACK_PX);
        if (!is_found)
            continue;
        n_found++;
        assert_close(hit.distance_px, fmax(0, px[hit.segment] - half_width_px), tolerance_px);
        assert_true(hit.distance_px <= least + tolerance_px);
        double place[2];
        pixel_of(hit.point_lps_mm, place);
        assert_close(fmax(0, hypot(place[0] - pixel[0], place[1] - pixel[1]) - half_width_px), hit.distance_px, 1e-6);
        assert_close(hit.distance_mm, vec3_length(vec3_sub(hit.point_lps_mm, vec3(0, EYE_Y_MM, 0))), 1e-9);
        n_sure += second > least + tolerance_px;
    }
    assert_true(n_found > 40 && n_sure > 20);
    finish(plan, snapshot);
}

static void of_lines_that_cross_under_the_pixel_the_nearest_to_the_eye_is_taken(void **state)
{
    (void)state;
    struct plan *plan = tracks_plan(false, 3);
    add(plan, vec3(-30, 40, 0), vec3(30, 40, 0), TRACK_GAMMA_LOW, NAN);
    add(plan, vec3(0, -20, -30), vec3(0, -20, 30), TRACK_LOST, NAN);
    add(plan, vec3(-30, 10, -30), vec3(30, 10, 30), TRACK_GAMMA_HIGH, NAN);
    struct snapshot *snapshot = look(plan, NULL);
    struct pick_track_hit hit;
    assert_true(pick_track(snapshot, SIDE_PX / 2.0, SIDE_PX / 2.0, &hit));
    assert_int_equal(hit.segment, 1);
    assert_close(hit.point_lps_mm.y, -20, 1e-6);
    assert_close(hit.distance_mm, 480, 1e-6);
    assert_true(pick_at(snapshot, vec3(20, 40, 0.5), &hit)); /* half a millimetre is under half a pixel there */
    assert_int_equal(hit.segment, 0);
    finish(plan, snapshot);
}

/* The segment runs from 100 mm behind the eye to the origin; in the picture only its part in front of the eye counts.
 */
static void a_segment_that_begins_behind_the_eye_is_found_in_front_of_it(void **state)
{
    (void)state;
    struct plan *plan = tracks_plan(false, 1);
    add(plan, vec3(-50, EYE_Y_MM - 100, 0), vec3(50, 0, 0), TRACK_GAMMA_LOW, NAN);
    struct snapshot *snapshot = look(plan, NULL);
    struct pick_track_hit hit;
    /* at y = -100 the line has gone 5 / 6 of its way: x = -50 + 100 * 5 / 6 */
    const struct vec3 p = vec3(-50 + 500.0 / 6, -100, 0);
    assert_true(pick_at(snapshot, p, &hit));
    assert_close(vec3_length(vec3_sub(hit.point_lps_mm, p)), 0, 1e-4);
    assert_false(pick_at(snapshot, vec3(0, 0, 20), &hit));
    finish(plan, snapshot);
}

static void parallel(struct scene *scene, struct view *view)
{
    (void)scene;
    view->camera.projection = SCENE_PROJECTION_PARALLEL;
    view->camera.has_height_mm = true;
    view->camera.height_mm = SIDE_PX; /* 1 mm a pixel */
}

static void in_parallel_projection_a_millimetre_is_the_same_everywhere(void **state)
{
    (void)state;
    struct plan *plan = tracks_plan(false, 2);
    add(plan, vec3(-40, -60, 10), vec3(40, -60, 10), TRACK_GAMMA_LOW, NAN);
    add(plan, vec3(-40, 60, -10), vec3(40, 60, -10), TRACK_GAMMA_LOW, NAN);
    struct snapshot *snapshot = look(plan, parallel);
    struct pick_track_hit hit;
    assert_true(pick_track(snapshot, SIDE_PX / 2.0 + 25, SIDE_PX / 2.0 - 13, &hit));
    assert_int_equal(hit.segment, 0);
    assert_close(hit.distance_px, 3 - 0.75, 1e-6);
    assert_close(hit.point_lps_mm.x, 25, 1e-4);
    assert_true(pick_track(snapshot, SIDE_PX / 2.0 - 45, SIDE_PX / 2.0 + 10, &hit)); /* 5 mm beyond the end */
    assert_int_equal(hit.segment, 1);
    assert_close(hit.distance_px, 5 - 0.75, 1e-6);
    assert_false(pick_track(snapshot, SIDE_PX / 2.0 - 46.01, SIDE_PX / 2.0 + 10, &hit));
    finish(plan, snapshot);
}

static void only_lost(struct scene *scene, struct view *view)
{
    (void)view;
    struct scene_track_classes *classes = &scene->tracks.classes;
    *classes = (struct scene_track_classes){ .lost = true };
}
static void from_1_one(struct scene *scene, struct view *view)
{
    (void)view;
    scene->tracks.first = 1;
    scene->tracks.has_count = true;
    scene->tracks.count = 1;
}
static void below_1_mev(struct scene *scene, struct view *view)
{
    (void)view;
    scene->tracks.has_energy_high_mev = true;
    scene->tracks.energy_high_mev = 1;
}
static void above_1_mev(struct scene *scene, struct view *view)
{
    (void)view;
    scene->tracks.has_energy_low_mev = true;
    scene->tracks.energy_low_mev = 1;
}
static void invisible(struct scene *scene, struct view *view)
{
    (void)view;
    scene->tracks.visible = false;
}
static void axial(struct scene *scene, struct view *view)
{
    (void)scene;
    view->kind = SCENE_KIND_AXIAL;
}
static void beyond_the_end(struct scene *scene, struct view *view)
{
    (void)view;
    scene->tracks.first = 4;
    scene->tracks.has_count = true;
    scene->tracks.count = 2000000;
}

/* Four segments one behind the other, the first nearest to the eye; energies none, 2, 0.5, 1 MeV. */
static void what_the_scene_does_not_show_is_not_picked(void **state)
{
    (void)state;
    static const struct {
        void (*change)(struct scene *scene, struct view *view);
        int segment; /* -1: none */
        size_t n_shown;
    } cases[] = {
        { NULL, 0, 4 },        { only_lost, 2, 2 },  { from_1_one, 1, 1 }, { below_1_mev, 0, 3 },
        { above_1_mev, 0, 3 }, { invisible, -1, 4 }, { axial, -1, 4 },     { beyond_the_end, -1, 0 },
    };
    struct plan *plan = tracks_plan(false, 4);
    add(plan, vec3(-30, -60, 0), vec3(30, -60, 0), TRACK_GAMMA_LOW, NAN);
    add(plan, vec3(-30, -30, 0), vec3(30, -30, 0), TRACK_NEUTRON_HIGH, 2);
    add(plan, vec3(-30, 0, 0), vec3(30, 0, 0), TRACK_LOST, 0.5);
    add(plan, vec3(-30, 30, 0), vec3(30, 30, 0), TRACK_LOST, 1);
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        struct snapshot *snapshot = look(plan, cases[c].change);
        struct pick_track_hit hit;
        bool is_found = pick_track(snapshot, SIDE_PX / 2.0, SIDE_PX / 2.0, &hit);
        assert_int_equal(is_found ? (int)hit.segment : -1, cases[c].segment);
        struct tracks_shown shown = tracks_shown_of(&plan->tracks, &snapshot->scene.tracks);
        size_t n = 0;
        for (size_t i = shown.first; i < shown.end; i++)
            n += track_is_shown(&shown, &plan->tracks.segments[i]);
        assert_int_equal(n, cases[c].n_shown);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void cut_left(struct scene *scene, struct view *view)
{
    (void)view;
    scene->clip.sagittal_high.enabled = true; /* cuts off L > 0 */
    scene->clip.sagittal_high.position_mm = 0;
}
static void cut_left_but_not_tracks(struct scene *scene, struct view *view)
{
    cut_left(scene, view);
    scene->tracks.clipped = false;
}

static void what_a_clip_plane_cuts_off_is_not_picked(void **state)
{
    (void)state;
    struct plan *plan = tracks_plan(false, 1);
    add(plan, vec3(-60, 0, 0), vec3(60, 0, 0), TRACK_GAMMA_LOW, NAN);
    struct pick_track_hit hit;
    struct snapshot *snapshot = look(plan, cut_left);
    assert_true(pick_at(snapshot, vec3(-20, 0, 0), &hit));
    assert_false(pick_at(snapshot, vec3(20, 0, 0), &hit));
    assert_true(pick_at(snapshot, vec3(1, 0, 0), &hit)); /* beside the end that is left */
    assert_close(hit.point_lps_mm.x, 0, 1e-5);
    snapshot_unref(snapshot);
    snapshot = look(plan, cut_left_but_not_tracks);
    assert_true(pick_at(snapshot, vec3(20, 0, 0), &hit));
    finish(plan, snapshot);
}

static void translucent(struct scene *scene, struct view *view)
{
    (void)view;
    scene->regions[0].value.opacity = 0.4;
}
static void hide_ball(struct scene *scene, struct view *view)
{
    (void)view;
    scene->regions[0].value.visible = false;
}

/* One segment inside the ball, one before it, one behind; each crosses another line of sight. */
static void a_segment_behind_an_opaque_surface_is_hidden_and_one_behind_a_translucent_one_is_not(void **state)
{
    (void)state;
    struct plan *plan = tracks_plan(true, 4);
    add(plan, vec3(-5, 0, 20), vec3(5, 0, 20), TRACK_GAMMA_LOW, NAN);       /* inside */
    add(plan, vec3(-5, -70, -20), vec3(5, -70, -20), TRACK_GAMMA_LOW, NAN); /* before */
    add(plan, vec3(-5, 70, 0), vec3(5, 70, 0), TRACK_GAMMA_LOW, NAN);       /* behind */
    add(plan, vec3(70, 0, 0), vec3(40, 0, 0), TRACK_LOST, NAN);             /* half of it inside */
    struct pick_track_hit hit;
    struct snapshot *snapshot = look(plan, NULL);
    assert_false(pick_at(snapshot, vec3(0, 0, 20), &hit));
    assert_true(pick_at(snapshot, vec3(0, -70, -20), &hit));
    assert_int_equal(hit.segment, 1);
    assert_false(pick_at(snapshot, vec3(0, 70, 0), &hit));
    assert_true(pick_at(snapshot, vec3(66, 0, 0), &hit));
    assert_int_equal(hit.segment, 3);
    assert_false(pick_at(snapshot, vec3(45, 0, 0), &hit));
    snapshot_unref(snapshot);
    snapshot = look(plan, translucent);
    assert_true(pick_at(snapshot, vec3(0, 0, 20), &hit));
    assert_int_equal(hit.segment, 0);
    snapshot_unref(snapshot);
    snapshot = look(plan, hide_ball);
    assert_true(pick_at(snapshot, vec3(0, 70, 0), &hit));
    assert_int_equal(hit.segment, 2);
    finish(plan, snapshot);
}

static void show_beam(struct scene *scene, struct view *view)
{
    (void)view;
    scene->beam.looks = mem_new(sizeof *scene->beam.looks);
    scene->beam.looks[0] = (struct scene_beam_look_entry){ .id = "b", .value = { .visible = true } };
    scene->beam.n_looks = 1;
}

static void the_line_of_a_beam_hides_no_track(void **state)
{
    (void)state;
    struct plan *plan = tracks_plan(false, 1);
    add(plan, vec3(0, 0, -30), vec3(0, 0, 30), TRACK_GAMMA_LOW, NAN);
    plan->n_beams = 1;
    plan->beams[0] = (struct beam){
        .id = "b", .entry_lps_mm = vec3(-50, -60, 0), .target_lps_mm = vec3(50, -60, 0), .aperture_mm = NAN
    };
    struct snapshot *snapshot = look(plan, show_beam);
    struct pick_hit hits[PICK_MAX_HITS];
    double pixel[2];
    pixel_of(vec3(0, 0, 1), pixel);
    size_t n = snapshot_pick(snapshot, pixel[0], pixel[1], hits);
    assert_true(n > 0 &&
                hits[0].subject.kind == SUBJECT_BEAM); /* nearer to the eye, two pixels beside the track's point */
    struct pick_track_hit hit;
    assert_true(pick_track(snapshot, pixel[0], pixel[1], &hit));
    finish(plan, snapshot);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_segment_found_is_the_nearest_of_all_by_brute_force),
        cmocka_unit_test(of_lines_that_cross_under_the_pixel_the_nearest_to_the_eye_is_taken),
        cmocka_unit_test(a_segment_that_begins_behind_the_eye_is_found_in_front_of_it),
        cmocka_unit_test(in_parallel_projection_a_millimetre_is_the_same_everywhere),
        cmocka_unit_test(what_the_scene_does_not_show_is_not_picked),
        cmocka_unit_test(what_a_clip_plane_cuts_off_is_not_picked),
        cmocka_unit_test(a_segment_behind_an_opaque_surface_is_hidden_and_one_behind_a_translucent_one_is_not),
        cmocka_unit_test(the_line_of_a_beam_hides_no_track),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
