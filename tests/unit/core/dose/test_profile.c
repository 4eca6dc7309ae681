/* Regions and curves along a line. */
#include "core/dose/profile.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static double random_part(uint64_t *seed)
{
    return (double)next_random(seed) / 4294967296.0;
}

/* A set of one layer: label 1 is a box of univels, label 2 a smaller box in it, its child. */
static void make_boxes(struct region_set *set, struct region regions[2], struct vec3 origin, double spacing)
{
    struct error err = { 0 };
    struct affine map = { { { spacing, 0, 0 }, { 0, spacing, 0 }, { 0, 0, spacing } }, origin };
    struct grid grid;
    assert_true(grid_init(&grid, (uint32_t[]){ 40, 40, 40 }, &map, &err));
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err);
    assert_non_null(labels);
    for (uint32_t k = 5; k < 35; k++)
        for (uint32_t j = 5; j < 35; j++)
            for (uint32_t i = 5; i < 35; i++)
                ((uint8_t *)labels->voxels)[i + 40 * (j + 40 * k)] =
                    i >= 15 && i < 25 && j >= 15 && j < 25 && k >= 15 && k < 25 ? 2 : 1;
    memset(regions, 0, 2 * sizeof *regions);
    regions[0] = (struct region){ .id = "body", .label = 1, .parent = -1, .n_voxels = 30 * 30 * 30 - 1000 };
    regions[1] = (struct region){ .id = "tumour", .label = 2, .parent = 0, .n_voxels = 1000 };
    *set = (struct region_set){ .layers = { labels }, .n_layers = 1, .regions = regions, .n_regions = 2 };
}

/* Where a ray is within low <= p < high on all axes. */
static bool box_depths(struct vec3 from, struct vec3 direction, struct vec3 low, struct vec3 high, double depths[2])
{
    const double p[] = { from.x, from.y, from.z }, d[] = { direction.x, direction.y, direction.z },
                 a[] = { low.x, low.y, low.z }, b[] = { high.x, high.y, high.z };
    depths[0] = -INFINITY;
    depths[1] = INFINITY;
    for (int i = 0; i < 3; i++) {
        depths[0] = fmax(depths[0], fmin((a[i] - p[i]) / d[i], (b[i] - p[i]) / d[i]));
        depths[1] = fmin(depths[1], fmax((a[i] - p[i]) / d[i], (b[i] - p[i]) / d[i]));
    }
    return depths[0] < depths[1];
}

static void bands_end_where_the_line_crosses_the_boxes(void **state)
{
    (void)state;
    uint64_t seed = 9;
    for (int trial = 0; trial < 50; trial++) {
        struct region_set set;
        struct region regions[2];
        double spacing = 0.7 + random_part(&seed);
        struct vec3 origin = vec3(20 * random_part(&seed), -9 * random_part(&seed), random_part(&seed));
        make_boxes(&set, regions, origin, spacing);
        /* through a point of the inner box, from outside of the grid */
        struct vec3 through = vec3_add(origin, vec3_scale(vec3(15 + 9 * random_part(&seed), 15 + 9 * random_part(&seed),
                                                               15 + 9 * random_part(&seed)),
                                                          spacing));
        struct vec3 direction =
            vec3_normalize(vec3(random_part(&seed) - 0.5, random_part(&seed) - 0.5, random_part(&seed) - 0.5));
        struct ray line = { vec3_sub(through, vec3_scale(direction, 150)), direction, 0, 300 };
        double body[2], tumour[2];
        struct vec3 low = vec3_add(origin, vec3_scale(vec3(4.5, 4.5, 4.5), spacing)),
                    high = vec3_add(origin, vec3_scale(vec3(34.5, 34.5, 34.5), spacing)),
                    inner_low = vec3_add(origin, vec3_scale(vec3(14.5, 14.5, 14.5), spacing)),
                    inner_high = vec3_add(origin, vec3_scale(vec3(24.5, 24.5, 24.5), spacing));
        assert_true(box_depths(line.from_lps_mm, direction, low, high, body));
        assert_true(box_depths(line.from_lps_mm, direction, inner_low, inner_high, tumour));
        struct ray_band *bands;
        size_t n;
        struct error err = { 0 };
        assert_true(ray_bands(&set, &line, &bands, &n, &err));
        assert_int_equal(n, 3);
        const double expected[][2] = { { body[0], tumour[0] }, { tumour[0], tumour[1] }, { tumour[1], body[1] } };
        for (size_t i = 0; i < 3; i++) {
            assert_int_equal(bands[i].region, i == 1);
            assert_close(bands[i].from_mm, expected[i][0], 1e-6);
            assert_close(bands[i].to_mm, expected[i][1], 1e-6);
        }
        free(bands);
        volume_unref(set.layers[0]);
    }
}

