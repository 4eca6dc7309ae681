/* Real plans, with numbers other programs gave. */
#include "core/load/summary.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

static void assert_extent(const struct region *r, uint32_t i0, uint32_t i1, uint32_t j0, uint32_t j1, uint32_t k0,
                          uint32_t k1)
{
    const uint32_t expected[6] = { i0, i1, j0, j1, k0, k1 };
    const uint32_t found[6] = { r->low_ijk[0],  r->high_ijk[0], r->low_ijk[1],
                                r->high_ijk[1], r->low_ijk[2],  r->high_ijk[2] };
    assert_memory_equal(found, expected, sizeof found);
}

static void assert_sera_head(const struct plan *plan)
{
    /* counts and extents as published with the sample; the tumour's centroid is the planned target (24.9, 38.4, -64.9)
     */
    assert_int_equal(plan->regions.n_regions, 3);
    assert_int_equal(region_of(plan, "scalp")->n_voxels, 590872);
    assert_int_equal(region_of(plan, "brain")->n_voxels, 302070);
    assert_int_equal(region_of(plan, "tumor")->n_voxels, 11837);
    assert_extent(region_of(plan, "scalp"), 3, 248, 6, 224, 0, 47);
    assert_extent(region_of(plan, "brain"), 55, 196, 36, 214, 21, 46);
    assert_extent(region_of(plan, "tumor"), 127, 175, 130, 196, 33, 40);
    assert_close(region_of(plan, "brain")->volume_cm3, 1713.664, 0.01);
    assert_close(region_of(plan, "tumor")->volume_cm3, 67.152, 0.001);
    assert_close(region_of(plan, "tumor")->centre_lps_mm.x, 24.9, 0.1);
    assert_close(region_of(plan, "tumor")->centre_lps_mm.y, 38.4, 0.1);
    assert_close(region_of(plan, "tumor")->centre_lps_mm.z, -64.9, 0.1);
    assert_string_equal(parent_of(plan, "tumor"), "brain");
    assert_string_equal(parent_of(plan, "brain"), "scalp");
    assert_true(region_of(plan, "scalp")->touches_edge);
    assert_false(region_of(plan, "brain")->touches_edge);
}

static void sera_s_own_head_has_the_published_counts_extents_and_places(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("sera-head");
    if (!plan)
        skip();
    assert_sera_head(plan);
    assert_int_equal(plan->regions.hierarchy, HIERARCHY_FILE);
    assert_close(region_of(plan, "tumor")->boron_ratio, 3.5, 0);
    assert_close(region_of(plan, "tumor")->cbe_boron, 3.8, 0);
    assert_close(region_of(plan, "brain")->rbe_nitrogen, 3.2, 0);
    assert_int_equal(plan->n_doses, 2); /* the mesh of seraMC and its contours */
    /* 600 segments, 21 of no length; 1 beam line from (RL, PA, IS) (90.5, -93.4, -5.0) */
    assert_int_equal(plan->tracks.n_segments, 579);
    assert_int_equal(plan->tracks.n_of_class[TRACK_BEAM_LINE], 1);
    assert_int_equal(plan->n_beams, 1);
    assert_close(plan->beams[0].entry_lps_mm.x, 90.4691, 1e-3);
    assert_close(plan->beams[0].entry_lps_mm.y, 93.4190, 1e-3);
    assert_close(plan->beams[0].target_lps_mm.z, -64.9, 1e-3);
    assert_close(plan->images[0].volume->high, 255, 0);
    plan_destroy(plan);
}

static void the_distributed_head_opens_from_nifti_copies_and_from_headers_that_lie(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("sera-st");
    if (!plan)
        skip();
    assert_sera_head(plan);
    assert_true(report_has(&plan->report, "region.surroundings"));
    plan_destroy(plan);
    plan = plan_of_data("sera-head/original");
    assert_sera_head(plan);
    assert_true(report_has(&plan->report, "plan.recognised"));
    assert_true(report_has(&plan->report, "geometry.unit-assumed"));
    assert_true(report_has(&plan->report, "image.slices-differ"));
    assert_true(report_has(&plan->report, "geometry.borrowed"));
    assert_memory_equal(plan->images[0].volume->grid.size, plan->regions.layers[0]->grid.size, sizeof(uint32_t[3]));
    assert_close(plan->images[0].volume->grid.lps_mm_from_ijk.origin.z, -264.999145,
                 1e-3); /* of the corrected header */
    plan_destroy(plan);
}

