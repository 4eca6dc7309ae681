/* Words of a snapshot: what letters, caption and chips of a picture say. */
#include "core/annotate/describe.h"
#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double low_and_high(struct vec3 p)
{
    return p.z < 0 ? 1 : 2;
}
static double height(struct vec3 p)
{
    return p.z;
}

/* The text of a row's items, separated by "|". */
static const char *row_text(const struct annotations *annotations, enum annotation_row row)
{
    static char text[2048];
    text[0] = '\0';
    for (size_t i = 0; i < annotations->n_items; i++)
        if (annotations->items[i].row == row)
            snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", text[0] ? "|" : "",
                     annotations->items[i].text);
    return text;
}

static struct plan *made_plan_in_hu(void)
{
    static const struct made_region two[] = { { "low", -1, 0x804020 }, { "high", -1, 0x204080 } };
    struct grid grid = made_cube_grid(20);
    struct plan *plan = made_plan(&grid, low_and_high, two, 2);
    made_plan_add_image(plan, &grid, VOXEL_I16, height);
    snprintf(plan->name, sizeof plan->name, "Made plan");
    snprintf(plan->images[0].name, sizeof plan->images[0].name, "Planning");
    snprintf(plan->images[0].modality, sizeof plan->images[0].modality, "CT");
    snprintf(plan->images[0].unit, sizeof plan->images[0].unit, "HU");
    return plan;
}

static void a_snapshot_is_described(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    plan->n_doses = 1;
    plan->doses[0] = (struct dose){ .id = "run-1", .name = "Run 1", .unit = "cGy", .per = "per fraction" };
    char date[ANNOTATE_DATE_SIZE], field[128];
    annotate_date(1782898200, date); /* 2026-07-01 09:30:00 UTC, by `date` */
    for (int pane = 0; pane < 2; pane++) {
        struct scene scene;
        struct error err = { 0 };
        scene_for_plan(plan, &scene);
        scene.image.window = (struct scene_window){ 40, 400, 1 };
        scene.image.slices.axial.position_mm = -4;
        scene.image.slices.axial.visible = false;
        scene.regions[1].value.opacity = 0.35;
        scene.regions[0].value.representation = SCENE_REPRESENTATION_UNIVELS;
        scene.dose.grid = pane;
        struct view view = view_default;
        view.kind = pane ? SCENE_KIND_AXIAL : SCENE_KIND_3D;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 12, field, &err);
        assert_non_null(snapshot);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, date, &err));
        assert_string_equal(row_text(&words, ANNOTATION_TITLE), "Made plan");
        assert_string_equal(row_text(&words, ANNOTATION_PANE),
                            pane ? "Axial|S \u22124.0 mm|Planning, CT|C 40  W 400 HU" : "3-D|perspective, no scale");
        /* the upper region does not reach the slice */
        assert_string_equal(row_text(&words, ANNOTATION_REGIONS), pane ? "low" : "low, univels|high 35 %");
        assert_string_equal(row_text(&words, ANNOTATION_METHODS),
                            pane ? "Outlines: of the surfaces|Grid of the dose Run 1, cGy per fraction"
                                 : "Surfaces: smooth");
        assert_string_equal(row_text(&words, ANNOTATION_ORIGIN),
                            "2026-07-01 09:30 UTC|revision 12|Beamroom " BEAMROOM_VERSION);
        assert_string_equal(row_text(&words, ANNOTATION_USE), "For research and plan review.|Not a medical device.");
        assert_string_equal(row_text(&words, ANNOTATION_MISSING), "");
        struct camera camera;
        camera_resolve(snapshot, &camera);
        assert_close(words.pixels_per_mm, pane ? camera.pixels_per_mm / 2 : 0, 1e-9); /* the view is 1024 px wide */
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void a_patient_who_was_stated_has_beside_it_who_said_so_and_when_as_long_as_that_counts(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    const enum statement_state states[] = { STATEMENT_USED, STATEMENT_OUTDATED, STATEMENT_UNREAD,
                                            STATEMENT_CONTRADICTED };
    struct scene scene;
    char field[128];
    plan->patients[plan->n_patients++] = (struct plan_patient){ .id = "88-50327", .name = "Morgen^Ottilie" };
    plan->statement = (struct plan_statement){ .kind = STATEMENT_IDENTITY,
                                               .by = "Anna Weiss",
                                               .time_ms = INT64_C(1795823999000) }; /* 2026-11-27 23:59:59, by `date` */
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < 5; i++) {
        struct error err = { 0 };
        plan->statement.state = states[i % 4];
        if (i == 4) /* the files of several count as of one: the caption has the name of the files */
            plan->statement.kind = STATEMENT_ONE_PERSON;
        struct view view = view_default;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 12, field, &err);
        assert_non_null(snapshot);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, "", &err));
        assert_string_equal(row_text(&words, ANNOTATION_TITLE),
                            i == 0 ? "Made plan|O. M. \u2026327|stated by Anna Weiss, 27 Nov 2026 UTC"
                                   : "Made plan|O. M. \u2026327");
        annotations_name_patient(&words, plan);
        assert_non_null(strstr(row_text(&words, ANNOTATION_TITLE), "88-50327"));
        assert_int_equal(strstr(row_text(&words, ANNOTATION_TITLE), "stated by") != NULL, i == 0);
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static double ten(struct vec3 p)
{
    return 10 + 0 * p.x;
}

