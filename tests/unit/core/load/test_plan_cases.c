/* Made DICOM plans from the shared data: what its README says that each must give. Skipped where they are absent. */
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

static char folder[256]; /* of the unpacked archive */

static int unpack(void **state)
{
    (void)state;
    if (!rt_unpack("cases/combining.tar.xz", folder))
        folder[0] = 0;
    return 0;
}

static int remove_unpacked(void **state)
{
    (void)state;
    if (folder[0])
        folder_remove(folder);
    return 0;
}

static struct plan *open_case(const char *name)
{
    char path[512];
    struct error err = { 0 };
    if (!folder[0])
        skip();
    snprintf(path, sizeof path, "%s/%s", folder, name);
    struct plan *plan = plan_of_folder(path, &err);
    if (!plan)
        fail_msg("%s: %s", name, err.text);
    return plan;
}

static void contours_given_twice_have_the_volume_of_one(void **state)
{
    (void)state;
    struct plan *plan = open_case("s03-duplicate-contours");
    assert_int_equal(plan->regions.n_regions, 6);
    for (size_t i = 0; i < plan->regions.n_regions; i++) /* 78.4 cm3; on voxels of 30 mm3, 1 % */
        assert_near(plan->regions.regions[i].volume_cm3, 78.4, 0.01);
    assert_true(report_has(&plan->report, "region.contours-left-out"));
    assert_false(report_has(&plan->report, "region.contours-differ"));
    plan_destroy(plan);
}

static void contours_that_overlap_are_a_union_and_said(void **state)
{
    (void)state;
    struct plan *plan = open_case("s02-overlapping");
    assert_near(region_of(plan, "two-overlapping")->volume_cm3, 48, 0.001);
    assert_near(region_of(plan, "touching")->volume_cm3, 48, 0.001);
    assert_near(region_of(plan, "figure-8")->volume_cm3, 24, 0.001);
    assert_non_null(strstr(report_said(&plan->report, "region.contours-overlap"),
                           "\"two-overlapping\": contours partly overlap on 10 of 10 planes. Their union was filled"));
    plan_destroy(plan);
}

static void padding_is_no_value_and_surplus_frames_are_said(void **state)
{
    (void)state;
    struct plan *plan = open_case("c26-padding-value");
    assert_true(plan->images[0].volume->low > -100);
    assert_true(report_has(&plan->report, "image.padding"));
    plan_destroy(plan);
    plan = open_case("d71-more-pixels-than-frames");
    assert_non_null(strstr(report_said(&plan->report, "dicom.surplus-pixels"), "(4 frames more)"));
    plan_destroy(plan);
}

static void one_uid_with_other_values_is_two_doses(void **state)
{
    (void)state;
    struct plan *plan = open_case("d45-same-uid-other-values");
    assert_int_equal(plan->n_doses, 2);
    assert_true(report_has(&plan->report, "dicom.same-uid"));
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contours_given_twice_have_the_volume_of_one),
        cmocka_unit_test(contours_that_overlap_are_a_union_and_said),
        cmocka_unit_test(padding_is_no_value_and_surplus_frames_are_said),
        cmocka_unit_test(one_uid_with_other_values_is_two_doses),
    };
    return cmocka_run_group_tests(tests, unpack, remove_unpacked);
}
