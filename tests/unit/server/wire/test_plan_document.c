/* The plan document: a plan as JSON for page and API. */
#include "server/wire/plan_document.h"

#include "server/wire/plan_origins.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static struct volume *make_volume(enum voxel_type type)
{
    /* 2 x 3 x 4 voxels of 1, 2, 3 mm; i to the left, j to the back, k down */
    struct affine map = { { { 1, 0, 0 }, { 0, 2, 0 }, { 0, 0, -3 } }, { 10, 20, 30 } };
    return layer_make(2, 3, 4, type, &map);
}

static void assert_json_point(const cJSON *point, double x, double y, double z)
{
    assert_int_equal(cJSON_GetArraySize(point), 3);
    assert_close(cJSON_GetArrayItem(point, 0)->valuedouble, x, 1e-12);
    assert_close(cJSON_GetArrayItem(point, 1)->valuedouble, y, 1e-12);
    assert_close(cJSON_GetArrayItem(point, 2)->valuedouble, z, 1e-12);
}

static const cJSON *item(const cJSON *object, const char *name)
{
    const cJSON *found = cJSON_GetObjectItemCaseSensitive(object, name);
    if (!found)
        fail_msg("'%s' is absent", name);
    return found;
}

static void a_plan_is_told_with_units_and_null_where_nothing_is_known(void **state)
{
    (void)state;
    struct plan plan = { .id = "head", .name = "Head \"1\"", .is_phantom = true, .load_us = 1500 };
    plan.bounds_lps_mm = plan.body_lps_mm = box3_empty();
    plan.n_images = 1;
    plan.images[0] =
        (struct plan_image){ .id = "ct", .modality = "CT", .unit = "HU", .window_center = 40, .window_width = 400 };
    plan.images[0].volume = make_volume(VOXEL_I16);
    plan.images[0].volume->low = -1000;
    struct region regions[2] = {
        { .id = "skin",
          .name = "Skin",
          .rgb = { 1, 2, 255 },
          .parent = -1,
          .label = 1,
          .n_voxels = 5,
          .volume_cm3 = 0.03 },
        { .id = "gone", .name = "Gone", .parent = 0, .label = 2 },
    };
    for (int i = 0; i < 2; i++)
        regions[i].cbe_boron = regions[i].rbe_nitrogen = regions[i].rbe_fast = regions[i].rbe_gamma = NAN;
    regions[0].boron_ratio = 1.5;
    regions[1].boron_ratio = NAN;
    regions[0].high_ijk[2] = 1;
    plan.regions.layers[0] = make_volume(VOXEL_U8);
    plan.regions.n_layers = 1;
    plan.regions.regions = regions;
    plan.regions.n_regions = 2;
    plan.regions.hierarchy = HIERARCHY_DERIVED;
    plan.n_beams = 1;
    plan.beams[0] = (struct beam){ .id = "b", .entry_lps_mm = { 1, 2, 3 }, .aperture_mm = NAN };

    cJSON *document = plan_document(&plan);
    assert_string_equal(item(document, "id")->valuestring, "head");
    assert_true(cJSON_IsTrue(item(document, "is_phantom")));
    assert_close(item(document, "load_ms")->valuedouble, 1.5, 0);
    assert_true(cJSON_IsNull(item(document, "bounds_mm")));
    assert_string_equal(item(document, "hierarchy")->valuestring, "derived");

    /* axial looks from the feet up, square to the patient, at the middle of the image: (10.5, 22, 25.5) */
    const cJSON *axial = item(item(document, "home"), "axial");
    assert_string_equal(item(axial, "projection")->valuestring, "parallel");
    assert_json_point(item(axial, "target_mm"), 10.5, 22, 25.5);
    assert_json_point(item(axial, "up"), 0, -1, 0);
    assert_true(cJSON_GetArrayItem(item(axial, "position_mm"), 2)->valuedouble < 25.5);
    assert_string_equal(item(item(item(document, "home"), "3d"), "projection")->valuestring, "perspective");
    assert_int_equal(cJSON_GetArraySize(item(document, "home")), 7); /* every kind of view */

    const cJSON *image = cJSON_GetArrayItem(item(document, "images"), 0), *grid = item(image, "grid");
    assert_close(item(image, "low")->valuedouble, -1000, 0);
    assert_json_point(item(grid, "size"), 2, 3, 4);
    assert_json_point(item(grid, "spacing_mm"), 1, 2, 3);
    assert_string_equal(item(grid, "orientation")->valuestring, "LPI");
    const cJSON *last_row = cJSON_GetArrayItem(item(grid, "lps_mm_from_ijk"), 2);
    assert_int_equal(cJSON_GetArraySize(last_row), 4);
    assert_close(cJSON_GetArrayItem(last_row, 2)->valuedouble, -3, 0);
    assert_close(cJSON_GetArrayItem(last_row, 3)->valuedouble, 30, 0);
    assert_json_point(item(item(grid, "bounds_mm"), "low"), 9.5, 19, 19.5); /* k = 3.5: 30 - 10.5 */
    assert_json_point(item(item(grid, "bounds_mm"), "high"), 11.5, 25, 31.5);

    const cJSON *skin = cJSON_GetArrayItem(item(document, "regions"), 0),
                *gone = cJSON_GetArrayItem(item(document, "regions"), 1);
    assert_string_equal(item(skin, "color")->valuestring, "#0102ff");
    assert_true(cJSON_IsNull(item(skin, "parent")));
    assert_json_point(item(item(skin, "bounds_mm"), "low"), 9.5, 19, 25.5); /* voxels (0,0,0) and (0,0,1) */
    assert_json_point(item(item(skin, "bounds_mm"), "high"), 10.5, 21, 31.5);
    assert_close(item(item(skin, "tissue"), "boron_ratio")->valuedouble, 1.5, 0);
    assert_true(cJSON_IsNull(item(item(skin, "tissue"), "cbe_boron")));
    assert_string_equal(item(gone, "parent")->valuestring, "skin");
    assert_close(item(gone, "depth")->valuedouble, 1, 0);
    assert_true(cJSON_IsNull(item(gone, "center_mm")) && cJSON_IsNull(item(gone, "bounds_mm")));

    const cJSON *beam = cJSON_GetArrayItem(item(document, "beams"), 0);
    assert_json_point(item(beam, "entry_mm"), 1, 2, 3);
    assert_true(cJSON_IsNull(item(beam, "aperture_mm")));
    assert_int_equal(cJSON_GetArraySize(item(item(document, "tracks"), "classes")), TRACK_N_CLASSES);

    cJSON_Delete(document);
    volume_unref(plan.images[0].volume);
    volume_unref(plan.regions.layers[0]);
}

