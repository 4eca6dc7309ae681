/* Annotations of pictures along a beam: letters, words of the caption, numbers of the crosshair; and whose dose is
 * shown while a draft stands. */
#include "core/annotate/describe.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double ball(struct vec3 p)
{
    return vec3_length(p) < 60;
}
static const struct made_region region[] = { { "body", -1, 0x8090a0 } };

/* Beam "beam-1" from L 60 P 60 S -30 to the target L 24 P 30 S -60, and "side"; a dose in Gy. */
static struct plan *beam_plan(void)
{
    const uint32_t size[3] = { 30, 30, 30 };
    struct grid grid =
        made_grid(30, 30, 30, made_affine(vec3(5, 0, 0), vec3(0, 5, 0), vec3(0, 0, 5), size, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, ball, region, 1);
    made_plan_add_image(plan, &grid, VOXEL_U8, ball);
    (void)snprintf(plan->images[0].name, sizeof plan->images[0].name, "MR");
    plan->n_beams = 2;
    plan->beams[0] = (struct beam){ .id = "beam-1",
                                    .name = "FiR 1",
                                    .entry_lps_mm = { 60, 60, -30 },
                                    .target_lps_mm = { 24, 30, -60 },
                                    .aperture_mm = 120 };
    plan->beams[1] = (struct beam){
        .id = "side", .name = "side", .entry_lps_mm = { 90, 0, 0 }, .target_lps_mm = { 10, 0, 0 }, .aperture_mm = NAN
    };
    struct dose *dose = &plan->doses[plan->n_doses++];
    (void)snprintf(dose->id, sizeof dose->id, "dose");
    (void)snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->has_frame = true;
    dose->frame = DOSE_FRAME_SAME;
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(&grid, VOXEL_F32, ball) };
    return plan;
}

static struct scene scene_of(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    scene.image.slices.axial.visible = false;
    return scene;
}

static void set_draft(struct scene *scene, const char *name)
{
    scene->beam.draft.enabled = true;
    (void)snprintf(scene->beam.draft.line.name, sizeof scene->beam.draft.line.name, "%s", name);
    scene->beam.draft.line.entry_mm = vec3(50, 57.3, -32.1);
    scene->beam.draft.line.target_mm = vec3(27.9, 34.4, -62.9);
}

static struct annotations describe(struct plan *plan, struct scene scene, struct view view, int width_px)
{
    struct annotations words;
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 3, field, &err);
    assert_string_equal(err.text, "");
    assert_true(annotations_describe(&words, snapshot, width_px, "", &err));
    snapshot_unref(snapshot);
    return words;
}

/* The text of a row's items, separated by "|". */
static const char *row_text(const struct annotations *words, enum annotation_row row)
{
    static char text[2048];
    text[0] = '\0';
    for (size_t i = 0; i < words->n_items; i++) {
        assert_true(i == 0 || words->items[i].row >= words->items[i - 1].row);
        if (words->items[i].row == row)
            (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", text[0] ? "|" : "",
                           words->items[i].text);
    }
    return text;
}

static struct view view_of(enum scene_kind kind)
{
    struct view view = view_default;
    view.kind = kind;
    view.size_px[0] = 1000;
    view.size_px[1] = 800;
    return view;
}

static const char belongs[] = "Draft beam: the dose shown belongs to the planned beam";

/* The draft runs towards R, A and I in parts 22.1 : 22.9 : 30.8: up is S, then A; right, which is level, R, then P. */
static void the_eye_of_a_draft_has_letters_scale_place_ring_and_whose_dose_it_shows(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    for (int has_dose = 0; has_dose < 2; has_dose++) {
        struct scene scene = scene_of(plan);
        struct view view = view_of(SCENE_KIND_BEAM);
        set_draft(&scene, has_dose ? "steeper" : "");
        scene.dose.wash.visible = has_dose;
        view.beam.has_along_mm = view.beam.has_aperture_mm = view.camera.has_height_mm = true;
        view.beam.along_mm = 20;
        view.beam.aperture_mm = 88.5;
        view.camera.height_mm = 200;
        struct annotations words = describe(plan, scene, view, 500);
        assert_string_equal(words.letters.left, "LA");
        assert_string_equal(words.letters.right, "RP");
        assert_string_equal(words.letters.top, "SA");
        assert_string_equal(words.letters.bottom, "IP");
        assert_close(words.pixels_per_mm, 2, 1e-12); /* 800 px to 200 mm, at half the size */
        assert_string_equal(row_text(&words, ANNOTATION_PANE), "Beam's eye|parallel projection");
        char expected[256];
        (void)snprintf(expected, sizeof expected,
                       "Beam: draft%s of beam-1 (FiR 1)|eye 20.0 mm from source end|"
                       "ring 88.5 mm, drawn%s%s",
                       has_dose ? " steeper" : "", has_dose ? "|" : "", has_dose ? belongs : "");
        assert_string_equal(row_text(&words, ANNOTATION_BEAM), expected);
        annotations_finish(&words);
    }
    plan_and_derived_destroy(plan);
}

