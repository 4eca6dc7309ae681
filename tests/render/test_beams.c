/* Beams in pictures: where lines and walls of openings are, in millimetres; drafts; what hides them; and the
 * same on every back end. */
#include "tests/render/beam_scene.h"

static const struct vec3 origin = { 0, 0, 0 }, from_front = { 0, -1, 0 }, up = { 0, 0, 1 };

static void the_line_runs_from_before_the_entry_through_the_target_to_behind_the_patient(void **state)
{
    (void)state;
    struct plan *plan = beam_plan_sideways(NAN);
    struct image *image = shots_plain(plan, beam_scene(plan), shots_view_from(origin, from_front, up, PX_PER_MM));
    int first, last, row = row_of(10) - 1; /* two pixels wide, around 120 */
    assert_true(extent_of_row(image, row, &first, &last));
    assert_close(first, MIDDLE_X + (-60 - 1.5 * SIZE) * PX_PER_MM, 1.5);
    assert_close(last, MIDDLE_X + (40 + 0.1 * DIAGONAL) * PX_PER_MM, 1.5);
    for (int x = first + 1; x < last; x++) {
        assert_true(has_color(shots_pixel(image, x, row), BEAM_SCENE_RGB) ||
                    has_color(shots_pixel(image, x, row + 1), BEAM_SCENE_RGB));
        bool is_head = x >= column_of(-60 - SIZE) - 1 && x <= column_of(-60) + 1, is_cross = abs(x - column_of(0)) <= 1;
        if (!is_head && !is_cross)
            assert_true(is_background(shots_pixel(image, x, row - 2)) && is_background(shots_pixel(image, x, row + 3)));
    }
    /* the head's barbs: open before the entry, closed at it; the cross: half its size up and down */
    int high, low;
    assert_true(extent_of_column(image, column_of(-60 - SIZE) + 1, &high, &low));
    assert_close(low - high, 2 * 0.4 * SIZE * PX_PER_MM, 2.5);
    assert_true(extent_of_column(image, column_of(-60) + 2, &high, &low));
    assert_in_range(low - high, 0, 2);
    assert_true(extent_of_column(image, column_of(0), &high, &low));
    assert_close(low - high, SIZE * PX_PER_MM, 2.5);
    image_destroy(image);
    shots_forget(plan);
}

static void an_aperture_is_as_wide_as_it_is(void **state)
{
    (void)state;
    for (int is_opaque = 0; is_opaque < 2; is_opaque++) {
        struct plan *plan = beam_plan_sideways(44);
        struct scene scene = beam_scene(plan);
        scene.beam.opacity = is_opaque ? 1 : 0.5;
        struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, PX_PER_MM));
        int high, low, first, last;
        for (double x_mm = -55; x_mm < 38; x_mm += 3.1) {
            assert_true(extent_of_column(image, column_of(x_mm), &high, &low));
            assert_close(high, MIDDLE_Y - (10 + 22) * PX_PER_MM, 1);
            assert_close(low + 1, MIDDLE_Y - (10 - 22) * PX_PER_MM, 1);
        }
        /* from the entry to the far side of the plan's box; its edges are lines of two pixels */
        assert_true(extent_of_row(image, row_of(25), &first, &last));
        assert_close(first, MIDDLE_X - 60 * PX_PER_MM, 2);
        assert_close(last + 1, MIDDLE_X + 40 * PX_PER_MM, 2);
        image_destroy(image);
        shots_forget(plan);
    }
}

