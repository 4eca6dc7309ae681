/* Cameras of beam's-eye views and planes across beams: pose, projection and ring, worked out by hand. */
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/golden_beams.h"
#include "tests/made_plan.h"

static double one_label(struct vec3 p)
{
    return p.x * 0 + 1;
}
static const struct made_region block[] = { { "block", -1, 0x808080 } };

/* The plan's box: 200 x 160 x 120 mm around (10, 20, 30). */
static const struct vec3 centre = { 10, 20, 30 }, half_mm = { 100, 80, 60 };

static struct plan *plan_with_beam(struct vec3 entry, struct vec3 target)
{
    const uint32_t size[3] = { 20, 16, 12 };
    struct grid grid = made_grid(20, 16, 12, made_affine(vec3(10, 0, 0), vec3(0, 10, 0), vec3(0, 0, 10), size, centre));
    struct plan *plan = made_plan(&grid, one_label, block, 1);
    plan->n_beams = 1;
    plan->beams[0] = (struct beam){ .id = "b", .entry_lps_mm = entry, .target_lps_mm = target, .aperture_mm = 100 };
    return plan;
}

static struct vec3 along(struct vec3 from, struct vec3 direction, double mm)
{
    return vec3_add(from, vec3_scale(direction, mm));
}

static void expect_vec3(struct vec3 value, struct vec3 expected, double tolerance)
{
    assert_point(value, expected.x, expected.y, expected.z, tolerance);
}

static double support(struct vec3 v, struct vec3 from)
{
    return golden_support(centre, half_mm, v, from);
}

static struct camera camera_in(struct plan *plan, struct scene scene, struct view view)
{
    struct camera camera;
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    camera_resolve(snapshot, &camera);
    snapshot_unref(snapshot);
    return camera;
}

static struct scene scene_of(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    return scene;
}

static struct view beam_view(int width_px, int height_px)
{
    struct view view = view_default;
    view.kind = SCENE_KIND_BEAM;
    view.size_px[0] = width_px;
    view.size_px[1] = height_px;
    return view;
}

/* ---- twenty beams ----------------------------------------------------------------------------------------------- */

/* Near and far: the box with a hundredth of its depth, at least 1 mm, before and behind; nothing behind an eye that is
 * given. */
static void depths_of(bool is_parallel, bool is_given, struct vec3 d, struct vec3 eye, double *near, double *far)
{
    double low = -support(vec3_scale(d, -1), eye), high = support(d, eye), slack = fmax(1, 0.01 * (high - low));
    *far = high + slack;
    *near = low - slack;
    if (is_parallel && is_given) {
        *near = fmax(*near, -0.02);
        *far = fmax(*far, *near + 10);
    } else if (!is_parallel) {
        *far = fmax(*far, 10);
        *near = fmax(*near, *far / 2000);
    }
}

