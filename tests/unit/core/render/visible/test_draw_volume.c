/* The transfer function of a volume as a table, and where rays take their values. */
#include "core/render/visible/draw_volume.h"
#include "tests/check.h"

static float table[DRAW_VOLUME_TABLE][4];

/* The entry of a value between 0 and 1023, with entries at whole numbers. */
static const float *entry(const struct scene_transfer_point *points, size_t n, int value)
{
    draw_volume_table(points, n, 0, DRAW_VOLUME_TABLE - 1, table);
    return table[value];
}

static void between_two_points_colour_and_opacity_of_a_millimetre_are_linear(void **state)
{
    (void)state;
    const struct scene_transfer_point points[] = { { 100, 0xff0000, 0 }, { 500, 0x0000ff, 0.8 } };
    const float *quarter = entry(points, 2, 200);
    assert_close(quarter[0], 0.75, 1e-6);
    assert_close(quarter[1], 0, 1e-6);
    assert_close(quarter[2], 0.25, 1e-6);
    assert_close(exp(-quarter[3]), 1 - 0.2, 1e-6); /* what passes 1 mm */
    assert_close(exp(-2 * quarter[3]), 0.8 * 0.8, 1e-6);
}

static void beyond_the_outer_points_a_transfer_function_is_constant(void **state)
{
    (void)state;
    const struct scene_transfer_point points[] = { { 100, 0xff0000, 0.5 }, { 500, 0x0000ff, 0.25 } };
    assert_close(entry(points, 2, 3)[0], 1, 0);
    assert_close(exp(-entry(points, 2, 3)[3]), 0.5, 1e-6);
    assert_close(entry(points, 2, 1000)[2], 1, 0);
    assert_close(exp(-entry(points, 2, 1000)[3]), 0.75, 1e-6);
    assert_close(exp(-entry(points, 1, 1000)[3]), 0.5, 1e-6); /* of a single point too */
}

static void at_a_step_the_value_has_the_second_point(void **state)
{
    (void)state;
    const struct scene_transfer_point points[] = {
        { 0, 0, 0 }, { 300, 0, 0 }, { 300, 0xffffff, 0.5 }, { 900, 0xffffff, 0.5 }
    };
    assert_close(entry(points, 4, 299)[3], 0, 0);
    assert_close(exp(-entry(points, 4, 300)[3]), 0.5, 1e-6);
    assert_close(entry(points, 4, 300)[0], 1, 0);
}

static void an_opacity_of_one_counts_as_0_999(void **state)
{
    (void)state;
    const struct scene_transfer_point points[] = { { 0, 0, 1 } };
    assert_close(exp(-entry(points, 1, 5)[3]), 0.001, 1e-6);
}

/* Over 64 x 64 pixels the mean is 1/2, and each quarter of the interval holds a quarter, as with evenly spread numbers.
 */
static void rays_take_their_values_evenly_spread_over_the_interval(void **state)
{
    (void)state;
    for (int samples = 1; samples <= 2; samples++) {
        double sum = 0;
        int n_in_quarter[4] = { 0 };
        for (uint32_t y = 0; y < 64; y++)
            for (uint32_t x = 0; x < 64; x++) {
                double jitter = (double)draw_volume_jitter(x, y, samples);
                assert_true(jitter >= 0 && jitter < 1);
                sum += jitter / 4096;
                n_in_quarter[(int)(4 * jitter)]++;
            }
        assert_close(sum, 0.5, 0.01);
        for (int i = 0; i < 4; i++)
            assert_in_range(n_in_quarter[i], 1014, 1034);
    }
}

static void the_samples_of_a_pixel_are_a_quarter_of_the_interval_apart(void **state)
{
    (void)state;
    int seen = 0;
    for (uint32_t i = 0; i < 4; i++)
        seen |= 1 << (int)(4 * draw_volume_jitter(14 + (i & 1), 8 + (i >> 1), 2));
    assert_int_equal(seen, 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(between_two_points_colour_and_opacity_of_a_millimetre_are_linear),
        cmocka_unit_test(beyond_the_outer_points_a_transfer_function_is_constant),
        cmocka_unit_test(at_a_step_the_value_has_the_second_point),
        cmocka_unit_test(an_opacity_of_one_counts_as_0_999),
        cmocka_unit_test(rays_take_their_values_evenly_spread_over_the_interval),
        cmocka_unit_test(the_samples_of_a_pixel_are_a_quarter_of_the_interval_apart),
    };
    return cmocka_run_group_tests_name("draw_volume", tests, NULL, NULL);
}
