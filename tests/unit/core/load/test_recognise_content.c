/* Folders without a plan.json: names hint at labels and doses, values decide; and files of components become one dose.
 */
#include <math.h>
#include <stdio.h>

#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

enum { SIDE = 12, N_VOXELS = SIDE * SIDE * SIDE };

typedef double (*value_at)(int i, int j, int k);

static double grey(int i, int j, int k)
{
    return i + 3 * j + 7 * k;
}
static double hounsfield(int i, int j, int k)
{
    return grey(i, j, k) * 10 - 500;
}
/* Two blocks of 4 x 4 x 4: 1 and 2. */
static double two_blocks(int i, int j, int k)
{
    return j < 4 && k < 4 ? (i < 4 ? 1 : i >= 6 && i < 10 ? 2 : 0) : 0;
}
static double half(int i, int j, int k)
{
    return two_blocks(i, j, k) / 2;
}
static double nothing(int i, int j, int k)
{
    return 0.0 * (i + j + k);
}
static double dose(int i, int j, int k)
{
    return 2 + 0.1 * i + 0.05 * j + 0.2 * k;
}

static void put_at(const char *folder, const char *name, enum voxel_type type, value_at value, double factor,
                   double shift_mm)
{
    struct grid grid = made_cube_grid(SIDE);
    grid.lps_mm_from_ijk.origin.x += shift_mm; /* the inverse is not written */
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, type, &err);
    assert_non_null(volume);
    for (int at = 0; at < N_VOXELS; at++) {
        double v = factor * value(at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE);
        if (type == VOXEL_F32)
            ((float *)volume->voxels)[at] = (float)v;
        else if (type == VOXEL_I16)
            ((int16_t *)volume->voxels)[at] = (int16_t)v;
        else
            ((uint8_t *)volume->voxels)[at] = (uint8_t)v;
    }
    volume_measure(volume);
    folder_put_volume(folder, name, volume);
}

static void put(const char *folder, const char *name, enum voxel_type type, value_at value, double factor)
{
    put_at(folder, name, type, value, factor, 0);
}

static struct plan *open_and_remove(const char *folder)
{
    struct error err;
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    folder_remove(folder);
    return plan;
}

static void values_decide_what_a_name_only_hints_at(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum voxel_type type;
        value_at value;
        size_t n_images, n_regions, n_doses; /* with a CT beside it */
        const char *code;                    /* a line of the report; NULL: any */
    } cases[] = {
        { "t1w_masked.nii.gz", VOXEL_U8, grey, 2, 0, 0, "image.by-content" },
        { "segmentation.nii.gz", VOXEL_F32, two_blocks, 1, 2, 0, NULL },
        { "segmentation.nii.gz", VOXEL_U8, two_blocks, 1, 2, 0, NULL },
        { "prob_seg.nii.gz", VOXEL_F32, half, 2, 0, 0, "image.by-content" },
        { "ct_segmented.nii.gz", VOXEL_I16, hounsfield, 2, 0, 0, "image.by-content" },
        { "empty_mask.nii.gz", VOXEL_U8, nothing, 1, 0, 0, "region.none" },
        { "aaa.nii.gz", VOXEL_U8, two_blocks, 2, 0, 0, "image.may-be-region" },
        { "aaa.nii.gz", VOXEL_F32, two_blocks, 2, 0, 0, "image.may-be-region" },
        { "aaa.nii.gz", VOXEL_U8, nothing, 2, 0, 0, "image.constant" },
        { "lowdose_ct.nii.gz", VOXEL_I16, hounsfield, 2, 0, 0, NULL },
        { "high-dose-CT.nii.gz", VOXEL_I16, grey, 2, 0, 0, NULL },
        { "lowdose.nii.gz", VOXEL_I16, hounsfield, 2, 0, 0, "image.by-content" },
        { "dose.nii.gz", VOXEL_F32, dose, 1, 0, 1, NULL },
        { "CT_dose.nii.gz", VOXEL_F32, dose, 1, 0, 1, NULL },
        { "dose.nii.gz", VOXEL_F32, nothing, 1, 0, 0, "dose.all-zero" },
        { "ct_0.nii.gz", VOXEL_I16, hounsfield, 2, 0, 0, NULL },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[256];
        folder_make(folder);
        put(folder, "ct.nii.gz", VOXEL_I16, hounsfield, 1);
        put(folder, cases[i].name, cases[i].type, cases[i].value, 1);
        struct plan *plan = open_and_remove(folder);
        if (plan->n_images != cases[i].n_images || plan->regions.n_regions != cases[i].n_regions ||
            plan->n_doses != cases[i].n_doses)
            fail_msg("case %zu, %s: %zu images, %zu regions, %zu doses", i, cases[i].name, plan->n_images,
                     plan->regions.n_regions, plan->n_doses);
        if (cases[i].code && !report_has(&plan->report, cases[i].code))
            fail_msg("case %zu, %s: no %s", i, cases[i].name, cases[i].code);
        assert_close(plan->images[0].volume->low, -500, 0); /* never a label map first */
        char counts[80];
        snprintf(counts, sizeof counts, "%zu image%s, %zu region%s, %zu dose%s", plan->n_images,
                 plan->n_images == 1 ? "" : "s", plan->regions.n_regions, plan->regions.n_regions == 1 ? "" : "s",
                 plan->n_doses, plan->n_doses == 1 ? "" : "s");
        if (!strstr(report_said(&plan->report, "plan.recognised"), counts))
            fail_msg("case %zu: \"%s\" without \"%s\"", i, report_said(&plan->report, "plan.recognised"), counts);
        plan_destroy(plan);
    }
}