static void expect_golden(const struct golden_beam *g)
{
    struct vec3 d = vec3_scale(g->d, 1 / g->n), right = vec3_scale(g->right, 1 / g->n_right),
                up = vec3_scale(g->up, 1 / g->n_up);
    bool has_ring = !isnan(g->ring_mm);
    struct vec3 entry = along(g->target, d, -g->length_mm);
    struct plan *plan =
        g->is_draft ? plan_with_beam(vec3(1, 2, 3), vec3(-50, 70, 9)) : plan_with_beam(entry, g->target);
    struct scene scene = scene_of(plan);
    if (g->is_draft) {
        scene.beam.draft.enabled = true;
        scene.beam.draft.line.entry_mm = entry;
        scene.beam.draft.line.target_mm = g->target;
    }
    struct view view = beam_view(g->width_px, g->height_px);
    view.camera.fov_deg = g->fov_deg;
    view.camera.has_height_mm = !isnan(g->height_mm);
    view.camera.height_mm = view.camera.has_height_mm ? g->height_mm : 0;
    view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_up = true; /* count for nothing */
    view.camera.position_mm = vec3(300, 1, 2);
    view.camera.target_mm = vec3(3, 4, 5);
    view.camera.up = vec3(0, 1, 1);
    view.beam.has_aperture_mm = has_ring;
    view.beam.aperture_mm = has_ring ? g->ring_mm : 0;
    view.beam.has_along_mm = !isnan(g->eye_mm);
    view.beam.along_mm = view.beam.has_along_mm ? g->eye_mm : 0;
    struct camera camera = camera_in(plan, scene, view);

    /* a line of 13 um, in coordinates of 30 mm that are rounded to 4e-15 mm, has a direction within 1e-12 */
    expect_vec3(camera.forward, d, 2e-12);
    expect_vec3(camera.right, right, 1e-11);
    expect_vec3(camera.up, up, 1e-11);
    expect_vec3(camera.target_lps_mm, g->target, 1e-9);
    assert_int_equal(camera.is_parallel, has_ring);
    double back_mm = isnan(g->eye_mm) ? golden_home_mm(g, centre, half_mm, d, right, up) : g->length_mm - g->eye_mm;
    struct vec3 eye = along(g->target, d, -back_mm);
    expect_vec3(camera.eye_lps_mm, eye, 1e-8);

    double near, far, smaller = fmin(g->width_px, g->height_px);
    depths_of(has_ring, !isnan(g->eye_mm), d, eye, &near, &far);
    if (g->is_draft) { /* the two beams that are drawn reach further than the plan's box */
        assert_true(camera.near_mm <= near + 1e-7 && camera.far_mm >= far - 1e-7);
        near = camera.near_mm;
        far = camera.far_mm;
    }
    assert_close(camera.near_mm, near, 1e-7);
    assert_close(camera.far_mm, far, 1e-7);
    double half = has_ring ? g->height_mm / 2 : tan(g->fov_deg / 2 * MATH_PI / 180);
    for (int i = 0; i < 6; i++) {
        double r = 7 * i - 19, u = 31 - 11 * i, depth = 20 + 35 * i; /* right, up and before the eye, mm */
        struct vec3 p = along(along(along(eye, right, r), up, u), d, depth);
        struct vec3 clip = mat4_project(&camera.clip_from_lps_mm, p);
        double scale = half * (has_ring ? 1 : depth);
        assert_close(clip.x, r / (scale * g->width_px / smaller), 1e-8);
        assert_close(clip.y, u / (scale * g->height_px / smaller), 1e-8);
        assert_close(clip.z,
                     has_ring ? (2 * depth - near - far) / (far - near)
                              : (far + near - 2 * far * near / depth) / (far - near),
                     1e-8);
    }
    for (int i = 0; has_ring && i < 24; i++) { /* at all depths, in all directions, the ring has one radius */
        double turn = 2 * MATH_PI * i / 24, r = g->ring_mm / 2, depth = 60.0 * (i % 5);
        struct vec3 p = along(along(along(eye, right, r * cos(turn)), up, r * sin(turn)), d, depth);
        struct vec3 clip = mat4_project(&camera.clip_from_lps_mm, p);
        assert_close(hypot(clip.x * g->width_px / 2, clip.y * g->height_px / 2), g->ring_px, 1e-6);
    }
    assert_close(camera.pixels_per_mm, has_ring ? 2 * g->ring_px / g->ring_mm : 0, 1e-9);
    plan_and_derived_destroy(plan);
}

static void a_beams_eye_looks_along_its_beam_with_the_head_up_and_the_ring_in_its_true_size(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_BEAMS; i++) {
        print_message("beam %d: %s\n", i + 1, golden_beams[i].what);
        expect_golden(&golden_beams[i]);
    }
}

static void without_a_height_the_parallel_picture_is_as_large_as_perspective_at_the_target(void **state)
{
    (void)state;
    struct plan *plan = plan_with_beam(vec3(10, -120, 30), vec3(10, 40, 30));
    /* seen from the front: half the box across is 100 mm at its front, 140 mm before the target */
    double slope = tan(15 * MATH_PI / 180), back_mm = 1.08 * 100 / slope + 100;
    struct view view = beam_view(800, 600);
    struct camera perspective = camera_in(plan, scene_of(plan), view);
    expect_vec3(perspective.eye_lps_mm, vec3(10, 40 - back_mm, 30), 1e-9);
    view.beam.has_aperture_mm = true;
    view.beam.aperture_mm = 70;
    struct camera parallel = camera_in(plan, scene_of(plan), view);
    assert_close(parallel.pixels_per_mm, 600 / (2 * slope * back_mm), 1e-9);
    for (int i = -1; i <= 1; i++) {
        struct vec3 p = vec3(10 + 50 * i, 40, 30 - 20 * i), a = mat4_project(&perspective.clip_from_lps_mm, p),
                    b = mat4_project(&parallel.clip_from_lps_mm, p);
        assert_close(a.x, b.x, 1e-9);
        assert_close(a.y, b.y, 1e-9);
    }
    plan_and_derived_destroy(plan);
}