static void a_line_along_a_row_of_univels_and_a_line_beside_all_have_their_bands(void **state)
{
    (void)state;
    struct region_set set;
    struct region regions[2];
    struct ray_band *bands;
    size_t n;
    struct error err = { 0 };
    make_boxes(&set, regions, vec3(0, 0, 0), 1);
    struct ray row = { vec3(20, 20, 8), vec3(0, 0, 1), 0, 20 }; /* from within the body */
    assert_true(ray_bands(&set, &row, &bands, &n, &err));
    assert_int_equal(n, 3);
    assert_close(bands[0].from_mm, 0, 1e-9);
    assert_close(bands[1].from_mm, 6.5, 1e-9);
    assert_close(bands[2].from_mm, 16.5, 1e-9);
    assert_close(bands[2].to_mm, 20, 1e-9);
    free(bands);
    struct ray beside = { vec3(80, 0, 0), vec3(0, 0, 1), 0, 50 };
    assert_true(ray_bands(&set, &beside, &bands, &n, &err));
    assert_int_equal(n, 0);
    free(bands);
    volume_unref(set.layers[0]);
}

static void the_advantage_depth_of_exponentials_has_its_closed_form(void **state)
{
    (void)state;
    /* tumour T e^(-d/l) with the normal tissue's maximum N: the same at d = l ln(T/N) */
    struct profile_line line = { { vec3(0, 0, 0), vec3(0, 0, 1), 0, 120 }, 1201 };
    double tumour[1201], depth;
    for (size_t i = 0; i < line.n; i++)
        tumour[i] = 40 * exp(-profile_depth(&line, i) / 35);
    tumour[3] = NAN;
    assert_true(profile_advantage_depth(&line, tumour, 9, &depth));
    assert_close(depth, 35 * log(40.0 / 9), 1e-4); /* linear within 0.1 mm: f'' h^2 / 8 f' = h^2 / (8 l) */
    assert_false(profile_advantage_depth(&line, tumour, 1, &depth));  /* still above at the end */
    assert_false(profile_advantage_depth(&line, tumour, 50, &depth)); /* never as much */
    size_t at;
    assert_true(profile_peak(tumour, line.n, &at));
    assert_int_equal(at, 0);
    assert_false(profile_peak((double[]){ NAN, NAN }, 2, &at));
}

static void a_line_is_clipped_at_a_grids_outer_faces(void **state)
{
    (void)state;
    struct affine map = { { { 2, 0, 0 }, { 0, 0, 3 }, { 0, -2, 0 } }, { 10, 0, 0 } };
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[]){ 10, 5, 8 }, &map, &err));
    struct ray line = { vec3(15, -6, -100), vec3(0, 0, 1), 0, 1000 };
    double low = 0, high = 1000;
    assert_true(ray_clip(&line, &grid, &low, &high));
    assert_close(low, 98.5, 1e-9);   /* j = -0.5 */
    assert_close(high, 113.5, 1e-9); /* j = 4.5 */
    line.from_lps_mm.x = 40;
    assert_false(ray_clip(&line, &grid, &low, &high));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bands_end_where_the_line_crosses_the_boxes),
        cmocka_unit_test(a_line_along_a_row_of_univels_and_a_line_beside_all_have_their_bands),
        cmocka_unit_test(the_advantage_depth_of_exponentials_has_its_closed_form),
        cmocka_unit_test(a_line_is_clipped_at_a_grids_outer_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
