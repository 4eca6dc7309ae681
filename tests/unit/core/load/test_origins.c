/* Origins of a plan's parts: patients, frames of reference, treatment plans, structure sets. */
#include "core/load/cache.h"
#include "core/load/load.h"
#include "core/plan/beam_doses.h"
#include "core/scene/dose_choice.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_parts.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/same_plan.h"

static const struct made_owner anna = {
    .id = "88-20417", .name = "Voss^Anna", .birth_date = "19610412", .study = "1.2.31", .frame = "1.2.41"
};
static const struct made_owner bert = { .id = "99", .name = "Ruf^Bert", .study = "1.2.32", .frame = "1.2.42" };

static struct plan *open_plan(const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    return plan;
}

/* CT, structure set, plan and dose of Anna, and a dose of Bert. */
static void put_case(const char *folder)
{
    made_part_images(folder, "ct", &anna, "1.2.51", 4);
    made_part_structs(folder, "structs.dcm", &anna, "1.2.61", "1.2.51");
    made_part_plan(folder, "plan.dcm", &anna,
                   &(struct made_part_plan){ .uid = "1.2.71",
                                             .structs_uid = "1.2.61",
                                             .label = "BNCT-2",
                                             .date = "20261101",
                                             .approval = "APPROVED",
                                             .beams = { "Front" } });
    made_part_dose(folder, "dose.dcm", &anna,
                   &(struct made_part_dose){ .uid = "1.2.81", .plan_uid = "1.2.71", .summation = "PLAN" });
    made_part_dose(folder, "other.dcm", &bert,
                   &(struct made_part_dose){ .uid = "1.2.82", .plan_uid = "1.2.79", .summation = "PLAN" });
}

static void every_part_says_where_it_comes_from(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put_case(folder);
    struct plan *plan = open_plan(folder);
    assert_int_equal(plan->n_patients, 2);
    assert_string_equal(plan->patients[0].id, "88-20417");
    assert_string_equal(plan->patients[0].name, "Voss^Anna");
    assert_string_equal(plan->patients[0].birth_date, "19610412");
    assert_false(plan->patients[0].has_conflict);
    assert_string_equal(plan->patients[1].id, "99");

    assert_int_equal(plan->n_treatment_plans, 1);
    assert_string_equal(plan->treatment_plans[0].uid, "1.2.71");
    assert_string_equal(plan->treatment_plans[0].structs_uid, "1.2.61");
    assert_string_equal(plan->treatment_plans[0].label, "BNCT-2");
    assert_string_equal(plan->treatment_plans[0].date, "20261101");
    assert_string_equal(plan->treatment_plans[0].approval, "APPROVED");
    assert_string_equal(plan->treatment_plans[0].review_date, "20261112");
    assert_string_equal(plan->treatment_plans[0].reviewer, "Reviewer^R");
    assert_int_equal(plan->treatment_plans[0].patient, 0);

    assert_int_equal(plan->n_images, 1);
    assert_int_equal(plan->image_origins[0].patient, 0);
    assert_int_equal(plan->image_origins[0].treatment_plan, -1);
    assert_string_equal(plan->image_origins[0].frame_uid, "1.2.41");
    assert_string_equal(plan->image_origins[0].study_uid, "1.2.31");
    assert_string_equal(plan->image_origins[0].series_uid, "1.2.51");
    assert_string_equal(plan->image_origins[0].path, "ct0.dcm");

    assert_int_equal(plan->regions.n_regions, 1);
    assert_int_equal(plan->regions.regions[0].origin, 1);
    assert_int_equal(plan->n_region_origins, 1);
    assert_string_equal(plan->region_origins[0].structs_uid, "1.2.61");
    assert_string_equal(plan->region_origins[0].series_uid, "1.2.51");
    assert_string_equal(plan->region_origins[0].frame_uid, "1.2.41");
    assert_int_equal(plan->region_origins[0].patient, 0);

    assert_int_equal(plan->n_beams, 1);
    assert_int_equal(plan->beam_origins[0].treatment_plan, 0);
    assert_int_equal(plan->beam_origins[0].patient, 0);
    assert_string_equal(plan->beam_origins[0].frame_uid, "1.2.41"); /* that of the structure set */
    assert_string_equal(plan->beam_origins[0].structs_uid, "1.2.61");

    assert_int_equal(plan->n_doses, 2);
    assert_int_equal(plan->dose_origins[0].patient, 0);
    assert_int_equal(plan->dose_origins[0].treatment_plan, 0);
    assert_string_equal(plan->dose_origins[0].frame_uid, "1.2.41");
    assert_int_equal(plan->dose_origins[1].patient, 1);
    assert_int_equal(plan->dose_origins[1].treatment_plan, -1);
    assert_string_equal(plan->dose_origins[1].plan_uid, "1.2.79");
    assert_string_equal(plan->dose_origins[1].frame_uid, "1.2.42");
    assert_int_equal(plan->tracks_origin.patient, -1);
    plan_destroy(plan);
    folder_remove(folder);
}