/* ---- sliding and turning ---------------------------------------------------------------------------------------- */

static void sliding_along_the_beam_turns_nothing_and_changes_no_parallel_scale(void **state)
{
    (void)state;
    struct vec3 d = vec3(-24 / 41.0, 32 / 41.0, 9 / 41.0), target = vec3(12, 5, -8);
    struct plan *plan = plan_with_beam(along(target, d, -60), target);
    struct view view = beam_view(640, 480);
    view.beam.has_aperture_mm = view.beam.has_along_mm = true;
    view.beam.aperture_mm = 50;
    struct camera first = camera_in(plan, scene_of(plan), view);
    for (double mm = -400; mm <= 600; mm += 12.5) {
        view.beam.along_mm = mm;
        struct camera camera = camera_in(plan, scene_of(plan), view);
        expect_vec3(camera.right, first.right, 0);
        expect_vec3(camera.up, first.up, 0);
        expect_vec3(camera.forward, d, 1e-12); /* also beyond the target: it never turns round */
        expect_vec3(camera.eye_lps_mm, along(target, d, mm - 60), 1e-9);
        assert_close(camera.pixels_per_mm, first.pixels_per_mm, 0);
        assert_close(camera.right.z, 0, 1e-15); /* no roll: the horizon of the patient's axis stays level */
    }
    plan_and_derived_destroy(plan);
}

/* 3 degrees and more from the axis, where the picture turns by at most 1 / tan 3 times what the beam does. */
static void a_beam_that_turns_a_little_turns_its_picture_a_little(void **state)
{
    (void)state;
    for (double polar = 3; polar <= 177; polar += 6)
        for (double turn = 0; turn < 360; turn += 7) {
            const double step_deg = 0.01, rad = MATH_PI / 180;
            struct vec3 ups[2];
            for (int i = 0; i < 2; i++) {
                double p = (polar + step_deg * i) * rad, t = (turn + step_deg * i) * rad;
                struct beam_shown beam = { .direction = vec3(sin(p) * cos(t), sin(p) * sin(t), cos(p)) };
                ups[i] = beam_plane(&beam, 0).up;
            }
            double most = 1.1 * step_deg * rad * (1 + 1 / tan(3 * rad));
            assert_true(vec3_length(vec3_sub(ups[0], ups[1])) <= most);
        }
}

/* ---- before and behind the eye ---------------------------------------------------------------------------------- */

static void what_lies_at_the_eye_is_in_a_parallel_picture_and_what_lies_behind_is_in_none(void **state)
{
    (void)state;
    struct vec3 d = vec3(3 / 13.0, -4 / 13.0, -12 / 13.0);
    for (int is_parallel = 0; is_parallel < 2; is_parallel++)
        for (double mm = -500; mm <= 500; mm += 20) {
            struct plan *plan = plan_with_beam(along(centre, d, -100), centre);
            struct view view = beam_view(640, 480);
            view.beam.has_along_mm = true;
            view.beam.along_mm = mm;
            view.camera.projection = is_parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
            struct camera camera = camera_in(plan, scene_of(plan), view);
            struct vec3 behind = along(camera.eye_lps_mm, d, -0.1), at = camera.eye_lps_mm;
            if (is_parallel) {
                double reach = support(d, camera.eye_lps_mm);
                struct vec3 clip = mat4_project(&camera.clip_from_lps_mm, behind);
                assert_true(clip.z < -1);
                clip = mat4_project(&camera.clip_from_lps_mm, at);
                assert_true(reach < -2 || -support(vec3_scale(d, -1), camera.eye_lps_mm) > 3 ||
                            (clip.z > -1 && clip.z < 1));
            } else
                assert_true(camera.near_mm > 0);
            assert_true(camera.far_mm <= 2000.001 * camera.near_mm || camera.is_parallel);
            assert_true(camera.far_mm >= camera.near_mm + 9);
            plan_and_derived_destroy(plan);
        }
}