static void expect_label(const struct annotations *words, const char *text, double x, double y, double slack)
{
    for (size_t i = 0; i < words->n_labels; i++)
        if (strcmp(words->labels[i].text, text) == 0 && fabs(words->labels[i].at[0] * 1000 - x) <= slack &&
            fabs(words->labels[i].at[1] * 800 - y) <= slack)
            return;
    fail_msg("no '%s' at %g, %g", text, x, y);
}

/* 4 px to the mm: 20 mm are 80 px, 40 mm 160, 80 mm 320. Words of 14 px stand 9 px and their size beside the lines. */
static void the_crosshair_has_its_numbers_and_the_ring_its_diameter(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct scene scene = scene_of(plan);
    struct view view = view_of(SCENE_KIND_BEAM);
    view.beam.has_aperture_mm = view.camera.has_height_mm = true;
    view.beam.aperture_mm = 120;
    view.camera.height_mm = 200;
    set_draft(&scene, "");
    struct annotations words = describe(plan, scene, view, 1000);
    const double aside = 9 + annotate_text_px(1000);
    static const int numbers_mm[] = { 20, 40, 80 };
    for (int i = 0; i < 3; i++)
        for (int side = -1; side <= 1; side += 2) {
            char text[8];
            (void)snprintf(text, sizeof text, "%d", numbers_mm[i]);
            expect_label(&words, text, 500 + side * numbers_mm[i] * 4, 400 + aside, 0.01);
            expect_label(&words, text, 500 + aside, 400 + side * numbers_mm[i] * 4, 0.01);
        }
    expect_label(&words, "ring 120 mm", 500 + 240 * sqrt(0.5), 400 - 240 * sqrt(0.5), 0.01);
    /* the planned entry less the draft's: L 10, P 2.7, S 2.1, along right (dy, -dx, 0) / h and up = right x d */
    double n = sqrt(22.1 * 22.1 + 22.9 * 22.9 + 30.8 * 30.8), h = hypot(22.1, 22.9);
    double dx = -22.1 / n, dy = -22.9 / n, dz = -30.8 / n, s = h / n;
    double right = (10 * dy - 2.7 * dx) / s, up = (-dz * dx * 10 - dz * dy * 2.7 + s * s * 2.1) / s;
    expect_label(&words, "planned source end", 500 + 4 * right, 400 - 4 * up, 0.01);
    assert_int_equal(words.n_labels, 14);
    annotations_finish(&words);

    scene = scene_of(plan); /* so small that the numbers would touch, and none beyond the picture */
    view.camera.height_mm = 1600;
    view.beam.has_aperture_mm = false;
    view.camera.projection = SCENE_PROJECTION_PARALLEL;
    words = describe(plan, scene, view, 1000);
    assert_int_equal(words.n_labels, 0); /* 40 mm between 40 and 80 are 20 px */
    annotations_finish(&words);
    plan_and_derived_destroy(plan);
}

