/* Which beams a scene draws, how far they reach, and the outlines of their openings. */
#include "core/scene/beams_drawn.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double everywhere(struct vec3 p)
{
    return 1 + 0 * p.x;
}
static const struct made_region one[] = { { "body", -1, 0x804020 } };

/* A cube of 100 mm around the origin: its diagonal is 173.205 mm. */
static struct plan *cube_plan(void)
{
    const uint32_t size[3] = { 10, 10, 10 };
    struct affine map = made_affine(vec3(10, 0, 0), vec3(0, 10, 0), vec3(0, 0, 10), size, vec3(0, 0, 0));
    struct grid grid = made_grid(10, 10, 10, map);
    return made_plan(&grid, everywhere, one, 1);
}
#define DIAGONAL (100 * sqrt(3))

static struct beam *add_beam(struct plan *plan, const char *id, struct vec3 entry, struct vec3 target, double aperture)
{
    struct beam *beam = &plan->beams[plan->n_beams++];
    snprintf(beam->id, sizeof beam->id, "%s", id);
    beam->entry_lps_mm = entry;
    beam->target_lps_mm = target;
    beam->aperture_mm = aperture;
    return beam;
}

static void look_at(struct scene *scene, const char *id, bool is_visible)
{
    struct scene_beam_look_entry *grown = realloc(scene->beam.looks, (scene->beam.n_looks + 1) * sizeof *grown);
    assert_non_null(grown);
    scene->beam.looks = grown;
    struct scene_beam_look_entry *entry = &scene->beam.looks[scene->beam.n_looks++];
    snprintf(entry->id, sizeof entry->id, "%s", id);
    entry->value = scene_beam_look_default;
    entry->value.visible = is_visible;
    entry->value.color_rgb = 0x123456;
}

static void draft(struct scene *scene, struct vec3 entry, struct vec3 target)
{
    scene->beam.draft.enabled = true;
    scene->beam.draft.line.entry_mm = entry;
    scene->beam.draft.line.target_mm = target;
}

static void only_visible_beams_are_drawn(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    struct scene scene = scene_default;
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    add_beam(plan, "a", vec3(0, -200, 0), vec3(0, 0, 0), 80);
    add_beam(plan, "b", vec3(-200, 0, 0), vec3(0, 0, 0), NAN);
    assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 0);
    struct box3 box = beams_box(plan, &scene, NULL);
    assert_true(box3_is_empty(&box));
    look_at(&scene, "b", true);
    look_at(&scene, "a", false);
    assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 1);
    assert_string_equal(subject_id(plan, drawn[0].subject), "b");
    assert_int_equal(drawn[0].color_rgb, 0x123456);
    assert_false(drawn[0].has_opening); /* its aperture is not known */
    scene_finish(&scene);
    plan_destroy(plan);
}

static void a_draft_is_drawn_with_its_planned_beam_grey_beside_it(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    struct scene scene = scene_default;
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    add_beam(plan, "a", vec3(0, -200, 0), vec3(0, 0, 0), 80);
    draft(&scene, vec3(0, 0, 120), vec3(0, 0, 10)); /* no look: both are drawn all the same */
    assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 2);
    assert_true(drawn[0].is_beside_draft && !drawn[0].is_chosen && !drawn[0].shown.is_draft);
    assert_true(drawn[1].is_chosen && drawn[1].shown.is_draft && !drawn[1].is_beside_draft);
    assert_int_equal(drawn[1].subject.key, 1);
    assert_int_equal(drawn[1].color_rgb, 0xf4f6f8);
    assert_int_not_equal(drawn[0].color_rgb, drawn[1].color_rgb);
    assert_close(drawn[1].shown.aperture_mm, 80, 1e-12); /* that of the planned beam */
    scene.beam.draft.line.target_mm = scene.beam.draft.line.entry_mm;
    assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 0); /* a draft without a length is none */
    scene_finish(&scene);
    plan_destroy(plan);
}

