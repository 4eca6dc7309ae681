/* The gate: which parts of a plan may be combined, and what a scene uses. */
#include "core/plan/fit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/scene/fit_use.h"
#include "tests/check.h"
#include "tests/made_plan.h"

static double one(struct vec3 point_lps_mm)
{
    (void)point_lps_mm;
    return 1;
}

static void set(char *field, const char *text)
{
    snprintf(field, ORIGIN_UID_SIZE, "%s", text);
}

static void add_dose(struct plan *plan, const char *id, const char *unit, const char *per)
{
    struct dose *dose = &plan->doses[plan->n_doses];
    *dose = (struct dose){ .n_components = 1 };
    snprintf(dose->id, sizeof dose->id, "%s", id);
    snprintf(dose->unit, sizeof dose->unit, "%s", unit);
    snprintf(dose->per, sizeof dose->per, "%s", per);
    struct grid grid = made_cube_grid(20);
    dose->components[0] =
        (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(&grid, VOXEL_F32, one) };
    plan->dose_origins[plan->n_doses++] = (struct part_origin){ .patient = 0, .treatment_plan = 0, .frame_uid = "1.1" };
}

static void add_image(struct plan *plan, const char *id, const char *frame)
{
    struct plan_image *image = &plan->images[plan->n_images];
    struct grid grid = made_cube_grid(20);
    snprintf(image->id, sizeof image->id, "%s", id);
    image->volume = made_volume(&grid, VOXEL_F32, one);
    plan->image_origins[plan->n_images] = (struct part_origin){ .patient = 0, .treatment_plan = -1 };
    set(plan->image_origins[plan->n_images++].frame_uid, frame);
}

/* One patient, a CT and an MR of another frame, two treatment plans with a dose each, one beam, one structure set. */
static struct plan *make(void)
{
    struct plan *plan = plan_create("fits");
    plan->n_patients = 2;
    plan->n_treatment_plans = 2;
    for (int i = 0; i < 2; i++) {
        struct treatment_plan *treatment = &plan->treatment_plans[i];
        snprintf(treatment->uid, sizeof treatment->uid, "2.%d", i);
        snprintf(treatment->label, sizeof treatment->label, "BNCT-%d", i + 1);
        set(treatment->structs_uid, "3.0");
    }
    add_image(plan, "ct", "1.1");
    add_image(plan, "mr", "1.2");
    add_dose(plan, "a", "Gy", "plan");
    add_dose(plan, "b", "Gy", "plan");
    plan->n_beams = 1;
    snprintf(plan->beams[0].id, sizeof plan->beams[0].id, "b1");
    plan->beam_origins[0] = (struct part_origin){ .patient = 0, .treatment_plan = 0, .frame_uid = "1.1" };
    plan->region_origins = mem_new(sizeof *plan->region_origins);
    plan->n_region_origins = 1;
    plan->region_origins[0] =
        (struct part_origin){ .patient = 0, .treatment_plan = -1, .frame_uid = "1.1", .structs_uid = "3.0" };
    return plan;
}

static const struct fit_part ct = { FIT_IMAGE, 0 }, mr = { FIT_IMAGE, 1 }, dose_a = { FIT_DOSE, 0 },
                             dose_b = { FIT_DOSE, 1 }, beam = { FIT_BEAM, 0 }, regions = { FIT_REGIONS, 1 };

