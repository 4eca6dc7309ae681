/* Picking in pictures along a beam: what lies before the eye, in the pixel that shows it. */
#include "core/pick/pick.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* Two balls of 8 mm on the beam's axis, 40 mm apart; the second one is "far". */
static const struct vec3 near_mm = { 3, -2, 20 }, far_mm = { 3, -2, -20 };
static double balls(struct vec3 p)
{
    return vec3_length(vec3_sub(p, near_mm)) < 8 ? 1 : vec3_length(vec3_sub(p, far_mm)) < 8 ? 2 : 0;
}
static const struct made_region two[] = { { "near", -1, 0xff0000 }, { "far", -1, 0x00ff00 } };

/* Straight down the patient's axis, the entry 30 mm above the first ball's middle, the target in the second's. */
static struct plan *two_balls(void)
{
    struct grid grid = made_cube_grid(64);
    struct plan *plan = made_plan(&grid, balls, two, 2);
    made_plan_add_image(plan, &grid, VOXEL_U8, balls);
    plan->n_beams = 1;
    plan->beams[0] =
        (struct beam){ .id = "b", .entry_lps_mm = { 3, -2, 50 }, .target_lps_mm = { 3, -2, -20 }, .aperture_mm = NAN };
    return plan;
}

static size_t pick(struct plan *plan, struct scene scene, struct view view, double px, double py,
                   struct pick_hit hits[PICK_MAX_HITS])
{
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    size_t n = snapshot_pick(snapshot, px, py, hits);
    snapshot_unref(snapshot);
    return n;
}

static struct view view_of(enum scene_kind kind, bool is_parallel, double eye_mm)
{
    struct view view = view_default;
    view.kind = kind;
    view.size_px[0] = view.size_px[1] = 400;
    view.camera.projection = is_parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
    view.camera.has_height_mm = true;
    view.camera.height_mm = 100; /* 4 px to the mm */
    view.beam.has_along_mm = true;
    view.beam.along_mm = eye_mm;
    return view;
}

static bool is_hit(const struct pick_hit *hits, size_t n, size_t region)
{
    for (size_t i = 0; i < n; i++)
        if (hits[i].subject.kind == SUBJECT_REGION && hits[i].subject.index == region)
            return true;
    return false;
}

static struct scene scene_of(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    scene.image.slices.axial.visible = false;
    return scene;
}

static void only_what_lies_before_the_eye_is_hit(void **state)
{
    (void)state;
    struct plan *plan = two_balls();
    struct pick_hit hits[PICK_MAX_HITS];
    for (int is_parallel = 0; is_parallel < 2; is_parallel++) {
        size_t n = pick(plan, scene_of(plan), view_of(SCENE_KIND_BEAM, is_parallel, 5), 200, 200, hits);
        assert_true(is_hit(hits, n, 0) && is_hit(hits, n, 1));
        assert_int_equal(hits[0].subject.index, 0);
        assert_point(hits[0].point_lps_mm, 3, -2, 28, 1); /* univels of 1 mm */
        assert_close(hits[0].distance_mm, 17, 1);         /* from S 45 */
        n = pick(plan, scene_of(plan), view_of(SCENE_KIND_BEAM, is_parallel, 45), 200, 200, hits);
        assert_true(!is_hit(hits, n, 0) && is_hit(hits, n, 1));
        assert_point(hits[0].point_lps_mm, 3, -2, -12, 1);
        n = pick(plan, scene_of(plan), view_of(SCENE_KIND_BEAM, is_parallel, 90), 200, 200, hits);
        assert_int_equal(n, 0);
    }
    plan_and_derived_destroy(plan);
}

/* Seen from above with the face up, the patient's right is to the right: 5 mm towards R, 4 mm towards P of the axis. */
static void the_slice_is_hit_at_the_eye_and_as_a_pane(void **state)
{
    (void)state;
    struct plan *plan = two_balls();
    struct pick_hit hits[PICK_MAX_HITS];
    for (int is_pane = 0; is_pane < 2; is_pane++) {
        struct scene scene = scene_of(plan);
        scene.beam.slice.visible = true;
        scene.beam.slice.along_mm = 33; /* S 17 */
        struct view view = view_of(is_pane ? SCENE_KIND_BEAM_SLICE : SCENE_KIND_BEAM, true, 33);
        view.camera.has_target_mm = is_pane;
        view.camera.target_mm = vec3(3, -2, 99);
        size_t n = pick(plan, scene, view, 200 + 4 * 5, 200 + 4 * 4, hits);
        assert_true(n > 0 && (!is_pane || is_hit(hits, n, 0))); /* the slice cuts the ball within 7.4 mm of the axis */
        bool has_image = false;
        for (size_t i = 0; i < n; i++)
            if (hits[i].subject.kind == SUBJECT_IMAGE) {
                has_image = true;
                assert_point(hits[i].point_lps_mm, -2, 2, 17, 1e-6);
            }
        assert_true(has_image);
    }
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_what_lies_before_the_eye_is_hit),
        cmocka_unit_test(the_slice_is_hit_at_the_eye_and_as_a_pane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