static void words_of_the_asker_stand_below_the_title_item_by_item(void **state)
{
    (void)state;
    struct annotations words = { .n_items = 0 };
    struct error err = { 0 };
    assert_true(annotations_add_words(&words, "alone", &err)); /* of no other item */
    assert_string_equal(row_text(&words, ANNOTATION_WORDS), "alone");
    annotations_finish(&words);
    words.items = mem_array(2, sizeof words.items[0], UINT64_MAX, &err);
    assert_non_null(words.items);
    words.items[0] = (struct annotation_item){ .row = ANNOTATION_TITLE, .text = "Plan" };
    words.items[1] = (struct annotation_item){ .row = ANNOTATION_PANE, .text = "Axial" };
    words.n_items = 2;
    assert_true(annotations_add_words(&words, "a; b; c;d; e; f; g; h", &err));
    assert_string_equal(row_text(&words, ANNOTATION_WORDS), "a|b|c;d|e|f|g; h"); /* nothing is left out */
    assert_int_equal(words.items[0].row, ANNOTATION_TITLE);
    assert_int_equal(words.items[words.n_items - 1].row, ANNOTATION_PANE);
    assert_int_equal(words.n_items, 2 + ANNOTATE_MAX_WORDS);
    annotations_finish(&words);
}

static void a_dose_is_described_with_what_it_lacks_and_its_levels(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    struct dose *dose = &plan->doses[plan->n_doses++];
    const struct grid *grid = &plan->images[0].volume->grid;
    *dose = (struct dose){ .id = "run-1", .name = "Run 1", .unit = "Gy", .per = "per fraction", .has_frame = true };
    dose->frame = DOSE_FRAME_DIFFERS;
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_BORON, .values = made_volume(grid, VOXEL_F32, ten) };
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_GAMMA, .values = made_volume(grid, VOXEL_F32, ten) };
    for (int is_accepted = 0; is_accepted < 2; is_accepted++) {
        struct scene scene;
        struct error err = { 0 };
        char field[128];
        scene_for_plan(plan, &scene);
        scene.dose.quantity = SCENE_DOSE_QUANTITY_WEIGHTED;
        scene.dose.lines.visible = true;
        scene.dose.factor = 30;
        snprintf(scene.dose.weights_name, sizeof scene.dose.weights_name, "Set A");
        scene.dose.reference = (struct scene_dose_reference){ .kind = SCENE_DOSE_REFERENCE_KIND_VALUE, .value = 40 };
        free(scene.dose.levels);
        scene.dose.levels = mem_new(3 * sizeof *scene.dose.levels);
        scene.dose.n_levels = 3;
        for (int i = 0; i < 3; i++) {
            snprintf(scene.dose.levels[i].id, sizeof scene.dose.levels[i].id, "l%d", i);
            scene.dose.levels[i].value = scene_dose_level_default;
        }
        scene.dose.levels[0].value.value = 90;
        scene.dose.levels[0].value.color_rgb = 0x010203;
        scene.dose.levels[1].value.value = 10;
        scene.dose.levels[1].value.unit = SCENE_DOSE_UNIT_DOSE;
        scene.dose.levels[2].value.value = 50;
        scene.dose.levels[2].value.visible = false;
        struct acceptance word = { .thing = "dose:run-1", .with = "image:ct", .by = "Anna Weiss" };
        snprintf(word.with, sizeof word.with, "image:%s", plan->images[0].id);
        struct acceptances accepted = { &word, 1 };
        struct view view = view_default;
        view.kind = SCENE_KIND_AXIAL;
        struct snapshot *snapshot =
            snapshot_create_accepted(derived_of(plan), &scene, &view, is_accepted ? &accepted : NULL, 1, field, &err);
        assert_non_null(snapshot);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, "", &err));
        const char *said = row_text(&words, ANNOTATION_DOSE);
        if (is_accepted) {
            assert_string_equal(said, "Dose Run 1 \u00d7 30|weighted dose in Gy(w) per fraction|"
                                      "100 % = 40.0 Gy(w), prescription|weights: Set A|without nitrogen|without fast");
            assert_non_null(strstr(row_text(&words, ANNOTATION_MISSING),
                                   "though it does not fit:|it was computed in another frame of reference.|It may be "
                                   "shifted against this image,|or be another patient's.|Accepted by Anna Weiss."));
            assert_string_equal(row_text(&words, ANNOTATION_LEVELS), "90 % = 36.0 Gy(w)|25.0 % = 10.0 Gy(w)");
        } else {
            assert_non_null(strstr(said, "it was computed in another frame of reference"));
            assert_string_equal(row_text(&words, ANNOTATION_LEVELS), "");
        }
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

