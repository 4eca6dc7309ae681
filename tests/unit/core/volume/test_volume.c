/* Grids and volumes: maps, axes, sampling, limits. */
#include "core/volume/volume.h"
#include "tests/check.h"

static struct grid oblique_grid(void)
{
    /* 30 degrees about S, spacings 1, 2, 3 mm, k downward: left-handed on purpose */
    double c = cos(MATH_PI / 6), s = sin(MATH_PI / 6);
    struct affine map = { { { c, s, 0 }, { -2 * s, 2 * c, 0 }, { 0, 0, -3 } }, { 10, -20, 30 } };
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[3]){ 8, 6, 4 }, &map, &err));
    return grid;
}

static void an_index_goes_to_the_patient_and_back(void **state)
{
    (void)state;
    struct grid grid = oblique_grid();
    struct vec3 p = affine_point(&grid.lps_mm_from_ijk, vec3(1, 2, 3));
    /* by hand: x = 10 + cos30 - 4 sin30, y = -20 + sin30 + 4 cos30, z = 30 - 9 */
    assert_close(p.x, 10 + 0.8660254037844387 - 2, 1e-12);
    assert_close(p.y, -20 + 0.5 + 4 * 0.8660254037844387, 1e-12);
    assert_close(p.z, 21, 1e-12);
    struct vec3 back = affine_point(&grid.ijk_from_lps_mm, p);
    assert_close(back.x, 1, 1e-12);
    assert_close(back.y, 2, 1e-12);
    assert_close(back.z, 3, 1e-12);
    assert_close(grid_voxel_mm3(&grid), 6, 1e-12);
    int sign;
    assert_int_equal(grid_index_axis(&grid, 2, &sign), 2);
    assert_int_equal(sign, -1);
}

static void a_grid_says_toward_which_side_each_index_grows(void **state)
{
    (void)state;
    char letters[4];
    struct grid grid = oblique_grid();
    grid_letters(&grid, letters);
    assert_string_equal(letters, "LPI"); /* 30 degrees about S: L and P are still nearest; k goes down */
    /* a sagittal scan: columns to posterior, rows down, slices to the right */
    struct affine map = { { { 0, 1, 0 }, { 0, 0, -1 }, { -3, 0, 0 } }, { 0, 0, 0 } };
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[3]){ 4, 4, 4 }, &map, &err));
    grid_letters(&grid, letters);
    assert_string_equal(letters, "PIR");
}

static void a_singular_or_absurd_geometry_is_refused(void **state)
{
    (void)state;
    struct grid grid;
    struct error err = { 0 };
    struct affine flat = { { { 1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
    assert_false(grid_init(&grid, (uint32_t[3]){ 2, 2, 2 }, &flat, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    struct affine nan_origin = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { NAN, 0, 0 } };
    assert_false(grid_init(&grid, (uint32_t[3]){ 2, 2, 2 }, &nan_origin, &err));
    struct affine unit = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
    assert_false(grid_init(&grid, (uint32_t[3]){ 65535, 65535, 2 }, &unit, &err));
    assert_false(grid_init(&grid, (uint32_t[3]){ 0, 2, 2 }, &unit, &err));
}

static void sampling_is_linear_inside_and_refuses_outside(void **state)
{
    (void)state;
    struct grid grid = oblique_grid();
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, VOXEL_I16, &err);
    int16_t *voxels = volume->voxels;
    /* linear, so trilinear interpolation is exact */
    for (int k = 0, at = 0; k < 4; k++)
        for (int j = 0; j < 6; j++)
            for (int i = 0; i < 8; i++)
                voxels[at++] = (int16_t)(i + 10 * j + 100 * k);
    volume->slope = 2;
    volume->offset = -1000;
    volume_measure(volume);
    assert_close(volume->low, -1000, 0);
    assert_close(volume->high, 2 * 357 - 1000, 0);
    double value;
    assert_true(volume_sample(volume, affine_point(&grid.lps_mm_from_ijk, vec3(2.25, 3.5, 1.75)), &value));
    assert_close(value, 2 * (2.25 + 35 + 175) - 1000, 1e-9);
    assert_true(volume_sample(volume, affine_point(&grid.lps_mm_from_ijk, vec3(-0.4, 0, 0)),
                              &value)); /* half a voxel out: clamped */
    assert_close(value, -1000, 1e-9);
    assert_false(volume_sample(volume, affine_point(&grid.lps_mm_from_ijk, vec3(-0.6, 0, 0)), &value));
    assert_false(volume_sample(volume, vec3(NAN, 0, 0), &value));
    volume_unref(volume);
}

static void a_grid_that_reaches_out_of_the_room_is_refused_with_its_corner(void **state)
{
    (void)state;
    const uint32_t size[3] = { 11, 2, 2 };
    struct grid grid;
    struct affine map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { GRID_FARTHEST_MM - 10, 0, 0 } };
    struct error err = { 0 };
    assert_true(grid_init(&grid, size, &map, &err)); /* the last voxel is at the limit */
    map.origin.x += 1;
    assert_false(grid_init(&grid, size, &map, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_non_null(strstr(err.text, "L 10001 P 0 S 0 mm; expected within 10000 mm"));
}

/* If no binary number equals the grid's steps, every centre is a rounding error beside a whole index. */
static void a_voxel_s_centre_has_its_value_whatever_lies_beside_it(void **state)
{
    (void)state;
    struct affine map = { { { 3.906, 0, 0 }, { 0, -3.906, 0 }, { 0, 0, 2.5000001 } }, { -250.1, 249.93, -77.7 } };
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (const uint32_t[3]){ 40, 40, 40 }, &map, &err));
    struct volume *volume = volume_create(&grid, VOXEL_F32, &err);
    assert_non_null(volume);
    for (uint32_t at = 0; at < 40 * 40 * 40; at++)
        ((float *)volume->voxels)[at] = (at % 40 + at / 40 + at / 1600) % 2 ? NAN : 7;
    for (uint32_t at = 0; at < 40 * 40 * 40; at++) {
        struct vec3 centre = affine_point(&map, vec3(at % 40, at / 40 % 40, at / 1600));
        bool is_number = !isnan(((float *)volume->voxels)[at]);
        double value = 0;
        if (volume_sample(volume, centre, &value) != is_number || (is_number && value != 7))
            fail_msg("voxel %u", at);
    }
    volume_unref(volume);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_voxel_s_centre_has_its_value_whatever_lies_beside_it),
        cmocka_unit_test(a_grid_that_reaches_out_of_the_room_is_refused_with_its_corner),
        cmocka_unit_test(an_index_goes_to_the_patient_and_back),
        cmocka_unit_test(a_grid_says_toward_which_side_each_index_grows),
        cmocka_unit_test(a_singular_or_absurd_geometry_is_refused),
        cmocka_unit_test(sampling_is_linear_inside_and_refuses_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