/* The names stand at the ends of the lines before the patient: on the picture's right, as both beams come from L. */
static void beams_in_space_have_their_names_beside_each_other(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    for (int has_draft = 0; has_draft < 2; has_draft++) {
        struct scene scene = scene_of(plan);
        scene.beam.looks = mem_new(2 * sizeof *scene.beam.looks);
        scene.beam.n_looks = 2;
        scene.beam.looks[0] = (struct scene_beam_look_entry){ .id = "beam-1", .value = scene_beam_look_default };
        scene.beam.looks[1] = (struct scene_beam_look_entry){ .id = "side", .value = scene_beam_look_default };
        scene.beam.looks[0].value.visible = true;
        if (has_draft)
            set_draft(&scene, "");
        struct view view = view_of(SCENE_KIND_3D);
        view.camera.has_position_mm = view.camera.has_target_mm = true;
        view.camera.position_mm = vec3(0, -900, 0); /* from the front */
        view.camera.target_mm = vec3(0, 0, 0);
        struct annotations words = describe(plan, scene, view, 500);
        assert_int_equal(words.n_labels, has_draft ? 2 : 1);
        assert_string_equal(words.labels[0].text, has_draft ? "beam-1 (FiR 1), planned" : "beam-1 (FiR 1)");
        assert_true(words.labels[0].at[0] > 0.5);
        if (has_draft) {
            assert_string_equal(words.labels[1].text, "draft of beam-1 (FiR 1)");
            assert_true(fabs(words.labels[0].at[1] - words.labels[1].at[1]) * 800 > 20 ||
                        fabs(words.labels[0].at[0] - words.labels[1].at[0]) * 1000 > 150);
        }
        annotations_finish(&words);
    }
    plan_and_derived_destroy(plan);
}

static void a_beam_slice_says_where_it_is_and_which_beam_it_crosses(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    for (int is_side = 0; is_side < 2; is_side++) {
        struct scene scene = scene_of(plan);
        (void)snprintf(scene.beam.id, sizeof scene.beam.id, "%s", is_side ? "side" : "");
        scene.beam.slice.along_mm = is_side ? -7.25 : 44.26;
        struct view view = view_of(SCENE_KIND_BEAM_SLICE);
        view.beam.crosshair = false;
        struct annotations words = describe(plan, scene, view, 500);
        assert_string_equal(row_text(&words, ANNOTATION_BEAM), is_side
                                                                   ? "Beam: side|7.3 mm before source end"
                                                                   : "Beam: beam-1 (FiR 1)|44.3 mm from source end");
        const char *pane = row_text(&words, ANNOTATION_PANE);
        assert_true(strncmp(pane, "Beam slice|", 11) == 0);
        assert_string_equal(words.letters.top, is_side ? "S" : "SR"); /* the beam runs further to R than to A */
        assert_string_equal(words.letters.right, is_side ? "P" : "PR");
        assert_true(words.pixels_per_mm > 0);
        annotations_finish(&words);
    }
    plan_and_derived_destroy(plan);
}

static void a_picture_of_any_kind_says_so_when_its_dose_is_not_the_drafts(void **state)
{
    (void)state;
    static const enum scene_kind kinds[] = { SCENE_KIND_3D, SCENE_KIND_AXIAL, SCENE_KIND_SAGITTAL,
                                             SCENE_KIND_BEAM_SLICE };
    struct plan *plan = beam_plan();
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        for (int what = 0; what < 4; what++) { /* draft and dose; no dose; no draft; a draft of no length */
            struct scene scene = scene_of(plan);
            if (what != 2)
                set_draft(&scene, "");
            if (what == 3)
                scene.beam.draft.line.target_mm = scene.beam.draft.line.entry_mm;
            scene.dose.lines.visible = what != 1;
            scene.dose.wash.visible = false;
            struct annotations words = describe(plan, scene, view_of(kinds[k]), 500);
            bool has = strstr(row_text(&words, ANNOTATION_BEAM), belongs) != NULL;
            assert_int_equal(has, what == 0);
            if (kinds[k] != SCENE_KIND_BEAM_SLICE)
                assert_string_equal(row_text(&words, ANNOTATION_BEAM), what == 0 ? belongs : "");
            annotations_finish(&words);
        }
    plan->n_beams = 0; /* a draft of its own */
    struct scene scene = scene_of(plan);
    set_draft(&scene, "mine");
    scene.dose.lines.visible = true;
    struct annotations words = describe(plan, scene, view_of(SCENE_KIND_BEAM), 500);
    assert_string_equal(row_text(&words, ANNOTATION_BEAM),
                        "Beam: draft mine|Draft beam: the dose shown does not belong to it");
    annotations_finish(&words);
    plan_and_derived_destroy(plan);
}