static void doses_tracks_and_the_report_keep_their_words(void **state)
{
    (void)state;
    struct plan plan = { .id = "p" };
    plan.bounds_lps_mm = (struct box3){ { -1, -2, -3 }, { 4, 5, 6 } };
    plan.n_doses = 1;
    plan.doses[0] = (struct dose){ .id = "d", .unit = "cGy", .per = "fraction", .n_components = 2 };
    plan.doses[0].components[0] =
        (struct dose_component){ .quantity = DOSE_BORON, .is_per_ppm = true, .values = make_volume(VOXEL_F32) };
    plan.doses[0].components[1] = (struct dose_component){ .quantity = DOSE_TOTAL, .values = make_volume(VOXEL_F32) };
    plan.doses[0].components[0].values->high = 0.25;
    plan.doses[0].components[1].has_boron_ppm = true;
    plan.doses[0].components[1].boron_ppm = 15;
    plan.doses[0].has_frame = true;
    plan.doses[0].frame = DOSE_FRAME_DIFFERS;
    plan.tracks.n_segments = 3;
    plan.tracks.n_of_class[TRACK_GAMMA_LOW] = 3;
    struct report_line line = {
        .severity = REPORT_WARNING, .code = "dose.negative", .sentence = "A sentence.", .where = "dose.nii.gz"
    };
    plan.report.lines = &line;
    plan.report.n_lines = 1;
    plan.report.n_dropped = 7;

    cJSON *document = plan_document(&plan);
    assert_json_point(item(item(document, "bounds_mm"), "high"), 4, 5, 6);
    const cJSON *dose = cJSON_GetArrayItem(item(document, "doses"), 0);
    assert_string_equal(item(dose, "unit")->valuestring, "cGy");
    assert_string_equal(item(dose, "per")->valuestring, "fraction");
    assert_true(cJSON_IsFalse(item(dose, "masked")));
    const cJSON *boron = cJSON_GetArrayItem(item(dose, "components"), 0),
                *total = cJSON_GetArrayItem(item(dose, "components"), 1);
    assert_string_equal(item(boron, "quantity")->valuestring, "boron");
    assert_true(cJSON_IsTrue(item(boron, "per_ppm")) && cJSON_IsFalse(item(total, "per_ppm")));
    assert_close(item(boron, "high")->valuedouble, 0.25, 0);
    assert_true(cJSON_IsNull(item(boron, "boron_ppm")));
    assert_close(item(total, "boron_ppm")->valuedouble, 15, 0);
    assert_string_equal(item(dose, "frame_of_reference")->valuestring, "differs");
    assert_string_equal(item(total, "quantity")->valuestring, "total");
    assert_close(item(item(item(document, "tracks"), "classes"), "gamma-low")->valuedouble, 3, 0);
    const cJSON *looks = item(item(document, "tracks"), "looks"), *look = cJSON_GetArrayItem(looks, 0);
    assert_int_equal(cJSON_GetArraySize(looks), 1); /* of the classes with segments */
    assert_string_equal(item(look, "class")->valuestring, "gamma-low");
    assert_string_equal(item(look, "color")->valuestring, "#ccaca5");
    assert_close(cJSON_GetArrayItem(item(look, "dash_px"), 1)->valuedouble, 3, 0);
    assert_true(cJSON_IsFalse(item(look, "has_cross")));
    const cJSON *colors = item(item(document, "tracks"), "colors");
    assert_int_equal(cJSON_GetArraySize(colors), TRACK_N_CLASSES);
    assert_string_equal(item(colors, "lost")->valuestring, "#ffffff");
    assert_string_equal(item(colors, "beam-line")->valuestring, "#f4f6f8");
    const cJSON *told = cJSON_GetArrayItem(item(item(document, "report"), "lines"), 0);
    assert_string_equal(item(told, "severity")->valuestring, "warning");
    assert_string_equal(item(told, "code")->valuestring, "dose.negative");
    assert_string_equal(item(told, "where")->valuestring, "dose.nii.gz");
    assert_string_equal(item(told, "sentence")->valuestring, "A sentence.");
    assert_close(item(item(document, "report"), "dropped")->valuedouble, 7, 0);

    cJSON_Delete(document);
    volume_unref(plan.doses[0].components[0].values);
    volume_unref(plan.doses[0].components[1].values);
}