/* Distances from the entry: the cube's near face is 50 mm before its middle, the far one 50 mm behind it. */
static void lines_begin_before_the_box_and_end_behind_it(void **state)
{
    (void)state;
    const struct {
        double entry_y, target_y, first, mark, last, opening_last;
    } cases[] = {
        /* an entry before the patient: the line has a shaft of 1.5 times 3 % of the diagonal for its arrow head */
        { -100, 0, -0.045 * DIAGONAL, 0, 150 + 0.1 * DIAGONAL, 150 },
        /* an entry inside: the line comes from a tenth of the diagonal before the near face */
        { -20, 30, -30 - 0.1 * DIAGONAL, 0, 70 + 0.1 * DIAGONAL, 70 },
        /* a source far away: the line begins half a diagonal before the near face, a mark there */
        { -1000, 0, 950 - 0.5 * DIAGONAL - 0.045 * DIAGONAL, 950 - 0.5 * DIAGONAL, 1050 + 0.1 * DIAGONAL, 1050 },
        /* a target behind the patient is reached */
        { -100, 70, -0.045 * DIAGONAL, 0, 170 + 0.1 * DIAGONAL, 170 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct plan *plan = cube_plan();
        struct scene scene = scene_default;
        struct beam_drawn drawn[BEAMS_DRAWN_MAX];
        add_beam(plan, "a", vec3(0, cases[i].entry_y, 0), vec3(0, cases[i].target_y, 0), 80);
        look_at(&scene, "a", true);
        assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 1);
        assert_close(drawn[0].first_mm, cases[i].first, 1e-9);
        assert_close(drawn[0].mark_mm, cases[i].mark, 1e-9);
        assert_close(drawn[0].last_mm, cases[i].last, 1e-9);
        assert_close(drawn[0].opening_first_mm, cases[i].mark, 1e-9);
        assert_close(drawn[0].opening_last_mm, cases[i].opening_last, 1e-9);
        struct vec3 label = beam_label_lps_mm(&drawn[0]);
        assert_close(label.y, cases[i].entry_y + cases[i].first, 1e-9);
        struct box3 box = beams_box(plan, &scene, NULL);
        assert_close(box.low.y, cases[i].entry_y + cases[i].first, 1e-9);
        assert_close(box.high.y, cases[i].entry_y + cases[i].last, 1e-9);
        assert_close(box.low.x, -40, 1e-9); /* half the aperture */
        assert_close(box.high.z, 40, 1e-9);
        scene_finish(&scene);
        plan_destroy(plan);
    }
}

static void a_line_that_passes_the_plan_far_away_is_not_drawn(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    struct scene scene = scene_default;
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    add_beam(plan, "near", vec3(2 * DIAGONAL - 1, -100, 0), vec3(2 * DIAGONAL - 1, 0, 0), 80);
    add_beam(plan, "far", vec3(2 * DIAGONAL + 1, -100, 0), vec3(2 * DIAGONAL + 1, 0, 0), 80);
    look_at(&scene, "near", true);
    look_at(&scene, "far", true);
    assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 1);
    assert_string_equal(subject_id(plan, drawn[0].subject), "near");
    scene_finish(&scene);
    plan_destroy(plan);
}

static void a_round_opening_is_a_circle_and_a_cylinder(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    add_beam(plan, "a", vec3(30, -100, 20), vec3(5, 10, -5), 64);
    struct beam_shown shown = beam_planned(plan, 0);
    struct beam_opening opening;
    assert_true(beam_opening_of(plan, &shown, &opening));
    assert_true(opening.n >= 64 && opening.is_round && !opening.is_from_source);
    for (size_t i = 0; i < opening.n; i++)
        for (double along = -20; along <= 220; along += 60) {
            struct vec3 p = vec3_sub(beam_opening_point(&shown, &opening, i, along), shown.entry_lps_mm);
            double t = vec3_dot(p, shown.direction);
            assert_close(t, along, 1e-9);
            assert_close(vec3_length(vec3_sub(p, vec3_scale(shown.direction, t))), 32, 1e-9);
        }
    plan_destroy(plan);
}