/* The caption of a sum of doses that are each per beam. */
static void a_sum_of_beams_is_called_per_none_of_them(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    const struct grid *grid = &plan->images[0].volume->grid;
    for (; plan->n_doses < 2; plan->n_doses++) {
        struct dose *dose = &plan->doses[plan->n_doses];
        *dose = (struct dose){ .unit = "Gy", .per = "beam", .has_frame = true, .frame = DOSE_FRAME_SAME };
        snprintf(dose->id, sizeof dose->id, "run-%zu", plan->n_doses + 1);
        snprintf(dose->name, sizeof dose->name, "Run %zu", plan->n_doses + 1);
        dose->components[dose->n_components++] =
            (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(grid, VOXEL_F32, ten) };
    }
    for (size_t n_sum = 0; n_sum < 2; n_sum++) {
        struct scene scene;
        struct error err = { 0 };
        char field[128];
        struct view view = view_default;
        view.kind = SCENE_KIND_AXIAL;
        scene_for_plan(plan, &scene);
        scene.dose.quantity = SCENE_DOSE_QUANTITY_TOTAL;
        scene.dose.lines.visible = true;
        free(scene.dose.sum);
        scene.dose.sum = mem_new(sizeof *scene.dose.sum);
        scene.dose.n_sum = n_sum;
        snprintf(scene.dose.sum[0].id, sizeof scene.dose.sum[0].id, "run-2");
        scene.dose.sum[0].value = scene_dose_part_default;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, "", &err));
        const char *said = row_text(&words, ANNOTATION_DOSE);
        assert_non_null(strstr(said, n_sum ? "Dose Run 1|plus Run 2|physical dose in Gy|"
                                           : "Dose Run 1|physical dose in Gy per beam|"));
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void a_highlighted_part_is_described_with_its_limits_its_univels_and_its_weights(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    const struct grid *grid = &plan->images[0].volume->grid;
    struct dose *dose = &plan->doses[plan->n_doses++];
    *dose = (struct dose){ .unit = "Gy", .has_frame = true, .frame = DOSE_FRAME_SAME };
    snprintf(dose->id, sizeof dose->id, "run-1");
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(grid, VOXEL_F32, ten) };
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    scene.dose.quantity = SCENE_DOSE_QUANTITY_TOTAL;
    scene.dose.coverage.visible = true;
    scene.dose.coverage.unit = SCENE_DOSE_UNIT_DOSE;
    scene.dose.coverage.has_low = true;
    scene.dose.coverage.low = 5;
    scene.dose.population = SCENE_DOSE_POPULATION_WHOLE;
    snprintf(scene.dose.coverage.region, sizeof scene.dose.coverage.region, "%s", plan->regions.regions[0].id);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    struct annotations words;
    assert_true(annotations_describe(&words, snapshot, 512, "", &err));
    assert_non_null(strstr(row_text(&words, ANNOTATION_LEVELS), ", univels of at least 5.00 Gy: whole region"));
    annotations_finish(&words);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* 100 % is 40 Gy: 5 % of it are 2 Gy. */