static void a_kept_plan_knows_the_same_origins(void **state)
{
    (void)state;
    char folder[256], cache[256];
    struct error err = { 0 };
    struct plan_sources *sources;
    folder_make(folder);
    folder_make(cache);
    put_case(folder);
    struct plan *first =
        plan_load(folder, "p", &(struct plan_load_options){ .cache_folder = cache, .sources = &sources }, &err);
    assert_string_equal(err.text, "");
    assert_true(plan_cache_store(first, sources, cache, &err));
    struct plan *again = plan_load(folder, "p", &(struct plan_load_options){ .cache_folder = cache }, &err);
    assert_true(again->is_from_cache);
    assert_same_plan(again, first, 0);
    assert_same_origins(again, first);
    plan_destroy(first);
    plan_destroy(again);
    plan_sources_destroy(sources);
    folder_remove(folder);
    folder_remove(cache);
}

/* Opens a CT and a dose of two owners, and tells their patients: 0 and 0, or 0 and 1. */
static void assert_patients(const struct made_owner *of_image, const struct made_owner *of_dose, bool is_same,
                            bool has_conflict)
{
    char folder[256];
    folder_make(folder);
    made_part_images(folder, "ct", of_image, "1.2.51", 2);
    made_part_dose(folder, "dose.dcm", of_dose, &(struct made_part_dose){ .uid = "1.2.81", .summation = "PLAN" });
    struct plan *plan = open_plan(folder);
    assert_int_equal(plan->n_patients, is_same ? 1 : 2);
    assert_int_equal(plan->image_origins[0].patient, 0);
    assert_int_equal(plan->dose_origins[0].patient, is_same ? 0 : 1);
    assert_int_equal(plan->patients[0].has_conflict, has_conflict);
    if (!is_same)
        assert_int_equal(plan->patients[1].has_conflict, has_conflict);
    plan_destroy(plan);
    folder_remove(folder);
}

static void patients_are_told_apart_by_id_name_and_birth_date(void **state)
{
    (void)state;
    static const struct {
        struct made_owner a, b;
        bool is_same, has_conflict;
    } pairs[] = {
        { { .id = "1", .name = "Voss^Anna" }, { .id = "1", .name = "VOSS^ANNA^^^" }, true, false },
        { { .id = "1", .name = "Voss^Anna" }, { .id = "1", .name = "Voss Anna" }, true, false },
        { { .id = "1", .name = "Voss^Anna" }, { .id = "1" }, true, false },
        { { .id = "1" }, { .id = "1", .name = "Voss^Anna", .birth_date = "19610412" }, true, false },
        { { .id = "1", .name = "Voss^Anna=\xe7\x8e\x8b^\xe5\xb0\x8f" },
          { .id = "1", .name = "Voss^Anna" },
          true,
          false },
        { { .id = "1", .name = "Voss^Anna=\xe7\x8e\x8b" }, { .id = "1", .name = "=\xe7\x8e\x8b" }, true, false },
        { { .id = "1", .birth_date = "1961.04.12" }, { .id = "1", .birth_date = "19610412" }, true, false },
        { { .id = "1", .name = "Voss^Anna" }, { .id = "1", .name = "Ruf^Bert" }, false, true },
        { { .id = "1", .birth_date = "19610412" }, { .id = "1", .birth_date = "19610413" }, false, true },
        { { .id = "1", .name = "Voss^Anna" }, { .id = "2", .name = "Voss^Anna" }, false, false },
        { { .id = "1", .name = "Voss^Anna" }, { .name = "Voss^Anna" }, false, false },
        { { .name = "Voss^Anna" }, { .name = "voss^anna" }, true, false },
        { { .name = "Voss^Anna" }, { .name = "Ruf^Bert" }, false, false },
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        struct made_owner a = pairs[i].a, b = pairs[i].b;
        a.study = b.study = "1.2.31";
        a.frame = b.frame = "1.2.41";
        assert_patients(&a, &b, pairs[i].is_same, pairs[i].has_conflict);
    }
}