/* The beam comes from above, gantry at 0: the collimator's x runs to the patient's left, its y to the head. */
static void an_opening_of_jaws_widens_from_the_source_through_the_isocentre(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    struct beam *beam = add_beam(plan, "a", vec3(0, -1000, 0), vec3(0, 0, 0), NAN);
    beam->has_delivery = true;
    beam->delivery.opening_x_mm[0] = -20;
    beam->delivery.opening_x_mm[1] = 30;
    beam->delivery.opening_y_mm[0] = -10;
    beam->delivery.opening_y_mm[1] = 40;
    beam->delivery.collimator_x_lps = vec3(1, 0, 0);
    beam->delivery.collimator_y_lps = vec3(0, 0, 1);
    const double corners[4][2] = { { -20, -10 }, { 30, -10 }, { 30, 40 }, { -20, 40 } };
    struct beam_shown shown = beam_planned(plan, 0);
    struct beam_opening opening;
    assert_true(beam_opening_of(plan, &shown, &opening));
    assert_true(opening.n == 4 && opening.is_from_source);
    for (size_t i = 0; i < 4; i++)
        for (double along = 900; along <= 1200; along += 100) { /* at 1000 mm, the isocentre, its own size */
            struct vec3 p = beam_opening_point(&shown, &opening, i, along);
            assert_close(p.x, corners[i][0] * along / 1000, 1e-9);
            assert_close(p.y, along - 1000, 1e-9);
            assert_close(p.z, corners[i][1] * along / 1000, 1e-9);
        }
    /* a draft takes the outline along: from the feet, its plane's right is the patient's left, up is anterior */
    struct scene scene = scene_default;
    draft(&scene, vec3(0, 0, -500), vec3(0, 0, 0));
    assert_true(beam_shown_of(plan, &scene, "", NULL, &shown) && shown.is_draft);
    assert_true(beam_opening_of(plan, &shown, &opening));
    struct plane planned = beam_plane(&(struct beam_shown){ .direction = { 0, 1, 0 } }, 0),
                 here = beam_plane(&shown, 0);
    for (size_t i = 0; i < 4; i++) {
        struct vec3 p = opening.points_lps_mm[i], corner = vec3(corners[i][0], 0, corners[i][1]);
        assert_close(vec3_dot(p, here.right), vec3_dot(corner, planned.right), 1e-9);
        assert_close(vec3_dot(p, here.up), vec3_dot(corner, planned.up), 1e-9);
        assert_close(p.z, 0, 1e-9);
    }
    plan_destroy(plan);
}

/* Two openings apart, between leaves; gantry at 90 degrees: the beam runs to the patient's right. */
static void every_polygon_of_an_outline_is_closed_in_itself(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    struct beam *beam = add_beam(plan, "a", vec3(1000, 0, 0), vec3(0, 0, 0), NAN);
    const float points[7][2] = {
        { -30, 5 }, { -20, 5 }, { -25, 15 }, { 10, -10 }, { 30, -10 }, { 30, 10 }, { 10, 10 }
    };
    const size_t next[7] = { 1, 2, 0, 4, 5, 6, 3 };
    struct beam_outline *outline = &beam->delivery.outline;
    beam->has_delivery = true;
    beam->delivery.collimator_x_lps = vec3(0, 1, 0);
    beam->delivery.collimator_y_lps = vec3(0, 0, 1);
    outline->kind = BEAM_OUTLINE_LEAVES;
    outline->n_polygons = 2;
    outline->ends[0] = 3;
    outline->ends[1] = 7;
    memcpy(outline->points_mm, points, sizeof points);
    struct beam_shown shown = beam_planned(plan, 0);
    struct beam_opening opening;
    assert_true(beam_opening_of(plan, &shown, &opening));
    assert_true(opening.n == 7 && opening.is_from_source && !opening.is_round);
    for (size_t i = 0; i < 7; i++) {
        struct vec3 p = beam_opening_point(&shown, &opening, i, 1050); /* 50 mm behind the isocentre */
        assert_close(p.x, -50, 1e-9);
        assert_close(p.y, points[i][0] * 1.05, 1e-5); /* outlines have single precision */
        assert_close(p.z, points[i][1] * 1.05, 1e-5);
        assert_int_equal(opening.next[i], next[i]);
    }
    plan_destroy(plan);
}