static void an_opening_of_jaws_widens_from_the_source(void **state)
{
    (void)state;
    struct plan *plan = beam_plan(vec3(-1000, 0, 0), vec3(0, 0, 0), NAN);
    struct beam_delivery *delivery = &plan->beams[0].delivery;
    plan->beams[0].has_delivery = true;
    delivery->opening_x_mm[0] = -15;
    delivery->opening_x_mm[1] = 25;
    delivery->opening_y_mm[0] = -10;
    delivery->opening_y_mm[1] = 10;
    delivery->collimator_x_lps = up;
    delivery->collimator_y_lps = vec3(0, 1, 0);
    struct scene scene = beam_scene(plan);
    scene.beam.opacity = 1;
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, PX_PER_MM));
    for (double x_mm = -60; x_mm < 38; x_mm += 7) {
        int high, low;
        double scale = (1000 + x_mm) / 1000;
        assert_true(extent_of_column(image, column_of(x_mm), &high, &low));
        /* the edges between corners are lines: one pixel beyond the wall */
        assert_close(high, MIDDLE_Y - 25 * scale * PX_PER_MM, 2);
        assert_close(low + 1, MIDDLE_Y + 15 * scale * PX_PER_MM, 2);
    }
    image_destroy(image);
    shots_forget(plan);
}

static void a_draft_is_dashed_and_its_planned_beam_is_not(void **state)
{
    (void)state;
    struct plan *plan = beam_plan_sideways(NAN);
    struct scene scene = beam_scene(plan);
    scene.beam.draft.enabled = true;
    scene.beam.draft.line.entry_mm = vec3(-60, 0, -20);
    scene.beam.draft.line.target_mm = vec3(0, 0, -20);
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, PX_PER_MM));
    int n_starts = 0, n_shown = 0, row = row_of(-20) - 1;
    double first_px = MIDDLE_X + (-60 - 1.5 * SIZE) * PX_PER_MM, period_px = 1.5 * SIZE * PX_PER_MM;
    for (int x = column_of(2 * SIZE); x < column_of(38); x++) {
        bool is_on = has_color(shots_pixel(image, x, row), BEAM_SCENE_RGB);
        n_shown += is_on;
        if (is_on && !has_color(shots_pixel(image, x - 1, row), BEAM_SCENE_RGB)) {
            double dashes = (x - first_px) / period_px;
            assert_close(dashes, round(dashes), 1.6 / period_px); /* lines end half a width later */
            n_starts++;
        }
        const uint8_t *planned = shots_pixel(image, x, row_of(10) - 1);
        assert_false(is_background(planned));
        assert_true(abs(planned[0] - planned[2]) < 24); /* grey, where the beam's own colour is blue */
    }
    double span_px = column_of(38) - column_of(2 * SIZE);
    assert_close(n_starts, span_px / period_px, 1);
    assert_close(n_shown / span_px, 0.55 + 2 / period_px, 0.1); /* a pixel more at both ends of a dash */
    image_destroy(image);
    shots_forget(plan);
}

/* The plate covers the line on the left of the picture's middle; the body lies behind it. */
static void opaque_regions_hide_the_line_and_translucent_ones_do_not(void **state)
{
    (void)state;
    for (int is_translucent = 0; is_translucent < 2; is_translucent++) {
        struct plan *plan = beam_plan_sideways(NAN);
        struct scene scene = beam_scene(plan);
        for (size_t i = 0; i < scene.n_regions; i++) {
            scene.regions[i].value.visible = true;
            scene.regions[i].value.opacity = is_translucent ? 0.4 : 1;
        }
        struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, PX_PER_MM));
        const uint8_t *covered = shots_pixel(image, column_of(15), row_of(10) - 1),
                      *before_body = shots_pixel(image, column_of(-15), row_of(10) - 1);
        assert_true(has_color(before_body, BEAM_SCENE_RGB)); /* not mixed with what lies behind it */
        if (is_translucent) {
            double expected[3];
            for (int c = 0; c < 3; c++)
                expected[c] = 0.4 * shots_facing_light((BEAM_SCENE_PLATE >> (16 - 8 * c) & 255) / 255.0, false) +
                              0.6 * (BEAM_SCENE_RGB >> (16 - 8 * c) & 255) / 255.0;
            shots_expect_color(covered, expected);
        } else {
            assert_true(covered[0] > 150 && covered[2] < 60);
        }
        image_destroy(image);
        shots_forget(plan);
    }
}