static void slices_of_two_patients_make_two_images(void **state)
{
    (void)state;
    char folder[256];
    struct made_owner other = anna;
    other.id = "77-1";
    folder_make(folder);
    made_part_images(folder, "a", &anna, "1.2.51", 4);
    made_part_images(folder, "b", &other, "1.2.51", 3); /* the same series and frame of reference */
    struct plan *plan = open_plan(folder);
    assert_int_equal(plan->n_images, 2);
    assert_int_equal(plan->images[0].volume->grid.size[2], 4);
    assert_int_equal(plan->image_origins[0].patient, 0);
    assert_int_equal(plan->image_origins[1].patient, 1);
    plan_destroy(plan);
    folder_remove(folder);
}

static void files_without_a_patient_are_of_none(void **state)
{
    (void)state;
    char folder[256];
    const struct made_owner nobody = { .id = "", .name = "^^", .study = "1.2.31", .frame = "1.2.41" };
    folder_make(folder);
    made_part_images(folder, "ct", &nobody, "1.2.51", 2);
    struct plan *plan = open_plan(folder);
    assert_int_equal(plan->n_patients, 0);
    assert_int_equal(plan->image_origins[0].patient, -1);
    plan_destroy(plan);
    folder_remove(folder);
}

static const char *said(const struct plan *plan, const char *code)
{
    return report_said(&plan->report, code);
}

static void patients_that_are_masked_alike_are_told_apart_in_words(void **state)
{
    (void)state;
    char folder[256];
    const struct made_owner one = { .id = "A1", .name = "Eins^A", .study = "1.2.31", .frame = "1.2.41" };
    const struct made_owner other = { .id = "B1", .name = "Eins^A", .study = "1.2.32", .frame = "1.2.42" };
    folder_make(folder);
    made_part_images(folder, "ct", &one, "1.2.51", 2);
    made_part_images(folder, "other", &other, "1.2.52", 2);
    struct plan *plan = open_plan(folder);
    assert_int_equal(plan->n_patients, 2);
    assert_non_null(strstr(said(plan, "patient.several"), "written alike here differ in ID, its issuer"));
    plan_destroy(plan);
    folder_remove(folder);
}

static void the_report_names_patients_masked(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put_case(folder);
    struct plan *plan = open_plan(folder);
    assert_string_equal(said(plan, "patient.several"),
                        "This folder holds files of 2 patients: A. V. \u2026417 and B. R. \u20269. Shown is A. V. "
                        "\u2026417; parts of the others are not used.");
    assert_false(report_has(&plan->report, "patient.conflict"));
    assert_false(report_has(&plan->report, "patient.none"));
    assert_string_equal(said(plan, "dose.plan-absent"),
                        "The dose \"plan not here, Dose\" refers to a treatment plan (RTPLAN) that is not in this "
                        "folder.");
    assert_false(report_has(&plan->report, "plan.structs-absent"));
    for (size_t i = 0; i < plan->report.n_lines; i++) {
        const char *sentence = plan->report.lines[i].sentence;
        static const char *const secrets[] = { "Voss", "Anna", "Ruf", "Bert", "20417", "1961" };
        for (size_t s = 0; s < sizeof secrets / sizeof secrets[0]; s++)
            assert_null(strstr(sentence, secrets[s]));
    }
    plan_destroy(plan);
    folder_remove(folder);
}

static void a_conflict_a_missing_identity_and_an_absent_structure_set_are_said(void **state)
{
    (void)state;
    char folder[256];
    struct made_owner other = anna;
    const struct made_owner nobody = { .study = "1.2.31", .frame = "1.2.41" };
    other.birth_date = "19610413";
    folder_make(folder);
    made_part_images(folder, "ct", &anna, "1.2.51", 2);
    made_part_plan(folder, "plan.dcm", &anna,
                   &(struct made_part_plan){ .uid = "1.2.71", .structs_uid = "1.2.69", .label = "BNCT-2" });
    made_part_structs(folder, "structs.dcm", &anna, "1.2.61", "1.2.51");
    made_part_dose(folder, "a.dcm", &other, &(struct made_part_dose){ .uid = "1.2.81", .summation = "PLAN" });
    made_part_dose(folder, "b.dcm", &nobody, &(struct made_part_dose){ .uid = "1.2.82", .summation = "PLAN" });
    struct plan *plan = open_plan(folder);
    assert_non_null(strstr(said(plan, "patient.conflict"), "A. V. \u2026417 and A. V. \u2026417"));
    assert_non_null(strstr(said(plan, "patient.none"), "1 part of the plan names no patient"));
    assert_non_null(strstr(said(plan, "plan.structs-absent"), "\"BNCT-2\""));
    plan_destroy(plan);
    folder_remove(folder);

    folder_make(folder);
    made_part_images(folder, "ct", &nobody, "1.2.51", 2);
    plan = open_plan(folder);
    assert_string_equal(said(plan, "patient.none"), "No patient identity in these files.");
    plan_destroy(plan);
    folder_remove(folder);
}