static void each_mismatch_of_a_pair_has_its_relation(void **state)
{
    (void)state;
    struct plan *plan = make();
    assert_int_equal(fit_of(plan, dose_a, ct).relation, FIT_SAME);
    assert_int_equal(fit_of(plan, dose_a, mr).relation, FIT_FRAME);
    assert_int_equal(fit_of(plan, mr, ct).relation, FIT_FRAME);
    assert_int_equal(fit_of(plan, beam, mr).relation, FIT_FRAME);
    assert_int_equal(fit_of(plan, regions, mr).relation, FIT_FRAME);
    assert_int_equal(fit_of(plan, regions, dose_a).relation, FIT_SAME);

    plan->dose_origins[0].frame_uid[0] = 0;
    assert_int_equal(fit_of(plan, dose_a, ct).relation, FIT_UNSTATED);
    set(plan->dose_origins[0].frame_uid, "1.1");
    plan->dose_origins[0].is_registered = true;
    assert_int_equal(fit_of(plan, dose_a, ct).relation, FIT_REGISTERED);
    plan->dose_origins[0].is_registered = false;

    plan->dose_origins[0].treatment_plan = -1;
    set(plan->dose_origins[0].plan_uid, "2.9");
    assert_int_equal(fit_of(plan, dose_a, ct).relation, FIT_ABSENT);
    plan->n_treatment_plans = 0; /* nothing here that it could be mistaken to belong to */
    assert_int_equal(fit_of(plan, dose_a, ct).relation, FIT_SAME);
    plan->n_treatment_plans = 2;
    plan->dose_origins[0].treatment_plan = 0;

    plan->dose_origins[1].treatment_plan = 1;
    assert_int_equal(fit_of(plan, dose_b, dose_a).relation, FIT_PLAN);
    set(plan->region_origins[0].structs_uid, "3.1");
    assert_int_equal(fit_of(plan, regions, dose_a).relation, FIT_PLAN);

    plan->doses[1].components[0].values->grid.lps_mm_from_ijk.origin.x += 4000;
    assert_int_equal(fit_of(plan, dose_b, ct).relation, FIT_APART);
    plan->dose_origins[1].patient = 1;
    struct fit fit = fit_of(plan, dose_b, ct);
    assert_int_equal(fit.relation, FIT_PATIENT);
    assert_int_equal(fit.reasons, 1U << FIT_PATIENT | 1U << FIT_APART);
    assert_int_equal(fit_pair_needs(&fit), FIT_NEEDS_NEVER);
    plan_destroy(plan);
}