static void clip_planes_leave_beams_whole(void **state)
{
    (void)state;
    struct plan *plan = beam_plan_sideways(44);
    struct image *images[2];
    for (int is_clipped = 0; is_clipped < 2; is_clipped++) {
        struct scene scene = beam_scene(plan);
        scene.clip.sagittal_low.enabled = scene.clip.axial_high.enabled = is_clipped;
        images[is_clipped] = shots_plain(plan, scene, shots_view_from(origin, from_front, up, PX_PER_MM));
    }
    assert_memory_equal(images[0]->rgba, images[1]->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    image_destroy(images[0]);
    image_destroy(images[1]);
    shots_forget(plan);
}

static void a_beams_eye_view_with_the_ring_leaves_out_its_own_beam(void **state)
{
    (void)state;
    struct plan *plan = beam_plan_sideways(44);
    struct image *images[2];
    for (int is_visible = 0; is_visible < 2; is_visible++) {
        struct scene scene = beam_scene(plan);
        struct view view = shots_view(SCENE_KIND_BEAM, origin, PX_PER_MM);
        view.beam.has_aperture_mm = true;
        view.beam.aperture_mm = 44;
        scene.beam.looks[0].value.visible = is_visible;
        images[is_visible] = shots_plain(plan, scene, view);
    }
    assert_memory_equal(images[0]->rgba, images[1]->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    image_destroy(images[0]);
    image_destroy(images[1]);
    shots_forget(plan);
}

/* ---- every back end ---------------------------------------------------------------------------------------------- */

static struct scene full_scene(const struct plan *plan)
{
    struct scene scene = beam_scene(plan);
    for (size_t i = 0; i < scene.n_regions; i++) {
        scene.regions[i].value.visible = true;
        scene.regions[i].value.opacity = i ? 0.5 : 1;
    }
    scene.surface.translucency = SCENE_TRANSLUCENCY_RIM;
    scene.beam.opacity = 0.3;
    scene.beam.draft.enabled = true;
    scene.beam.draft.line.entry_mm = vec3(-50, -40, 50);
    scene.beam.draft.line.target_mm = vec3(5, 5, 5);
    return scene;
}

static void every_back_end_draws_the_same_beams(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct renderer *soft = renderer_create(RENDER_SOFT, &err), *under_test = shots_renderer;
    for (int is_still = 0; is_still < 2; is_still++) {
        struct plan *plan = beam_plan_sideways(44);
        const struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, is_still };
        struct image *images[2];
        for (int i = 0; i < 2; i++) {
            struct view view = shots_view_from(origin, vec3(0.5, -1, 0.4), up, 2);
            view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
            shots_renderer = i ? soft : under_test;
            images[i] = shots_take(plan, full_scene(plan), view, &options, NULL);
        }
        size_t n = (size_t)SHOTS_WIDTH * SHOTS_HEIGHT, n_far = 0, n_drawn = 0;
        for (size_t p = 0; p < n; p++) {
            bool is_far = false;
            for (size_t channel = 0; channel < 3; channel++)
                is_far |= abs(images[0]->rgba[4 * p + channel] - images[1]->rgba[4 * p + channel]) > 8;
            n_far += is_far;
            n_drawn += !is_background(&images[0]->rgba[4 * p]);
        }
        assert_true(n_drawn > 10000);
        assert_true(n_far < n_drawn / 200); /* pixels that edges run through to within rounding */
        image_destroy(images[0]);
        image_destroy(images[1]);
        renderer_forget(soft, plan);
        shots_renderer = under_test;
        shots_forget(plan);
    }
    renderer_destroy(soft);
}

static void a_plan_with_beams_that_are_not_shown_has_the_same_picture(void **state)
{
    (void)state;
    const enum scene_kind kinds[] = { SCENE_KIND_3D, SCENE_KIND_AXIAL };
    for (size_t k = 0; k < 2; k++) {
        struct image *images[2];
        for (int has_beam = 0; has_beam < 2; has_beam++) {
            struct plan *plan = beam_plan_sideways(44);
            plan->n_beams = (size_t)has_beam;
            struct scene scene = shots_scene(plan);
            if (has_beam) {
                scene_finish(&scene);
                scene = full_scene(plan);
                scene.beam.looks[0].value.visible = scene.beam.draft.enabled = false;
            } else {
                shots_style(&scene, "plate")->opacity = 0.5;
                scene.surface.translucency = SCENE_TRANSLUCENCY_RIM;
            }
            images[has_beam] = shots_plain(plan, scene, shots_view(kinds[k], origin, PX_PER_MM));
            shots_forget(plan);
        }
        assert_memory_equal(images[0]->rgba, images[1]->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(images[0]);
        image_destroy(images[1]);
    }
}

/* A wall of 32 x 32 regions across the middle, one voxel each. */
static double every_label(struct vec3 p)
{
    return fabs(p.y) > 1 ? 0 : 1 + floor(p.x + 16) + 32 * floor(p.z + 16);
}

static void every_region_and_every_beam_of_a_plan_may_be_translucent(void **state)
{
    (void)state;
    enum { N_REGIONS = 1024 };
    _Static_assert((int)N_REGIONS == (int)REGION_MAX, "a plan's most regions");
    struct made_region *regions = mem_new(N_REGIONS * sizeof *regions);
    char(*ids)[16] = mem_new(N_REGIONS * sizeof *ids);
    for (int i = 0; i < N_REGIONS; i++) {
        snprintf(ids[i], sizeof ids[i], "region-%d", i);
        regions[i] = (struct made_region){ ids[i], -1, 0xff0000 };
    }
    struct grid grid = made_cube_grid(32);
    struct plan *plan = made_plan(&grid, every_label, regions, N_REGIONS);
    struct scene scene = shots_scene(plan);
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.opacity = 0.5;
    scene.beam.looks = mem_new(PLAN_MAX_BEAMS * sizeof *scene.beam.looks);
    scene.beam.n_looks = plan->n_beams = PLAN_MAX_BEAMS;
    for (size_t i = 0; i < plan->n_beams; i++) {
        struct beam *beam = &plan->beams[i];
        snprintf(beam->id, sizeof beam->id, "field-%zu", i);
        beam->entry_lps_mm = vec3(-60, 0, 8);
        beam->target_lps_mm = vec3(0, 0, 8);
        beam->aperture_mm = 12;
        struct scene_beam_look_entry *look = &scene.beam.looks[i];
        snprintf(look->id, sizeof look->id, "%s", beam->id);
        look->value = scene_beam_look_default;
        look->value.visible = true;
        look->value.color_rgb = 0x0000ff;
    }
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, PX_PER_MM));
    /* 64 walls before the regions let (1 - 0.15)^64, less than a ten-thousandth, of the light pass */
    const uint8_t *before = shots_pixel(image, column_of(-5.5), row_of(10.5)),
                  *beside = shots_pixel(image, column_of(-5.5), row_of(-7.5));
    assert_true(before[2] > 100 && before[2] > 3 * before[0]);
    assert_true(beside[0] > 50 && beside[0] > 3 * beside[2]);
    image_destroy(image);
    shots_forget(plan);
    free(regions);
    free(ids);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_line_runs_from_before_the_entry_through_the_target_to_behind_the_patient),
        cmocka_unit_test(an_aperture_is_as_wide_as_it_is),
        cmocka_unit_test(an_opening_of_jaws_widens_from_the_source),
        cmocka_unit_test(a_draft_is_dashed_and_its_planned_beam_is_not),
        cmocka_unit_test(opaque_regions_hide_the_line_and_translucent_ones_do_not),
        cmocka_unit_test(clip_planes_leave_beams_whole),
        cmocka_unit_test(a_beams_eye_view_with_the_ring_leaves_out_its_own_beam),
        cmocka_unit_test(every_region_and_every_beam_of_a_plan_may_be_translucent),
        cmocka_unit_test(every_back_end_draws_the_same_beams),
        cmocka_unit_test(a_plan_with_beams_that_are_not_shown_has_the_same_picture),
    };
    return shots_run_drivers("beams", tests, sizeof tests / sizeof tests[0]);
}