static void put_two_plans(const char *folder, const char *label_a, const char *label_b, const char *date_b)
{
    made_part_images(folder, "ct", &anna, "1.2.51", 2);
    made_part_plan(folder, "pa.dcm", &anna,
                   &(struct made_part_plan){
                       .uid = "1.2.71", .label = label_a, .date = "20261101", .beams = { "B1" } });
    made_part_plan(folder, "pb.dcm", &anna,
                   &(struct made_part_plan){
                       .uid = "1.2.72", .label = label_b, .date = date_b, .approval = "APPROVED", .beams = { "B1" } });
    made_part_dose(folder, "da.dcm", &anna,
                   &(struct made_part_dose){ .uid = "1.2.81", .plan_uid = "1.2.71", .summation = "PLAN" });
    made_part_dose(folder, "db.dcm", &anna,
                   &(struct made_part_dose){
                       .uid = "1.2.82", .plan_uid = "1.2.72", .summation = "PLAN", .scaling = "0.25" });
}

static void doses_and_beams_named_alike_are_told_apart_by_their_plans(void **state)
{
    (void)state;
    static const struct {
        const char *labels[2], *date, *doses[2], *ids[2], *beams[2];
    } cases[] = {
        /* the approved plan is the second one: its dose comes first */
        { { "planA", "planB" },
          "20261102",
          { "planB, Dose", "planA, Dose" },
          { "planb-dose", "plana-dose" },
          { "planA, B1", "planB, B1" } },
        { { "P", "P" },
          "20261102",
          { "P, Dose, 2026-11-02", "P, Dose, 2026-11-01" },
          { "p-dose-2026-11-02", "p-dose-2026-11-01" },
          { "P, B1, 2026-11-01", "P, B1, 2026-11-02" } },
        { { "P", "P" },
          "20261101",
          { "P, Dose, 2026-11-01, db.dcm", "P, Dose, 2026-11-01, da.dcm" },
          { "p-dose-2026-11-01-db-dcm", "p-dose-2026-11-01-da-dcm" },
          { "P, B1, 2026-11-01, pa.dcm", "P, B1, 2026-11-01, pb.dcm" } },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[256];
        folder_make(folder);
        put_two_plans(folder, cases[i].labels[0], cases[i].labels[1], cases[i].date);
        struct plan *plan = open_plan(folder);
        assert_int_equal(plan->n_doses, 2);
        assert_int_equal(plan->n_beams, 2);
        for (int p = 0; p < 2; p++) {
            assert_string_equal(plan->doses[p].name, cases[i].doses[p]);
            assert_string_equal(plan->doses[p].id, cases[i].ids[p]);
            assert_int_equal(plan->dose_origins[p].treatment_plan, 1 - p);
            assert_string_equal(plan->beams[p].name, cases[i].beams[p]);
            assert_int_equal(plan->beam_origins[p].treatment_plan, p);
        }
        assert_close(plan->doses[0].components[0].values->high, 8 * 0.25, 1e-6);
        plan_destroy(plan);
        folder_remove(folder);
    }
}

static void the_first_dose_is_that_of_the_whole_plan(void **state)
{
    (void)state;
    char folder[256];
    struct made_part_dose beam1 = { .uid = "1.2.81", .plan_uid = "1.2.71", .summation = "BEAM", .beam = 1 },
                          beam2 = { .uid = "1.2.82", .plan_uid = "1.2.71", .summation = "BEAM", .beam = 2 },
                          fraction = { .uid = "1.2.83", .plan_uid = "1.2.71", .summation = "FRACTION" },
                          whole = { .uid = "1.2.84", .plan_uid = "1.2.71", .summation = "PLAN" },
                          others = { .uid = "1.2.85", .summation = "PLAN", .description = "Old" };
    folder_make(folder);
    made_part_images(folder, "ct", &anna, "1.2.51", 2);
    made_part_plan(folder, "plan.dcm", &anna,
                   &(struct made_part_plan){ .uid = "1.2.71", .label = "P", .beams = { "B1", "B2" } });
    made_part_dose(folder, "a.dcm", &bert, &(struct made_part_dose){ .uid = "1.2.80", .summation = "PLAN" });
    made_part_dose(folder, "b.dcm", &anna, &others);
    made_part_dose(folder, "c.dcm", &anna, &beam1);
    made_part_dose(folder, "d.dcm", &anna, &beam2);
    made_part_dose(folder, "e.dcm", &anna, &fraction);
    made_part_dose(folder, "f.dcm", &anna, &whole);
    struct plan *plan = open_plan(folder);
    static const char *const files[] = { "f.dcm", "c.dcm", "d.dcm", "e.dcm", "b.dcm", "a.dcm" };
    assert_int_equal(plan->n_doses, 6);
    for (int d = 0; d < 6; d++)
        assert_string_equal(plan->dose_origins[d].path, files[d]);
    plan_destroy(plan);
    folder_remove(folder);
}