static void a_clinical_plan_has_its_left_parotid_on_the_left(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("openkbp-pt99");
    if (!plan)
        skip();
    assert_int_equal(plan->regions.n_regions, 10);
    assert_true(region_of(plan, "leftparotid")->centre_lps_mm.x > 20);
    assert_true(region_of(plan, "rightparotid")->centre_lps_mm.x < -20);
    assert_true(region_of(plan, "brainstem")->centre_lps_mm.z > region_of(plan, "larynx")->centre_lps_mm.z);
    assert_true(region_of(plan, "mandible")->centre_lps_mm.y < region_of(plan, "spinalcord")->centre_lps_mm.y);
    assert_int_equal(region_of(plan, "ptv56")->n_voxels, 25423);
    assert_int_equal(region_of(plan, "ptv70")->n_voxels, 4150);
    /* the data's notes: PTV70 mean about 71 Gy */
    const struct region *ptv = region_of(plan, "ptv70");
    const struct volume *layer = plan->regions.layers[ptv->layer];
    double sum = 0;
    for (uint32_t k = 0; k < 128; k++)
        for (uint32_t j = 0; j < 128; j++)
            for (uint32_t i = 0; i < 128; i++)
                if (volume_label(layer, i, j, k) == ptv->label)
                    sum += volume_value(plan->doses[0].components[0].values, i, j, k);
    assert_close(sum / 4150, 71, 1.5);
    assert_string_equal(plan->doses[0].unit, "Gy");
    assert_true(report_has(&plan->report, "dose.no-per"));
    plan_destroy(plan);
}

static void volumes_agree_with_another_planning_system(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("eclipse-ent-dose");
    if (!plan)
        skip();
    assert_int_equal(plan->regions.n_regions, 16);
    assert_near(region_of(plan, "brain")->volume_cm3, 1114.2, 0.01);
    assert_near(region_of(plan, "brstem")->volume_cm3, 30.8, 0.02);
    assert_near(region_of(plan, "ptv1")->volume_cm3, 125.7, 0.015);
    assert_int_equal(plan->n_doses, 1);
    assert_string_equal(parent_of(plan, "gtv"), "ctv");
    assert_string_equal(parent_of(plan, "lens-left"), "orbit-left");
    plan_destroy(plan);
}

static void an_atlas_keeps_all_its_regions(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("head-colin27");
    if (!plan)
        skip();
    assert_int_equal(plan->regions.n_regions, 116);
    assert_true(region_of(plan, "precentral-l")->centre_lps_mm.x > 0); /* L is the patient's left */
    assert_true(region_of(plan, "precentral-r")->centre_lps_mm.x < 0);
    plan_destroy(plan);
    plan = plan_of_data("ct-totalseg");
    assert_int_equal(plan->regions.n_regions, 41);
    assert_true(region_of(plan, "liver")->centre_lps_mm.x < region_of(plan, "spleen")->centre_lps_mm.x);
    plan_destroy(plan);
}

static void every_folder_of_data_is_summarised_with_a_reason_when_it_cannot_be_read(void **state)
{
    (void)state;
    const struct {
        const char *name, *reason;
    } folders[] = { { "sera-head", NULL },
                    { "gbm-brats2013", NULL },
                    { "mr-tumour-nrrd", NULL },
                    { "eclipse-ent-dose", NULL },
                    { "dicomrt-plans", NULL },
                    { "dicom-mr-head", "archive: unpack it first" },
                    { "matrad-phantoms", "BOXPHANTOM" },
                    { "trip98-tst003", "no plan.json" } };
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        char path[512];
        struct plan_summary summary;
        if (!data_path(folders[i].name, path, sizeof path))
            skip();
        plan_summarize(path, &summary);
        if (summary.is_readable != (folders[i].reason == NULL) ||
            (folders[i].reason && !strstr(summary.reason, folders[i].reason)))
            fail_msg("%s: \"%s\"", folders[i].name, summary.reason);
    }
    struct plan_summary summary;
    plan_summarize("/no/such/folder", &summary);
    assert_false(summary.is_readable);
    assert_string_equal(summary.name, "folder");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sera_s_own_head_has_the_published_counts_extents_and_places),
        cmocka_unit_test(the_distributed_head_opens_from_nifti_copies_and_from_headers_that_lie),
        cmocka_unit_test(a_clinical_plan_has_its_left_parotid_on_the_left),
        cmocka_unit_test(volumes_agree_with_another_planning_system),
        cmocka_unit_test(an_atlas_keeps_all_its_regions),
        cmocka_unit_test(every_folder_of_data_is_summarised_with_a_reason_when_it_cannot_be_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
