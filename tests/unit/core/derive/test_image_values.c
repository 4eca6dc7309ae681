/* Histograms and ellipses of images: closed forms, and counting by hand. */
#include "core/derive/image_histogram.h"
#include "core/volume/ellipse.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* ---- histogram -------------------------------------------------------------------------------------------------- */

static struct plan *plan_of(struct volume *volume)
{
    struct plan *plan = plan_create("made");
    (void)snprintf(plan->images[0].id, sizeof plan->images[0].id, "ct");
    plan->images[0].volume = volume;
    plan->n_images = 1;
    volume_measure(volume);
    return plan;
}

static struct volume *empty_volume(enum voxel_type type, uint32_t side)
{
    struct error err = { 0 };
    struct grid grid = made_cube_grid(side);
    struct volume *volume = volume_create(&grid, type, &err);
    assert_non_null(volume);
    return volume;
}

static struct image_histogram *histogram_of(const struct plan *plan)
{
    struct error err = { 0 };
    struct image_histogram *histogram = image_histogram_get(derived_of(plan), 0, &err);
    assert_string_equal(err.text, "");
    return histogram;
}

/* 1000 voxels with the values 1 .. 1000: p % of them are at most 10 p. */
static void percentiles_of_one_to_a_thousand_are_ten_times_the_percent(void **state)
{
    (void)state;
    static const double scales[][2] = { { 1, 0 }, { 0.5, -100 }, { -2, 7 } }; /* slope, offset */
    for (size_t s = 0; s < sizeof scales / sizeof scales[0]; s++)
        for (int type = VOXEL_I16; type <= VOXEL_F32; type++) {
            struct volume *volume = empty_volume((enum voxel_type)type, 10);
            for (int i = 0; i < 1000; i++) { /* in an order that is not theirs: 389 and 1000 have no common divisor */
                int value = 1 + i * 389 % 1000;
                if (type == VOXEL_I16)
                    ((int16_t *)volume->voxels)[i] = (int16_t)(value - 500);
                else if (type == VOXEL_U16)
                    ((uint16_t *)volume->voxels)[i] = (uint16_t)value;
                else
                    ((float *)volume->voxels)[i] = (float)value;
            }
            volume->slope = scales[s][0];
            volume->offset = scales[s][1];
            struct plan *plan = plan_of(volume);
            struct image_histogram *histogram = histogram_of(plan);
            double zero = type == VOXEL_I16 ? -500 : 0, range = histogram->high - histogram->low;
            static const double ranks[] = { 1, 10, 500, 990, 999 };
            for (int i = 0; i < IMAGE_HISTOGRAM_N_PERCENTILES; i++) {
                double raw = zero + (scales[s][0] > 0 ? ranks[i] : 1001 - ranks[i]);
                assert_close(histogram->percentiles[i], raw * scales[s][0] + scales[s][1],
                             type == VOXEL_F32 ? range * 0x1p-27 : 1e-9);
            }
            assert_int_equal(histogram->n, 1000);
            assert_int_equal(histogram->n_left_out, 0);
            uint64_t counts[10];
            image_histogram_counts(histogram, 10, counts);
            for (int i = 0; i < 10; i++)
                assert_in_range(counts[i], 99, 101); /* 999 / 10 wide: a bin's ends are not those of whole numbers */
            image_histogram_counts(histogram, 1, counts);
            assert_int_equal(counts[0], 1000);
            derive_result_unref(&histogram->base);
            plan_and_derived_destroy(plan);
        }
}

/* 8 values of equal number in 8 bins, the highest in the last one. */
static void the_largest_value_is_in_the_last_bin(void **state)
{
    (void)state;
    struct volume *volume = empty_volume(VOXEL_U8, 8);
    for (int i = 0; i < 512; i++)
        ((uint8_t *)volume->voxels)[i] = (uint8_t)(i % 8 * 10);
    struct plan *plan = plan_of(volume);
    struct image_histogram *histogram = histogram_of(plan);
    uint64_t counts[8];
    image_histogram_counts(histogram, 8, counts);
    for (int i = 0; i < 8; i++)
        assert_int_equal(counts[i], 64);
    assert_close(histogram->low, 0, 0);
    assert_close(histogram->high, 70, 0);
    derive_result_unref(&histogram->base);
    plan_and_derived_destroy(plan);
}