/* A plan of two beams with a dose of a fraction, and doses of beams: by the file's name, of beam `beams[i]`. */
static struct plan *open_beam_doses(const int *beams, const char *const *scalings, size_t n, const char *folder)
{
    static const char *const files[] = { "b.dcm", "c.dcm", "d.dcm" }, *const uids[] = { "1.2.82", "1.2.83", "1.2.84" };
    made_part_images(folder, "ct", &anna, "1.2.51", 2);
    made_part_plan(folder, "plan.dcm", &anna,
                   &(struct made_part_plan){ .uid = "1.2.71", .label = "P", .beams = { "B1", "B2" } });
    made_part_dose(folder, "a.dcm", &anna,
                   &(struct made_part_dose){ .uid = "1.2.81", .plan_uid = "1.2.71", .summation = "FRACTION" });
    for (size_t i = 0; i < n; i++)
        made_part_dose(folder, files[i], &anna,
                       &(struct made_part_dose){ .uid = uids[i],
                                                 .plan_uid = "1.2.71",
                                                 .summation = "BEAM",
                                                 .beam = beams[i],
                                                 .scaling = scalings[i] });
    return open_plan(folder);
}

static void doses_of_every_beam_are_summed_at_first_before_that_of_a_fraction(void **state)
{
    (void)state;
    static const struct {
        int beams[3];
        size_t n;
        const char *scalings[3], *first, *second; /* files; second: what a new room adds, or NULL */
    } cases[] = {
        { { 2, 1 }, 2, { "0.5", "0.25" }, "c.dcm", "b.dcm" },        /* by the beams' order */
        { { 1 }, 1, { "0.5" }, "a.dcm", NULL },                      /* the second beam has none */
        { { 1, 1 }, 2, { "0.5", "0.25" }, "a.dcm", NULL },           /* one beam has two, the other none */
        { { 1, 2, 2 }, 3, { "0.5", "0.5", "0.25" }, "a.dcm", NULL }, /* two that might be the beam's */
        { { 1, 3 }, 2, { "0.5", "0.25" }, "a.dcm", NULL },           /* of a beam that the plan does not have */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[256];
        size_t doses[PLAN_MAX_DOSES];
        struct scene scene;
        folder_make(folder);
        struct plan *plan = open_beam_doses(cases[i].beams, cases[i].scalings, cases[i].n, folder);
        assert_string_equal(plan->dose_origins[0].path, cases[i].first);
        assert_int_equal(plan->treatment_plans[0].n_beams, 2);
        assert_int_equal(plan_beam_doses(plan, 0, doses), cases[i].second ? 2 : 0);
        scene_for_plan(plan, &scene);
        assert_int_equal(scene.dose.n_sum, cases[i].second ? 1 : 0);
        if (cases[i].second) {
            int added = dose_index_of(plan, scene.dose.sum[0].id);
            assert_string_equal(plan->dose_origins[added].path, cases[i].second);
            assert_close(scene.dose.sum[0].value.factor, 1, 0);
        }
        scene_finish(&scene);
        plan_destroy(plan);
        folder_remove(folder);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_part_says_where_it_comes_from),
        cmocka_unit_test(a_kept_plan_knows_the_same_origins),
        cmocka_unit_test(patients_are_told_apart_by_id_name_and_birth_date),
        cmocka_unit_test(slices_of_two_patients_make_two_images),
        cmocka_unit_test(files_without_a_patient_are_of_none),
        cmocka_unit_test(patients_that_are_masked_alike_are_told_apart_in_words),
        cmocka_unit_test(the_report_names_patients_masked),
        cmocka_unit_test(a_conflict_a_missing_identity_and_an_absent_structure_set_are_said),
        cmocka_unit_test(doses_and_beams_named_alike_are_told_apart_by_their_plans),
        cmocka_unit_test(the_first_dose_is_that_of_the_whole_plan),
        cmocka_unit_test(doses_of_every_beam_are_summed_at_first_before_that_of_a_fraction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