static void set(char *out, size_t size, const char *text)
{
    snprintf(out, size, "%s", text);
}

/* Image and regions of patient 0 and frame a, a dose of patient 1 and frame b. */
static struct plan *origins_plan(void)
{
    struct plan *plan = plan_create("p");
    struct plan_patient *anna = &plan->patients[0], *bert = &plan->patients[1];
    set(anna->id, sizeof anna->id, "88-20417");
    set(anna->name, sizeof anna->name, "Voss^Anna");
    set(anna->birth_date, sizeof anna->birth_date, "19610412");
    set(bert->id, sizeof bert->id, "99");
    set(bert->birth_date, sizeof bert->birth_date, "1950");
    plan->n_patients = 2;
    set(plan->treatment_plans[0].label, 65, "BNCT-1");
    set(plan->treatment_plans[1].label, 65, "BNCT-2");
    set(plan->treatment_plans[1].approval, 17, "APPROVED");
    set(plan->treatment_plans[1].structs_uid, 66, "1.5");
    set(plan->treatment_plans[0].structs_uid, 66, "1.6");
    plan->treatment_plans[0].prescription_gy = NAN;
    plan->treatment_plans[1].prescription_gy = 60;
    plan->treatment_plans[0].patient = -1;
    plan->n_treatment_plans = 2;
    plan->n_images = 1;
    plan->images[0].volume = make_volume(VOXEL_I16);
    plan->image_origins[0].patient = 0;
    set(plan->image_origins[0].frame_uid, 66, "1.1");
    plan->n_doses = 1;
    plan->dose_origins[0].patient = 1;
    set(plan->dose_origins[0].frame_uid, 66, "1.2");
    set(plan->dose_origins[0].plan_uid, 66, "1.9");
    plan->n_beams = 1;
    plan->beam_origins[0].treatment_plan = 1;
    set(plan->beam_origins[0].plan_uid, 66, "1.8");
    set(plan->beam_origins[0].frame_uid, 66, "1.1");
    plan->region_origins = calloc(1, sizeof *plan->region_origins);
    assert_non_null(plan->region_origins);
    plan->region_origins[0] = plan->image_origins[0];
    set(plan->region_origins[0].structs_uid, 66, "1.5");
    plan->n_region_origins = 1;
    plan->regions.layers[0] = make_volume(VOXEL_U8);
    plan->regions.n_layers = 1;
    plan->regions.regions = calloc(2, sizeof *plan->regions.regions);
    assert_non_null(plan->regions.regions);
    plan->regions.n_regions = 2;
    for (int i = 0; i < 2; i++)
        plan->regions.regions[i] = (struct region){ .parent = -1, .label = 1, .origin = i == 0 };
    return plan;
}