/* An angle of 120 degrees has its home close to the plan, and inside the image around a plan of few regions. */
static void from_its_home_a_parallel_picture_holds_the_whole_plan_and_its_image(void **state)
{
    (void)state;
    struct plan *plan = plan_with_beam(vec3(10, -120, 30), vec3(10, 40, 30));
    const uint32_t size[3] = { 30, 30, 30 };
    struct grid grid = made_grid(30, 30, 30, made_affine(vec3(10, 0, 0), vec3(0, 12, 0), vec3(0, 0, 10), size, centre));
    made_plan_add_image(plan, &grid, VOXEL_U8, one_label);
    struct view view = beam_view(640, 480);
    view.camera.fov_deg = 120;
    view.camera.projection = SCENE_PROJECTION_PARALLEL;
    struct camera camera = camera_in(plan, scene_of(plan), view);
    assert_true(camera.eye_lps_mm.y > 20 - 180); /* the eye is inside the image */
    for (int side = -1; side <= 1; side += 2)
        assert_true(fabs(mat4_project(&camera.clip_from_lps_mm, vec3(10, 20 + side * 180, 30)).z) < 1);
    plan_and_derived_destroy(plan);
}

/* ---- no beam ---------------------------------------------------------------------------------------------------- */

static void expect_same(const struct camera *a, const struct camera *b)
{
    for (int i = 0; i < 16; i++)
        assert_close(a->clip_from_lps_mm.m[i], b->clip_from_lps_mm.m[i], 0);
}

static void without_a_beam_the_view_is_3d_and_the_slice_is_axial(void **state)
{
    (void)state;
    struct plan *plan = plan_with_beam(vec3(0, -90, 0), vec3(0, 0, 0));
    plan->n_beams = 0;
    for (int is_short = 0; is_short < 2; is_short++) {
        struct scene scene = scene_of(plan);
        scene.beam.draft.enabled = is_short; /* a draft of no length is none */
        scene.beam.draft.line.entry_mm = scene.beam.draft.line.target_mm = vec3(5, 6, 7);
        scene.image.slices.axial.position_mm = 12;
        scene.beam.slice.visible = true;
        scene.clip.beam.enabled = true;
        struct view view = beam_view(640, 480);
        view.beam.has_aperture_mm = true;
        view.beam.aperture_mm = 50;
        struct camera camera = camera_in(plan, scene, view);
        scene = scene_of(plan);
        view.kind = SCENE_KIND_3D;
        struct camera space = camera_in(plan, scene, view);
        expect_same(&camera, &space);
        assert_false(camera.is_parallel);

        scene = scene_of(plan);
        scene.image.slices.axial.position_mm = 12;
        view.kind = SCENE_KIND_BEAM_SLICE;
        struct plane plane = plane_of_view(plan, &scene, NULL, &view), axial = plane_of_kind(SCENE_KIND_AXIAL, 12);
        assert_true(plane_equal(&plane, &axial));
        struct camera pane = camera_in(plan, scene, view);
        expect_vec3(pane.forward, vec3(0, 0, 1), 0);
    }
    plan_and_derived_destroy(plan);
}

static void a_draft_of_no_length_leaves_the_planned_beam(void **state)
{
    (void)state;
    struct plan *plan = plan_with_beam(vec3(0, -90, 0), vec3(0, 10, 0));
    struct scene scene = scene_of(plan);
    scene.beam.draft.enabled = true;
    scene.beam.draft.line.entry_mm = vec3(5, 6, 7);
    scene.beam.draft.line.target_mm = vec3(5, 6, 7.0009); /* under 0.001 mm */
    struct beam_shown shown;
    assert_true(beam_shown_of(plan, &scene, "", NULL, &shown));
    assert_false(shown.is_draft);
    assert_close(shown.length_mm, 100, 1e-12);
    struct camera camera = camera_in(plan, scene, beam_view(64, 64));
    expect_vec3(camera.forward, vec3(0, 1, 0), 0);
    plan_and_derived_destroy(plan);
}

