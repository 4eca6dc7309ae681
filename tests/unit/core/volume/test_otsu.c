/* Otsu's threshold of a volume, and the box of what lies above it. */
#include "core/volume/otsu.h"

#include "core/math/vec.h"
#include "tests/check.h"
#include "tests/made_plan.h"

/* A bright block of 20 x 12 x 8 mm about (4, -2, 3) in the dark, with a gradient in both. */
static double block(struct vec3 p)
{
    bool is_in = fabs(p.x - 4) < 10 && fabs(p.y + 2) < 6 && fabs(p.z - 3) < 4;
    return (is_in ? 180 : 20) + 0.3 * p.x;
}

static double flat(struct vec3 p)
{
    (void)p;
    return 7;
}

static struct volume *volume_of(double (*value)(struct vec3), uint32_t n, double step_mm, enum voxel_type type)
{
    const uint32_t size[3] = { n, n, n };
    struct grid grid =
        made_grid(n, n, n,
                  made_affine(vec3(step_mm, 0, 0), vec3(0, step_mm, 0), vec3(0, 0, step_mm), size, vec3(0, 0, 0)));
    struct volume *volume = made_volume(&grid, type, value);
    volume_measure(volume);
    return volume;
}

static void the_box_of_what_is_bright_is_that_of_the_block(void **state)
{
    (void)state;
    for (uint32_t n = 40; n <= 320; n *= 8) { /* of the second volume, every third voxel is looked at along each axis */
        double step_mm = 40.0 / n;
        struct volume *volume = volume_of(block, n, step_mm, VOXEL_U8);
        double threshold = otsu_threshold(volume);
        assert_true(threshold > 30 && threshold < 170);
        struct box3 box = otsu_box_lps_mm(volume, threshold);
        double slack = n > 128 ? 3 * step_mm : 1e-9; /* the sides lie between voxels' centres, on their faces */
        const double low[3] = { -6, -8, -1 }, high[3] = { 14, 4, 7 };
        const double *found_low = &box.low.x, *found_high = &box.high.x;
        for (int axis = 0; axis < 3; axis++) {
            assert_true(found_low[axis] <= low[axis] + 1e-9 && found_low[axis] >= low[axis] - slack);
            assert_true(found_high[axis] >= high[axis] - 1e-9 && found_high[axis] <= high[axis] + slack);
        }
        volume_unref(volume);
    }
}

static void a_volume_of_one_value_has_no_threshold(void **state)
{
    (void)state;
    struct volume *volume = volume_of(flat, 8, 1, VOXEL_F32);
    assert_true(isnan(otsu_threshold(volume)));
    struct box3 box = otsu_box_lps_mm(volume, 8);
    assert_true(box3_is_empty(&box));
    volume_unref(volume);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_box_of_what_is_bright_is_that_of_the_block),
        cmocka_unit_test(a_volume_of_one_value_has_no_threshold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