static void two_doses_join_only_in_units_that_convert(void **state)
{
    (void)state;
    static const struct {
        const char *units[2], *pers[2];
        enum dose_quantity quantities[2];
        enum fit_relation expected;
    } cases[] = {
        { { "Gy", "Gy" }, { "plan", "plan" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_SAME },
        { { "Gy", "cGy" }, { "plan", "plan" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_SAME },
        { { "Gy", "" }, { "plan", "plan" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_UNIT },
        { { "", "" }, { "plan", "plan" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_UNIT },
        { { "Gy", "%" }, { "plan", "plan" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_UNIT },
        { { "Gy", "Gy" }, { "plan", "plan" }, { DOSE_TOTAL, DOSE_WEIGHTED_TOTAL }, FIT_UNIT },
        { { "Gy", "Gy" }, { "plan", "fraction" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_PER },
        { { "Gy", "Gy" }, { "plan", "" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_PER },
        { { "Gy", "Gy" }, { "plan", "PLAN" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_SAME },
        { { "Gy", "Gy" }, { "plan", "per  the Whole plan " }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_SAME },
        { { "Gy", "Gy" }, { "a fraction", "fx" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_SAME },
        { { "Gy", "Gy" }, { "the whole treatment", "plan" }, { DOSE_TOTAL, DOSE_TOTAL }, FIT_PER },
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct plan *plan = make();
        for (int d = 0; d < 2; d++) {
            snprintf(plan->doses[d].unit, sizeof plan->doses[d].unit, "%s", cases[c].units[d]);
            snprintf(plan->doses[d].per, sizeof plan->doses[d].per, "%s", cases[c].pers[d]);
            plan->doses[d].components[0].quantity = cases[c].quantities[d];
        }
        assert_int_equal(fit_of(plan, dose_b, dose_a).relation, cases[c].expected);
        assert_int_equal(fit_of(plan, dose_a, dose_b).relation, cases[c].expected);
        plan_destroy(plan);
    }
    double factor;
    assert_true(fit_unit_factor("cGy", "Gy", &factor) && factor == 0.01);
    assert_true(fit_unit_factor("Gy", "cGy", &factor) && factor == 100);
    assert_true(fit_unit_factor("mGy", "cGy", &factor) && factor == 0.1);
    assert_false(fit_unit_factor("Gy", "MeV", &factor));
}

static void a_sentence_says_thing_image_and_fact(void **state)
{
    (void)state;
    struct plan *plan = make();
    char why[FIT_WHY_SIZE];
    snprintf(plan->doses[0].name, sizeof plan->doses[0].name, "Boost");
    snprintf(plan->images[1].name, sizeof plan->images[1].name, "MR");
    fit_sentence(plan, dose_a, mr, FIT_FRAME, why);
    assert_string_equal(why,
                        "Dose “Boost” is not used with MR: it was computed in another frame of reference. It may be "
                        "shifted against this image, or be another patient's.");
    plan->dose_origins[1].treatment_plan = 1;
    fit_sentence(plan, dose_b, dose_a, FIT_PLAN, why);
    assert_string_equal(why, "Dose “b” is not used with Dose “Boost”: it belongs to plan BNCT-2; shown is BNCT-1.");
    fit_accepted_sentence(plan, beam, mr, FIT_FRAME, why);
    assert_string_equal(why, "Beam “b1” is used with MR though it does not fit: it was planned in another frame of "
                             "reference. It may be shifted against this image, or be another patient's.");
    for (int kind = 0; kind < FIT_N_KINDS; kind++) { /* names of parts are read as they are written */
        struct fit_part part = { (enum fit_kind)kind, 0 }, read;
        char text[FIT_PART_SIZE];
        fit_part_write(plan, part, text);
        assert_true(fit_part_read(plan, text, &read));
        assert_true(read.kind == part.kind && read.index == part.index);
    }
    assert_false(fit_part_read(plan, "dose:none", &(struct fit_part){ 0 }));
    plan_destroy(plan);
}

/* ---- what a scene uses ------------------------------------------------------------------------------------------ */

static struct scene_fits fits_of(const struct plan *plan, int image, int dose, const struct acceptances *accepted)
{
    struct scene_fits fits;
    struct error err = { 0 };
    assert_true(scene_fits_of(plan, image, -1, dose, accepted, &fits, &err));
    return fits;
}

static void a_persons_word_counts_for_its_pair_alone(void **state)
{
    (void)state;
    struct plan *plan = make();
    struct acceptance item = { .thing = "dose:a", .with = "image:mr", .by = "Anna", .words = "registered elsewhere" };
    const struct acceptances accepted = { &item, 1 };
    struct scene_fits fits = fits_of(plan, 1, 0, &accepted);
    assert_int_equal(fits.doses[0].state, FIT_USED_BY_WORD);
    assert_string_equal(fits.doses[0].acceptance->by, "Anna");
    assert_int_equal(fits.doses[1].state, FIT_NOT_USED);
    assert_int_equal(fits.beams[0].state, FIT_NOT_USED);
    scene_fits_finish(&fits);
    fits = fits_of(plan, 0, 0, &accepted);
    assert_int_equal(fits.doses[0].state, FIT_USED);
    scene_fits_finish(&fits);
    struct acceptance turned = { .thing = "image:mr", .with = "dose:a", .by = "Anna" };
    fits = fits_of(plan, 1, 0, &(struct acceptances){ &turned, 1 }); /* the pair counts, not which is named first */
    assert_int_equal(fits.doses[0].state, FIT_USED_BY_WORD);
    scene_fits_finish(&fits);
    plan->dose_origins[0].patient = 1; /* another patient is never accepted */
    fits = fits_of(plan, 1, 0, &accepted);
    assert_int_equal(fits.doses[0].state, FIT_NOT_USED);
    assert_int_equal(fits.doses[0].relation, FIT_PATIENT);
    scene_fits_finish(&fits);
    plan_destroy(plan);
}

static void doses_of_two_plans_are_compared_but_not_added(void **state)
{
    (void)state;
    struct plan *plan = make();
    plan->dose_origins[1].treatment_plan = 1;
    struct scene_fits fits = fits_of(plan, 0, 0, NULL);
    assert_true(fit_is_used(&(struct fit_use[]){ dose_join_of(&fits, 1, 1, 0, 1, DOSE_JOIN_COMPARE) }[0]));
    struct fit_use sum = dose_join_of(&fits, 1, 1, 0, 1, DOSE_JOIN_SUM);
    assert_false(fit_is_used(&sum));
    assert_int_equal(sum.relation, FIT_PLAN);
    scene_fits_finish(&fits);
    plan_destroy(plan);
}

static void a_dose_per_fraction_joins_the_plans_once_fractions_are_given(void **state)
{
    (void)state;
    struct plan *plan = make();
    snprintf(plan->doses[1].per, sizeof plan->doses[1].per, "fraction");
    struct scene_fits fits = fits_of(plan, 0, 0, NULL);
    static const struct {
        double factor;
        bool is_used;
    } cases[] = { { 1, false }, { 30, true }, { 2.5, false } };
    char per[FIT_PER_SIZE];
    assert_string_equal(dose_per_counted(&plan->doses[1], 30, per), "plan");
    assert_string_equal(dose_per_counted(&plan->doses[1], 1, per), "fraction");
    assert_string_equal(dose_per_counted(&plan->doses[0], 2, per), "plan");
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct fit_use use = dose_join_of(&fits, 1, cases[c].factor, 0, 1, DOSE_JOIN_SUM);
        assert_int_equal(fit_is_used(&use), cases[c].is_used);
        if (!cases[c].is_used)
            assert_int_equal(use.relation, FIT_PER);
    }
    scene_fits_finish(&fits);
    plan_destroy(plan);
}

/* The image says nothing of its frame: regions and dose are held against each other. */
static void parts_on_an_image_without_a_frame_are_held_against_each_other(void **state)
{
    (void)state;
    struct plan *plan = make();
    plan->image_origins[0].frame_uid[0] = 0;
    set(plan->region_origins[0].frame_uid, "1.7");
    struct scene_fits fits = fits_of(plan, 0, 0, NULL);
    assert_int_equal(fits.doses[0].state, FIT_USED);
    assert_int_equal(fits.regions[1].state, FIT_NOT_USED);
    assert_int_equal(fits.regions[1].relation, FIT_FRAME);
    assert_int_equal(fits.beams[0].state, FIT_USED);
    scene_fits_finish(&fits);
    plan_destroy(plan);
}

static void nothing_of_another_patient_is_used(void **state)
{
    (void)state;
    struct plan *plan = make();
    plan->image_origins[1].patient = 1;
    plan->beam_origins[0] = (struct part_origin){ .patient = 1, .treatment_plan = -1, .frame_uid = "1.1" };
    plan->region_origins[0].patient = 1;
    for (int image = 0; image < 2; image++) {
        struct scene_fits fits = fits_of(plan, image, 0, NULL);
        assert_int_equal(fits.images[0].state, FIT_USED);
        assert_int_equal(fits.images[1].state, FIT_NOT_USED);
        assert_int_equal(fits.beams[0].relation, FIT_PATIENT);
        assert_int_equal(fits.regions[1].relation, FIT_PATIENT);
        assert_int_equal(fits.doses[0].state, image == 0 ? FIT_USED : FIT_NOT_USED);
        scene_fits_finish(&fits);
    }
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_mismatch_of_a_pair_has_its_relation),
        cmocka_unit_test(two_doses_join_only_in_units_that_convert),
        cmocka_unit_test(a_sentence_says_thing_image_and_fact),
        cmocka_unit_test(a_persons_word_counts_for_its_pair_alone),
        cmocka_unit_test(doses_of_two_plans_are_compared_but_not_added),
        cmocka_unit_test(a_dose_per_fraction_joins_the_plans_once_fractions_are_given),
        cmocka_unit_test(parts_on_an_image_without_a_frame_are_held_against_each_other),
        cmocka_unit_test(nothing_of_another_patient_is_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