/* One voxel a million times brighter than all others must not make the percentiles coarse. */
static void an_outlier_and_gaps_leave_the_percentiles_fine(void **state)
{
    (void)state;
    struct volume *volume = empty_volume(VOXEL_F32, 10);
    float *voxels = volume->voxels;
    for (int i = 0; i < 1000; i++)
        voxels[i] = (float)(i * 389 % 1000) / 1000;
    voxels[0] = 1e6f; /* was 0 */
    voxels[1] = NAN;  /* was 0.389 */
    voxels[2] = INFINITY;
    voxels[3] = -INFINITY;
    struct plan *plan = plan_of(volume);
    struct image_histogram *histogram = histogram_of(plan);
    assert_int_equal(histogram->n, 997);
    assert_int_equal(histogram->n_left_out, 3);
    assert_close(histogram->high, 1e6, 0);
    assert_close(histogram->percentiles[2], 0.5, 0.01); /* by rank 499 of 997, and 1e6 / 2^28 */
    assert_close(histogram->percentiles[0], 0.001, 0.005);
    assert_close(histogram->percentiles[3], 0.99, 0.01);
    assert_close(histogram->percentiles[4], 1e6, 0.01); /* 99.9 % of 997 are 996.003: the 997th */
    derive_result_unref(&histogram->base);
    plan_and_derived_destroy(plan);
}

static void an_image_of_one_value_or_none_has_a_histogram(void **state)
{
    (void)state;
    for (int is_nan = 0; is_nan < 2; is_nan++) {
        struct volume *volume = empty_volume(VOXEL_F32, 4);
        for (int i = 0; i < 64; i++)
            ((float *)volume->voxels)[i] = is_nan ? NAN : 7.5f;
        struct plan *plan = plan_of(volume);
        struct image_histogram *histogram = histogram_of(plan);
        uint64_t counts[4];
        image_histogram_counts(histogram, 4, counts);
        assert_int_equal(counts[0] + counts[1] + counts[2] + counts[3], is_nan ? 0 : 64);
        if (is_nan)
            assert_true(isnan(histogram->percentiles[2]));
        else
            assert_close(histogram->percentiles[2], 7.5, 0);
        derive_result_unref(&histogram->base);
        plan_and_derived_destroy(plan);
    }
}

/* ---- ellipse ---------------------------------------------------------------------------------------------------- */

/* Voxels of 0.5 x 0.7 x 2 mm, turned about L: 60 mm a side. */
static struct grid fine_grid(void)
{
    const uint32_t size[3] = { 120, 86, 30 };
    double c = cos(0.3), s = sin(0.3);
    return made_grid(size[0], size[1], size[2],
                     made_affine(vec3(0.5, 0, 0), vec3(0, 0.7 * c, 0.7 * s), vec3(0, -2 * s, 2 * c), size,
                                 vec3(3, 4, 5)));
}

static const struct vec3 gradient = { 2, -1, 0.5 };
static double ramp(struct vec3 p)
{
    return 1000 + vec3_dot(gradient, p);
}

/* If a value is linear in the point, the mean is that at the centre, and the variance ((g.a)^2 + (g.b)^2) / 4 for half
 * axes a and b: of a gradient g along the half axis a the standard deviation is |g| a / 2. Sampling counts a rim of
 * half a step in or out: 0.25 mm of 6 and more. */