static void slices_and_cuts_across_a_beam_name_it_in_space(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct scene scene = scene_of(plan);
    set_draft(&scene, "");
    scene.beam.slice.visible = scene.clip.beam.enabled = true;
    scene.beam.slice.along_mm = scene.clip.beam.along_mm = 31;
    struct annotations words = describe(plan, scene, view_of(SCENE_KIND_3D), 500);
    assert_non_null(
        strstr(row_text(&words, ANNOTATION_PANE), "|beam slice of draft of beam-1 (FiR 1), 31.0 mm from source end|"));
    assert_non_null(strstr(row_text(&words, ANNOTATION_METHODS),
                           "Cut off: before the plane along draft of beam-1 (FiR 1) at 31.0 mm"));
    annotations_finish(&words);
    scene = scene_of(plan); /* the scene's second beam */
    (void)snprintf(scene.beam.id, sizeof scene.beam.id, "side");
    scene.clip.beam.enabled = true;
    words = describe(plan, scene, view_of(SCENE_KIND_3D), 500);
    assert_non_null(strstr(row_text(&words, ANNOTATION_METHODS), "before the plane along side at 0.0 mm"));
    annotations_finish(&words);
    plan_and_derived_destroy(plan);
}

static void views_of_no_beam_are_described_as_what_they_show(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    plan->n_beams = 0;
    struct annotations words = describe(plan, scene_of(plan), view_of(SCENE_KIND_BEAM), 500);
    assert_string_equal(row_text(&words, ANNOTATION_PANE), "3-D|perspective, no scale");
    assert_string_equal(row_text(&words, ANNOTATION_BEAM), "");
    assert_int_equal(words.n_labels, 0);
    annotations_finish(&words);
    words = describe(plan, scene_of(plan), view_of(SCENE_KIND_BEAM_SLICE), 500);
    assert_true(strncmp(row_text(&words, ANNOTATION_PANE), "Axial|S ", 8) == 0);
    annotations_finish(&words);
    plan_and_derived_destroy(plan);
}

/* A measure behind the eye is not in the picture, one before it is. */
static void measures_behind_the_eye_are_left_out(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    for (int is_parallel = 0; is_parallel < 2; is_parallel++)
        for (int is_behind = 0; is_behind < 2; is_behind++) {
            struct scene scene = scene_of(plan);
            (void)snprintf(scene.beam.id, sizeof scene.beam.id, "side");
            scene.measures = mem_new(sizeof *scene.measures);
            scene.n_measures = 1;
            scene.measures[0] = (struct scene_measure_entry){ .id = "m", .value = scene_measure_default };
            struct scene_measure *measure = &scene.measures[0].value;
            measure->points = mem_new(2 * sizeof *measure->points);
            measure->n_points = 2;
            measure->points[0].at_mm = vec3(0, 5, 0);
            measure->points[1].at_mm = vec3(0, 0, 9);
            struct view view = view_of(SCENE_KIND_BEAM);
            view.camera.projection = is_parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
            view.beam.crosshair = false;
            view.beam.has_along_mm = true;
            view.beam.along_mm = is_behind ? 100 : 60; /* at L -10 or L 30 */
            struct annotations words = describe(plan, scene, view, 500);
            assert_int_equal(words.n_lines, !is_behind);
            assert_int_equal(words.n_labels, !is_behind);
            annotations_finish(&words);
        }
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_eye_of_a_draft_has_letters_scale_place_ring_and_whose_dose_it_shows),
        cmocka_unit_test(the_crosshair_has_its_numbers_and_the_ring_its_diameter),
        cmocka_unit_test(beams_in_space_have_their_names_beside_each_other),
        cmocka_unit_test(a_beam_slice_says_where_it_is_and_which_beam_it_crosses),
        cmocka_unit_test(a_picture_of_any_kind_says_so_when_its_dose_is_not_the_drafts),
        cmocka_unit_test(slices_and_cuts_across_a_beam_name_it_in_space),
        cmocka_unit_test(views_of_no_beam_are_described_as_what_they_show),
        cmocka_unit_test(measures_behind_the_eye_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