static int index_in(const cJSON *object, const char *name)
{
    const cJSON *found = item(object, name);
    return cJSON_IsNull(found) ? -1 : found->valueint;
}

static void each_part_says_whose_it_is_and_patients_are_masked(void **state)
{
    (void)state;
    struct plan *plan = origins_plan();
    cJSON *document = plan_document(plan);
    const cJSON *patients = item(document, "patients"), *plans = item(document, "treatment_plans");
    assert_int_equal(cJSON_GetArraySize(patients), 2);
    assert_string_equal(item(cJSON_GetArrayItem(patients, 0), "masked")->valuestring, "A. V. \u2026417");
    assert_string_equal(item(cJSON_GetArrayItem(patients, 1), "masked")->valuestring, "\u20269");
    assert_int_equal(cJSON_GetArraySize(plans), 2);
    assert_int_equal(index_in(document, "shown_plan"), 1);
    assert_int_equal(index_in(document, "shown_patient"), 0); /* plan 1's */
    assert_int_equal(index_in(cJSON_GetArrayItem(plans, 0), "structs"), -1);
    assert_true(cJSON_IsTrue(item(cJSON_GetArrayItem(plans, 0), "is_structs_absent")));
    assert_int_equal(index_in(cJSON_GetArrayItem(plans, 1), "structs"), 0);
    assert_true(cJSON_IsNull(item(cJSON_GetArrayItem(plans, 0), "prescription_gy")));

    static const struct {
        const char *list;
        int nth, patient, plan, is_absent, frame;
    } expected[] = { { "images", 0, 0, -1, 0, 0 },
                     { "doses", 0, 1, -1, 1, 1 },
                     { "beams", 0, -1, 1, 0, 0 },
                     { "regions", 0, 0, -1, 0, 0 },
                     { "regions", 1, -1, -1, 0, -1 } };
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        const cJSON *part = cJSON_GetArrayItem(item(document, expected[i].list), expected[i].nth);
        assert_int_equal(index_in(part, "patient"), expected[i].patient);
        assert_int_equal(index_in(part, "plan"), expected[i].plan);
        assert_int_equal(cJSON_IsTrue(item(part, "is_plan_absent")), expected[i].is_absent);
        assert_int_equal(index_in(part, "frame"), expected[i].frame);
        assert_int_equal(index_in(part, "study"), -1);
    }
    char *text = json_write(document);
    static const char *const secrets[] = { "Voss", "Anna", "88-20417", "19610412", "1961" };
    for (size_t i = 0; i < sizeof secrets / sizeof secrets[0]; i++)
        assert_null(strstr(text, secrets[i]));
    free(text);
    cJSON_Delete(document);

    cJSON *identity = plan_identity(plan);
    const cJSON *first = cJSON_GetArrayItem(item(identity, "patients"), 0);
    assert_string_equal(item(first, "name")->valuestring, "Voss^Anna");
    assert_string_equal(item(first, "id")->valuestring, "88-20417");
    assert_string_equal(item(first, "birth_date")->valuestring, "1961-04-12");
    assert_string_equal(item(cJSON_GetArrayItem(item(identity, "patients"), 1), "birth_date")->valuestring, "1950");
    cJSON_Delete(identity);
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_part_says_whose_it_is_and_patients_are_masked),
        cmocka_unit_test(a_plan_is_told_with_units_and_null_where_nothing_is_known),
        cmocka_unit_test(doses_tracks_and_the_report_keep_their_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