static void a_comparison_is_described_with_its_colours_in_place_of_the_levels(void **state)
{
    (void)state;
    static const struct {
        enum scene_dose_comparison mode;
        bool has_error;
        const char *words, *colors;
    } cases[] = {
        { SCENE_DOSE_COMPARISON_DIFFERENCE, true,
          "Compared with Run 2: second less first in the body where the first is at least 10 %, colours to \u00b15 % of the "
          "reference, its lines dashed",
          "\u2264 \u22122.00 Gy|0 Gy|\u2265 +2.00 Gy|90 % = 36.0 Gy" },
        { SCENE_DOSE_COMPARISON_GAMMA, true,
          "Compared with Run 2: gamma index, 3 % of the reference and 2 mm, in the body where the first is at least 10 %",
          "gamma 0|up to 1: passes|above 1|\u2265 2" },
        { SCENE_DOSE_COMPARISON_LINES, false, "Compared with Run 2: its lines dashed", "90 % = 36.0 Gy" },
        { SCENE_DOSE_COMPARISON_NONE, true, "", "0 % statistical error|5 %|10 %|\u2265 20 %" },
        { SCENE_DOSE_COMPARISON_NONE, false, "", "90 % = 36.0 Gy" },
    };
    struct plan *plan = made_plan_in_hu();
    const struct grid *grid = &plan->images[0].volume->grid;
    for (; plan->n_doses < 2; plan->n_doses++) {
        struct dose *dose = &plan->doses[plan->n_doses];
        *dose = (struct dose){ .unit = "Gy", .has_frame = true, .frame = DOSE_FRAME_SAME };
        snprintf(dose->id, sizeof dose->id, "run-%zu", plan->n_doses + 1);
        snprintf(dose->name, sizeof dose->name, "Run %zu", plan->n_doses + 1);
        dose->components[dose->n_components++] =
            (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(grid, VOXEL_F32, ten) };
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene scene;
        struct error err = { 0 };
        char field[128];
        scene_for_plan(plan, &scene);
        scene.dose.quantity = SCENE_DOSE_QUANTITY_TOTAL;
        scene.dose.wash.visible = true;
        scene.dose.error = cases[i].has_error;
        scene.dose.compare = scene_dose_compare_default;
        scene.dose.compare.mode = cases[i].mode;
        scene.dose.compare.span_percent = 5;
        snprintf(scene.dose.compare.id, sizeof scene.dose.compare.id, "run-2");
        scene.dose.reference = (struct scene_dose_reference){ .kind = SCENE_DOSE_REFERENCE_KIND_VALUE, .value = 40 };
        free(scene.dose.levels);
        scene.dose.levels = mem_new(sizeof *scene.dose.levels);
        scene.dose.n_levels = 1;
        snprintf(scene.dose.levels[0].id, sizeof scene.dose.levels[0].id, "l");
        scene.dose.levels[0].value = scene_dose_level_default;
        scene.dose.levels[0].value.value = 90;
        struct view view = view_default;
        view.kind = SCENE_KIND_AXIAL;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        assert_non_null(snapshot);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, "", &err));
        const char *said = row_text(&words, ANNOTATION_DOSE);
        assert_true(cases[i].words[0] ? strstr(said, cases[i].words) != NULL : strstr(said, "ompared") == NULL);
        assert_string_equal(row_text(&words, ANNOTATION_LEVELS), cases[i].colors);
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void a_window_stands_in_the_caption_as_on_the_page(void **state)
{
    (void)state;
    /* the page rounds what lies exactly between two numbers up, and gives a narrow window three digits of its width */
    static const struct {
        struct scene_window window;
        const char *words, *unit;
    } cases[] = { { { 134.5, 269, 1 }, "C 135  W 269 HU", "HU" },
                  { { -134.5, 268.5, 1 }, "C \u2212135  W 269 HU", "HU" },
                  { { 1.45, 1000, 1 }, "C 1  W 1000 HU", "HU" },
                  { { 0.5, 2.125, 1 }, "C 0.50  W 2.13 HU", "HU" },
                  { { 0.0213, 0.045, 1 }, "C 0.0213  W 0.0450 HU", "HU" },
                  { { 40, 400, 1.4 }, "C 40  W 400 HU  gamma 1.4", "HU" },
                  { { 5, 10, 1 }, "C 5  W 10 g/mL (SUV)", "GML" },
                  { { 5, 10, 1 }, "C 5  W 10 Bq/mL", "BQML" },
                  { { 5, 10, 1 }, "C 5  W 10", "NONE" },
                  { { 5, 10, 1 }, "C 5  W 10 \u201cXYZ_9\u201d", "XYZ_9" } };
    struct plan *plan = made_plan_in_hu();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene scene;
        struct error err = { 0 };
        char date[ANNOTATE_DATE_SIZE] = "", field[128];
        scene_for_plan(plan, &scene);
        scene.image.window = cases[i].window;
        snprintf(plan->images[0].unit, sizeof plan->images[0].unit, "%s", cases[i].unit);
        scene.image.slices.axial.position_mm = -4.25;
        struct view view = view_default;
        view.kind = SCENE_KIND_AXIAL;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 12, field, &err);
        assert_non_null(snapshot);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, date, &err));
        char expected[128];
        snprintf(expected, sizeof expected, "Axial|S \u22124.3 mm|Planning, CT|%s", cases[i].words);
        assert_string_equal(row_text(&words, ANNOTATION_PANE), expected);
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void an_oblique_pane_and_a_blended_image_are_described(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    struct grid grid = plan->images[0].volume->grid;
    struct scene scene;
    struct error err = { 0 };
    char date[ANNOTATE_DATE_SIZE] = "", field[128];
    made_plan_add_image(plan, &grid, VOXEL_I16, height);
    (void)snprintf(plan->images[1].name, sizeof plan->images[1].name, "Uptake");
    (void)snprintf(plan->images[1].modality, sizeof plan->images[1].modality, "PT");
    (void)snprintf(plan->images[1].unit, sizeof plan->images[1].unit, "SUV");
    plan->images[1].window_center = 5;
    plan->images[1].window_width = 10;
    for (int is_named = 0; is_named < 2; is_named++)
        for (int is_pane = 0; is_pane < 2; is_pane++) {
            scene_for_plan(plan, &scene);
            scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
            scene.image.window = (struct scene_window){ 40, 400, 1 };
            scene.image.slices.axial.position_mm = 3;
            scene.image.obliques = mem_new(sizeof *scene.image.obliques);
            scene.image.n_obliques = 1;
            scene.image.obliques[0] = (struct scene_oblique_entry){ .id = "a", .value = scene_oblique_default };
            struct scene_oblique *oblique = &scene.image.obliques[0].value;
            (void)snprintf(oblique->name, sizeof oblique->name, "%s", is_named ? "Along the beam" : "");
            oblique->visible = true;
            oblique->origin_mm = vec3(1, -2.25, 3);
            oblique->normal = vec3(0, 3, -4); /* turned to the side of the nearest slice's normal, that of axial */
            (void)snprintf(scene.image.blend.id, sizeof scene.image.blend.id, "%s", plan->images[1].id);
            scene.image.blend.opacity = 0.4;
            scene.image.color_map = SCENE_COLOR_MAP_RAINBOW;
            scene.image.looks = mem_new(sizeof *scene.image.looks);
            scene.image.n_looks = is_named ? 1 : 0;
            scene.image.looks[0].value = (struct scene_image_look){ { 3, 6, 1 }, SCENE_COLOR_MAP_HOT_IRON };
            (void)snprintf(scene.image.looks[0].id, sizeof scene.image.looks[0].id, "%s", plan->images[1].id);
            struct view view = view_default;
            view.kind = is_pane ? SCENE_KIND_OBLIQUE : SCENE_KIND_3D;
            (void)snprintf(view.plane, sizeof view.plane, "a");
            struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 12, field, &err);
            assert_non_null(snapshot);
            struct annotations words;
            char expected[512];
            assert_true(annotations_describe(&words, snapshot, 512, date, &err));
            snprintf(expected, sizeof expected,
                     "%s%s|through L 1.0  P \u22122.3  S 3.0 mm|normal L 0.00  P \u22120.60  S 0.80|"
                     "Planning, CT|C 40  W 400 HU|in rainbow colours|40 %% Uptake, PT over it: %s",
                     is_pane ? "Oblique|" : "3-D|perspective, no scale|slice S 3.0 mm|slice ",
                     is_named ? "Along the beam" : "a", is_named ? "C 3.00  W 6.00 SUV, in hot iron" : "C 5  W 10 SUV");
            assert_string_equal(row_text(&words, ANNOTATION_PANE), expected);
            assert_string_equal(words.letters.left, is_pane ? "R" : words.letters.left);
            if (is_pane) { /* up: anterior as far as it lies in the plane, (0, -0.8, -0.6) */
                assert_string_equal(words.letters.top, "AI");
                assert_string_equal(words.letters.bottom, "PS");
            }
            annotations_finish(&words);
            snapshot_unref(snapshot);
        }
    plan_and_derived_destroy(plan);
}