static void the_depth_of_a_view_into_space_holds_beams_that_stick_out(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    add_beam(plan, "a", vec3(0, -120, 0), vec3(0, 0, 0), 40);
    for (int is_visible = 0; is_visible < 2; is_visible++) {
        struct scene scene;
        struct view view = view_default;
        struct camera camera;
        struct error err = { 0 };
        char field[128];
        scene_for_plan(plan, &scene);
        look_at(&scene, "a", is_visible);
        view.camera.projection = SCENE_PROJECTION_PARALLEL;
        view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_up = true;
        view.camera.position_mm = vec3(0, -400, 0);
        view.camera.target_mm = vec3(0, 0, 0);
        view.camera.up = vec3(0, 0, 1);
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        assert_string_equal(err.text, "");
        camera_resolve(snapshot, &camera);
        /* the cube is 350 to 450 mm away; the line from 280 mm less its shaft to 450 mm and a tenth of the diagonal */
        double near_mm = is_visible ? 280 - 0.045 * DIAGONAL : 350, far_mm = is_visible ? 450 + 0.1 * DIAGONAL : 450,
               slack = fmax(1, 0.01 * (far_mm - near_mm));
        assert_close(camera.near_mm, near_mm - slack, 1e-9);
        assert_close(camera.far_mm, far_mm + slack, 1e-9);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void a_beams_eye_view_leaves_out_its_own_line_and_with_the_ring_its_opening(void **state)
{
    (void)state;
    struct plan *plan = cube_plan();
    struct scene scene = scene_default;
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    add_beam(plan, "a", vec3(0, -200, 0), vec3(0, 0, 0), 80);
    add_beam(plan, "b", vec3(-200, 0, 0), vec3(0, 0, 0), 80);
    look_at(&scene, "a", true);
    look_at(&scene, "b", true);
    snprintf(scene.beam.id, sizeof scene.beam.id, "b");
    assert_int_equal(beams_drawn(plan, &scene, NULL, drawn), 2);
    struct view space = view_default, along = view_default, ring = view_default;
    along.kind = ring.kind = SCENE_KIND_BEAM;
    ring.beam.has_aperture_mm = true;
    ring.beam.aperture_mm = 80;
    assert_true(beam_line_is_drawn(&drawn[1], &space) && beam_opening_is_drawn(&drawn[1], &space));
    assert_true(!beam_line_is_drawn(&drawn[1], &along) && beam_opening_is_drawn(&drawn[1], &along));
    assert_true(!beam_line_is_drawn(&drawn[1], &ring) && !beam_opening_is_drawn(&drawn[1], &ring));
    assert_true(beam_line_is_drawn(&drawn[0], &ring) && beam_opening_is_drawn(&drawn[0], &ring)); /* another beam */
    assert_int_equal(beams_n_translucent(plan, &scene, NULL), 2);
    scene.beam.opacity = 1;
    assert_int_equal(beams_n_translucent(plan, &scene, NULL), 0);
    scene_finish(&scene);
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_visible_beams_are_drawn),
        cmocka_unit_test(a_draft_is_drawn_with_its_planned_beam_grey_beside_it),
        cmocka_unit_test(lines_begin_before_the_box_and_end_behind_it),
        cmocka_unit_test(a_line_that_passes_the_plan_far_away_is_not_drawn),
        cmocka_unit_test(a_round_opening_is_a_circle_and_a_cylinder),
        cmocka_unit_test(an_opening_of_jaws_widens_from_the_source_through_the_isocentre),
        cmocka_unit_test(every_polygon_of_an_outline_is_closed_in_itself),
        cmocka_unit_test(the_depth_of_a_view_into_space_holds_beams_that_stick_out),
        cmocka_unit_test(a_beams_eye_view_leaves_out_its_own_line_and_with_the_ring_its_opening),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
