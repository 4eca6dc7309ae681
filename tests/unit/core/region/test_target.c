/* Targets: which names say so, which region is the first, and where its middle is. */
#include "core/region/target.h"
#include "tests/check.h"
#include "tests/made_plan.h"

static void words_of_a_name_say_that_it_is_a_target(void **state)
{
    (void)state;
    static const char *const targets[] = { "GTV",       "ctv",     "PTV1",         "PTV_60Gy", "my tumour",
                                           "Tumor-bed", "LESIONS", "Target (MR)",  "GTVp",     "PTVsb1",
                                           "CTVn_left", "zz GTV",  "brain-tumour", "PTV-GTV",  "boost - PTV" };
    static const char *const others[] = { "",        "brain",   "targeted",        "nontumour", "GTVish",
                                          "gtvp",    "CTVx",    "lesional",        "TV",        "s",
                                          "Patient", "PT V",    "Lungs-PTV",       "Body-ctv",  "Ring_PTV",
                                          "NotPTV",  "not PTV", "shell around GTV" };
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++)
        if (!region_name_is_target(targets[i]))
            fail_msg("\"%s\" is a target", targets[i]);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (region_name_is_target(others[i]))
            fail_msg("\"%s\" is no target", others[i]);
}

/* 1: a ring of radii 4 and 8 in the plane S 2, around (3, 1); 2: two voxels; 3: none. */
static double rings(struct vec3 p)
{
    double r = hypot(p.x - 3, p.y - 1);
    if (fabs(p.z - 2) < 0.5 && r >= 4 && r <= 8)
        return 1;
    return fabs(p.z + 5) < 0.5 && fabs(p.y) < 0.5 && (fabs(p.x) < 0.5 || fabs(p.x - 1) < 0.5) ? 2 : 0;
}

static struct plan *ring_plan(void)
{
    static const struct made_region regions[] = { { "ring", -1, 0 }, { "pair", -1, 0 }, { "nothing", -1, 0 } };
    struct grid grid = made_cube_grid(31);
    return made_plan(&grid, rings, regions, 3);
}

static void the_first_target_is_found_by_type_or_name_and_has_voxels(void **state)
{
    (void)state;
    struct plan *plan = ring_plan();
    struct region_set *set = &plan->regions;
    assert_int_equal(region_first_target(set), -1);
    snprintf(set->regions[2].name, sizeof set->regions[2].name, "GTV"); /* without a voxel */
    assert_int_equal(region_first_target(set), -1);
    set->regions[1].parent = 2; /* now its descendant has some */
    assert_int_equal(region_first_target(set), 2);
    set->regions[1].is_target = true;
    assert_int_equal(region_first_target(set), 1);
    snprintf(set->regions[0].name, sizeof set->regions[0].name, "PTV");
    assert_int_equal(region_first_target(set), 0);
    plan_destroy(plan);
}

static void the_middle_is_the_centroid_or_the_nearest_univel(void **state)
{
    (void)state;
    struct plan *plan = ring_plan();
    struct vec3 pair = region_middle_lps_mm(&plan->regions, 1), ring = region_middle_lps_mm(&plan->regions, 0);
    assert_close(pair.x, 0.5, 1e-9); /* on the face between the two, which belongs to one of them */
    assert_close(pair.y, 0, 1e-9);
    assert_close(pair.z, -5, 1e-9);
    assert_close(hypot(ring.x - 3, ring.y - 1), 4, 1e-9); /* the inner edge, not the hole */
    assert_close(ring.z, 2, 1e-9);
    plan->regions.regions[1].parent = 0; /* with its child: (n ring + 2 pair) / (n + 2), still in the hole */
    struct vec3 both = region_middle_lps_mm(&plan->regions, 0);
    assert_true(hypot(both.x - 3, both.y - 1) > 3.9 || fabs(both.z + 5) < 1e-9);
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_of_a_name_say_that_it_is_a_target),
        cmocka_unit_test(the_first_target_is_found_by_type_or_name_and_has_voxels),
        cmocka_unit_test(the_middle_is_the_centroid_or_the_nearest_univel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