static void cuts_caps_and_the_volume_are_described(void **state)
{
    (void)state;
    struct plan *plan = made_plan_in_hu();
    char date[ANNOTATE_DATE_SIZE] = "", field[128];
    for (int is_pane = 0; is_pane < 2; is_pane++) {
        struct scene scene;
        struct error err = { 0 };
        scene_for_plan(plan, &scene);
        scene.image.window = (struct scene_window){ 40, 400, 1 };
        scene.image.slices.axial.visible = false;
        scene.regions[1].value.clipped = false;
        scene.clip.axial_high = (struct scene_clip_axis){ true, 12, true };
        scene.clip.coronal_low = (struct scene_clip_axis){ true, -3.5, false };
        scene.clip.sagittal_low = (struct scene_clip_axis){ true, 7, true };
        scene.clip.free = (struct scene_clip_free){ true, vec3(1, 2, 3), vec3(0, -3, -4), true };
        scene.clip.cap.outlines = true;
        scene.image.volume.visible = true;
        scene.image.volume.method = SCENE_VOLUME_METHOD_MIP;
        scene.image.volume.clipped = false;
        struct view view = view_default;
        view.kind = is_pane ? SCENE_KIND_AXIAL : SCENE_KIND_3D;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 12, field, &err);
        assert_non_null(snapshot);
        struct annotations words;
        assert_true(annotations_describe(&words, snapshot, 512, date, &err));
        /* only the 3-D picture is cut */
        assert_string_equal(row_text(&words, ANNOTATION_METHODS),
                            is_pane ? "Outlines: of the surfaces"
                                    : "Surfaces: smooth|Volume: largest value along each ray|"
                                      "Cut off: superior to S 12.0 mm|anterior to P \u22123.5 mm, without cap|"
                                      "right of L 7.0 mm|above the plane through L 1.0  P 2.0  S 3.0 mm, "
                                      "normal L 0.00  P \u22120.60  S \u22120.80|Not cut: high|volume|"
                                      "Caps: image, outlines");
        /* the volume and the caps show the image */
        assert_non_null(strstr(row_text(&words, ANNOTATION_PANE), "Planning, CT|C 40  W 400 HU"));
        annotations_finish(&words);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void letters_are_dark_where_the_background_of_a_3d_view_is_light(void **state)
{
    (void)state;
    static const struct {
        uint32_t rgb;
        bool is_light; /* relative luminance by hand: 0.0027, 0.162, 0.216, 0.236, 1 against 0.179 */
    } grounds[] = {
        { 0x08090b, false }, { 0x707070, false }, { 0x808080, true }, { 0xff3300, true }, { 0xffffff, true }
    };
    struct plan *plan = made_plan_in_hu();
    for (size_t i = 0; i < sizeof grounds / sizeof grounds[0]; i++)
        for (int pane = 0; pane < 2; pane++) {
            struct scene scene;
            struct view view = view_default;
            struct annotations words;
            struct error err = { 0 };
            char field[128];
            scene_for_plan(plan, &scene);
            scene.space.background_rgb = grounds[i].rgb;
            view.kind = pane ? SCENE_KIND_AXIAL : SCENE_KIND_3D;
            struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
            assert_non_null(snapshot);
            assert_true(annotations_describe(&words, snapshot, 512, "", &err));
            assert_int_equal(words.is_on_light, grounds[i].is_light && !pane);
            annotations_finish(&words);
            snapshot_unref(snapshot);
        }
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_snapshot_is_described),
        cmocka_unit_test(a_patient_who_was_stated_has_beside_it_who_said_so_and_when_as_long_as_that_counts),
        cmocka_unit_test(words_of_the_asker_stand_below_the_title_item_by_item),
        cmocka_unit_test(a_dose_is_described_with_what_it_lacks_and_its_levels),
        cmocka_unit_test(a_sum_of_beams_is_called_per_none_of_them),
        cmocka_unit_test(a_highlighted_part_is_described_with_its_limits_its_univels_and_its_weights),
        cmocka_unit_test(a_comparison_is_described_with_its_colours_in_place_of_the_levels),
        cmocka_unit_test(a_window_stands_in_the_caption_as_on_the_page),
        cmocka_unit_test(an_oblique_pane_and_a_blended_image_are_described),
        cmocka_unit_test(cuts_caps_and_the_volume_are_described),
        cmocka_unit_test(letters_are_dark_where_the_background_of_a_3d_view_is_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