static void a_prediction_beside_the_images_it_was_made_from_is_a_label_map(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put(folder, "case_001.nii.gz", VOXEL_U8, two_blocks, 1);
    put(folder, "case_001_0000.nii.gz", VOXEL_I16, hounsfield, 1);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(plan->n_images, 1);
    assert_string_equal(plan->images[0].id, "case-001-0000");
    assert_int_equal(plan->regions.n_regions, 2);
    assert_int_equal(plan->regions.regions[0].n_voxels, 64);
    plan_destroy(plan);
}

static double maximum_of(const struct dose *of, enum dose_quantity quantity)
{
    for (size_t c = 0; c < of->n_components; c++)
        if (of->components[c].quantity == quantity)
            return of->components[c].values->high;
    return NAN;
}

static void files_of_components_become_one_dose_with_their_errors(void **state)
{
    (void)state;
    static const char *const names[][5] = {
        { "dose_boron.nii.gz", "dose_nitrogen.nii.gz", "dose_fast.nii.gz", "dose_gamma.nii.gz",
          "dose_fast_sigma.nii.gz" },
        { "head_B10.nii.gz", "head_N14.nii.gz", "head_n.nii.gz", "head_g.nii.gz", "head_n_sigma.nii.gz" },
        { "ホウ素線量.nii.gz", "窒素線量.nii.gz", "速中性子線量.nii.gz", "γ線線量.nii.gz", "速中性子線量_誤差.nii.gz" },
    };
    static const enum dose_quantity quantities[] = { DOSE_BORON, DOSE_NITROGEN, DOSE_FAST, DOSE_GAMMA };
    double most = 2 + 0.35 * (SIDE - 1);
    for (size_t n = 0; n < 3; n++) {
        char folder[256];
        folder_make(folder);
        put(folder, "head_CT.nii.gz", VOXEL_I16, hounsfield, 1);
        for (int c = 0; c < 4; c++)
            put(folder, names[n][c], VOXEL_F32, dose, c + 1);
        put(folder, names[n][4], VOXEL_F32, dose, 0.25);
        struct plan *plan = open_and_remove(folder);
        assert_int_equal(plan->n_images, 1);
        assert_int_equal(plan->n_doses, 1);
        assert_int_equal(plan->doses[0].n_components, 4);
        for (int c = 0; c < 4; c++)
            assert_close(maximum_of(&plan->doses[0], quantities[c]), (c + 1) * most, 1e-5);
        size_t n_errors = 0;
        for (size_t c = 0; c < 4; c++)
            if (plan->doses[0].components[c].error) {
                n_errors++;
                assert_int_equal(plan->doses[0].components[c].quantity, DOSE_FAST);
                assert_close(plan->doses[0].components[c].error->high, 0.25 * most, 1e-5);
            }
        assert_int_equal(n_errors, 1);
        assert_non_null(strstr(report_said(&plan->report, "dose.components"), "plan.json"));
        plan_destroy(plan);
    }
}

/* Photon and neutron doses may be of two treatments; another grid and another stem are another run. */
static void names_join_no_doses_that_may_be_two(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put(folder, "dose_photon.nii.gz", VOXEL_F32, dose, 1);
    put(folder, "dose_neutron.nii.gz", VOXEL_F32, dose, 2);
    put(folder, "b_dose_boron.nii.gz", VOXEL_F32, dose, 3);
    put(folder, "scan_n.nii.gz", VOXEL_F32, dose, 1);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(plan->n_images, 1);
    assert_string_equal(plan->images[0].id, "scan-n");
    assert_int_equal(plan->n_doses, 3);
    for (size_t d = 0; d < 3; d++)
        assert_int_equal(plan->doses[d].n_components, 1);
    assert_true(report_has(&plan->report, "dose.words-not-joined"));
    plan_destroy(plan);
}

static void a_component_on_another_grid_is_a_dose_of_its_own_and_never_a_total(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put(folder, "dose_boron.nii.gz", VOXEL_F32, dose, 6);
    put(folder, "dose_nitrogen.nii.gz", VOXEL_F32, dose, 1);
    put_at(folder, "dose_fast.nii.gz", VOXEL_F32, dose, 1, 0.7);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(plan->n_doses, 2);
    assert_int_equal(plan->doses[0].n_components, 2);
    assert_int_equal(plan->doses[1].n_components, 1);
    assert_int_equal(plan->doses[1].components[0].quantity, DOSE_FAST);
    assert_non_null(strstr(report_said(&plan->report, "dose.words-not-joined"), "different grids"));
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_decide_what_a_name_only_hints_at),
        cmocka_unit_test(a_prediction_beside_the_images_it_was_made_from_is_a_label_map),
        cmocka_unit_test(files_of_components_become_one_dose_with_their_errors),
        cmocka_unit_test(names_join_no_doses_that_may_be_two),
        cmocka_unit_test(a_component_on_another_grid_is_a_dose_of_its_own_and_never_a_total),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