static void a_linear_image_has_the_closed_forms_mean_and_deviation(void **state)
{
    (void)state;
    static const struct vec3 centre = { 4.2, 3.1, 6.6 };
    static const struct vec3 axes[][2] = { { { 12, 0, 0 }, { 0, 8, 0 } },
                                           { { 0, 0, 9 }, { 0, 14, 0 } },
                                           { { 10, 5, 0 }, { -3, 6, 7 } },
                                           { { 8, -4, 8 }, { 6, 9, 0 } },     /* conjugate: not square to each other */
                                           { { -7, -7, 0 }, { 7, 0, -6 } } }; /* the other way round */
    struct grid grid = fine_grid();
    struct volume *volume = made_volume(&grid, VOXEL_F32, ramp);
    for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
        struct vec3 a = axes[i][0], b = axes[i][1];
        double ga = vec3_dot(gradient, a), gb = vec3_dot(gradient, b), area = MATH_PI * vec3_length(vec3_cross(a, b));
        struct ellipse_values values;
        assert_true(ellipse_values(volume, centre, vec3_add(centre, a), vec3_add(centre, b), &values));
        assert_close(values.area_mm2, area, 1e-9);
        assert_close(values.step_mm, 0.5, 1e-12);
        assert_close(values.mean, ramp(centre), 1e-3); /* floats of 1000 have 6e-5, the lattice is even */
        assert_near(values.sd, sqrt(ga * ga + gb * gb) / 2, 0.02);
        assert_near(values.n, area / 0.25, 0.03);
        assert_int_equal(values.n_left_out, 0);
        double reach = sqrt(ga * ga + gb * gb); /* the value at the rim, where it is farthest from the centre's */
        assert_close(values.high, ramp(centre) + reach, 0.12 * reach);
        assert_close(values.low, ramp(centre) - reach, 0.12 * reach);
    }
    volume_unref(volume);
}

static double gapped(struct vec3 p)
{
    return p.x > 3 ? (double)NAN : 7;
}

/* Half of the disc lies in the gap: but for the voxels of 0.5 mm along its edge. */
static void what_has_no_value_is_left_out_and_counted(void **state)
{
    (void)state;
    struct grid grid = fine_grid();
    struct volume *volume = made_volume(&grid, VOXEL_F32, gapped);
    struct ellipse_values values;
    const struct vec3 centre = vec3(3, 4, 5);
    assert_true(ellipse_values(volume, centre, vec3(13, 4, 5), vec3(3, 14, 5), &values));
    assert_close(values.mean, 7, 1e-12);
    assert_close(values.sd, 0, 1e-12);
    assert_near(values.n, MATH_PI * 50 / 0.25, 0.05);
    assert_near(values.n_left_out, MATH_PI * 50 / 0.25, 0.05);
    /* outside the grid */
    assert_true(ellipse_values(volume, vec3(500, 0, 0), vec3(510, 0, 0), vec3(500, 10, 0), &values));
    assert_int_equal(values.n, 0);
    assert_true(values.n_left_out > 1000);
    assert_true(isnan(values.mean) && isnan(values.sd) && isnan(values.low) && isnan(values.high));
    volume_unref(volume);
}

static void an_ellipse_of_any_size_takes_about_a_million_samples_at_the_most(void **state)
{
    (void)state;
    struct grid grid = fine_grid();
    struct volume *volume = made_volume(&grid, VOXEL_F32, ramp);
    struct ellipse_values values;
    const struct vec3 centre = vec3(3, 4, 5);
    static const double sizes[][2] = { { 400, 300 }, { 1e5, 1e5 }, { 1e5, 1e-6 }, { 1e-6, 1e-6 } };
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_true(ellipse_values(volume, centre, vec3_add(centre, vec3(sizes[i][0], 0, 0)),
                                   vec3_add(centre, vec3(0, sizes[i][1], 0)), &values));
        assert_true((double)(values.n + values.n_left_out) <= 1.1 * ELLIPSE_MAX_SAMPLES);
        assert_true(values.n >= 1); /* the centre */
    }
    assert_false(ellipse_values(volume, centre, vec3(4, 4, 5), vec3(9, 4, 5), &values)); /* on one line */
    assert_false(ellipse_values(volume, centre, centre, vec3(9, 4, 5), &values));
    volume_unref(volume);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(percentiles_of_one_to_a_thousand_are_ten_times_the_percent),
        cmocka_unit_test(the_largest_value_is_in_the_last_bin),
        cmocka_unit_test(an_outlier_and_gaps_leave_the_percentiles_fine),
        cmocka_unit_test(an_image_of_one_value_or_none_has_a_histogram),
        cmocka_unit_test(a_linear_image_has_the_closed_forms_mean_and_deviation),
        cmocka_unit_test(what_has_no_value_is_left_out_and_counted),
        cmocka_unit_test(an_ellipse_of_any_size_takes_about_a_million_samples_at_the_most),
    };
    return cmocka_run_group_tests_name("image_values", tests, NULL, NULL);
}