/* ---- the draft -------------------------------------------------------------------------------------------------- */

static void to_compare_the_planned_beam_is_shown_while_the_draft_is_kept_and_a_draft_alone_stays(void **state)
{
    (void)state;
    struct plan *plan = plan_with_beam(vec3(0, -90, 0), vec3(0, 10, 0));
    for (int has_planned = 1; has_planned >= 0; has_planned--) {
        plan->n_beams = (size_t)has_planned;
        struct scene scene = scene_of(plan);
        scene.beam.draft.enabled = scene.beam.draft.shows_planned = true;
        scene.beam.draft.line.entry_mm = vec3(5, 6, 107);
        scene.beam.draft.line.target_mm = vec3(5, 6, 7);
        struct beam_shown shown;
        assert_true(beam_shown_of(plan, &scene, "", NULL, &shown));
        assert_int_equal(shown.is_draft, !has_planned);
        struct camera camera = camera_in(plan, scene, beam_view(64, 64));
        expect_vec3(camera.forward, has_planned ? vec3(0, 1, 0) : vec3(0, 0, -1), 0);
    }
    plan_and_derived_destroy(plan);
}

static void slice_clip_plane_and_eye_follow_the_draft_and_a_named_clip_beam_stays(void **state)
{
    (void)state;
    struct plan *plan = plan_with_beam(vec3(0, -90, 0), vec3(0, 10, 0));
    struct vec3 entry = vec3(-60, 10, 20), d = vec3(12 / 25.0, -9 / 25.0, 20 / 25.0);
    for (int is_named = 0; is_named < 2; is_named++) {
        struct scene scene = scene_of(plan);
        scene.beam.draft.enabled = scene.beam.slice.visible = scene.clip.beam.enabled = true;
        scene.image.slices.axial.visible = false;
        scene.beam.draft.line.entry_mm = entry;
        scene.beam.draft.line.target_mm = along(entry, d, 80);
        scene.beam.slice.along_mm = 55;
        scene.clip.beam.along_mm = 31;
        if (is_named)
            (void)snprintf(scene.clip.beam.id, sizeof scene.clip.beam.id, "b");
        struct view view = view_default;
        struct error err = { 0 };
        char field[128];
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        assert_string_equal(err.text, "");
        assert_true(snapshot->has_beam && snapshot->beam.is_draft);
        assert_int_equal(snapshot->n_slices, 1);
        expect_vec3(snapshot->slices[0].origin_lps_mm, along(entry, d, 55), 1e-12);
        expect_vec3(snapshot->slices[0].normal, vec3_scale(d, -1), 1e-15);
        assert_int_equal(snapshot->n_clips, 1);
        expect_vec3(snapshot->clips[0].plane.normal, is_named ? vec3(0, -1, 0) : vec3_scale(d, -1), 1e-15);
        expect_vec3(snapshot->clips[0].plane.origin_lps_mm, is_named ? vec3(0, -59, 0) : along(entry, d, 31), 1e-12);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_beams_eye_looks_along_its_beam_with_the_head_up_and_the_ring_in_its_true_size),
        cmocka_unit_test(without_a_height_the_parallel_picture_is_as_large_as_perspective_at_the_target),
        cmocka_unit_test(sliding_along_the_beam_turns_nothing_and_changes_no_parallel_scale),
        cmocka_unit_test(a_beam_that_turns_a_little_turns_its_picture_a_little),
        cmocka_unit_test(what_lies_at_the_eye_is_in_a_parallel_picture_and_what_lies_behind_is_in_none),
        cmocka_unit_test(from_its_home_a_parallel_picture_holds_the_whole_plan_and_its_image),
        cmocka_unit_test(without_a_beam_the_view_is_3d_and_the_slice_is_axial),
        cmocka_unit_test(a_draft_of_no_length_leaves_the_planned_beam),
        cmocka_unit_test(to_compare_the_planned_beam_is_shown_while_the_draft_is_kept_and_a_draft_alone_stays),
        cmocka_unit_test(slice_clip_plane_and_eye_follow_the_draft_and_a_named_clip_beam_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
