/* Filling contours: against hand counts, formulas, and a slow test of every voxel. */

#include "tests/check.h"
#include "tests/unit/made_contours.h"
#include "tests/unit/made_mask.h"

static double area_of(const struct mask *mask, uint32_t k)
{
    double n = 0;
    for (uint32_t j = 0; j < mask->size[1]; j++)
        for (uint32_t i = 0; i < mask->size[0]; i++)
            n += mask_has(mask, i, j, k);
    return n;
}

static void assert_same_mask(const struct mask *a, const struct mask *b)
{
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_memory_equal(a->bits, b->bits, (size_t)a->words * a->size[1] * a->size[2] * sizeof *a->bits);
}

static void a_square_fills_the_voxels_whose_centres_it_holds(void **state)
{
    (void)state;
    struct grid grid = grid_make(70, 12, 3, 1, 1, 2, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    contours_add_box(&set, 1.5, 2.5, 66.5, 7.5, 2); /* i 2..66, j 3..7, k 1 */
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 12; j++)
            for (uint32_t i = 0; i < 70; i++)
                assert_int_equal(mask_has(mask, i, j, k), i >= 2 && i <= 66 && j >= 3 && j <= 7 && k == 1);
    assert_int_equal(facts.n_planes, 1);
    assert_close(facts.polygon_cm3, 65 * 5 * 2 / 1000.0, 1e-9);
    assert_close(facts.filled_cm3, 65 * 5 * 2 / 1000.0, 1e-12);
    assert_close(facts.spacing_mm, 2, 1e-12); /* one plane: the grid's own slices */
    assert_int_equal(facts.n_outside, 0);
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void holes_and_islands_alternate(void **state)
{
    (void)state;
    struct grid grid = grid_make(40, 40, 1, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    contours_add_box(&set, 2.5, 2.5, 36.5, 36.5, 0);   /* 34 x 34 */
    contours_add_box(&set, 7.5, 7.5, 31.5, 31.5, 0);   /* hole, 24 x 24 */
    contours_add_box(&set, 12.5, 12.5, 26.5, 26.5, 0); /* island, 14 x 14 */
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    assert_close(area_of(mask, 0), 34 * 34 - 24 * 24 + 14 * 14, 0);
    assert_close(facts.polygon_cm3, (34 * 34 - 24 * 24 + 14 * 14) / 1000.0, 1e-9);
    assert_true(mask_has(mask, 5, 20, 0));
    assert_false(mask_has(mask, 10, 20, 0));
    assert_true(mask_has(mask, 20, 20, 0));
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void a_keyhole_is_a_hole(void **state)
{
    (void)state;
    struct grid grid = grid_make(60, 60, 1, 0.7, 0.7, 1, vec3(0, 0, 0));
    struct contour_set keyhole = { 0 }, pair = { 0 };
    /* outer edge, then along a zero-width channel that is parallel to neither rows nor columns, around the hole, and
     * back */
    const double xy[] = { 3, 3, 35, 4, 33, 36, 4, 34, 3, 3, 12.3, 13.1, 14, 24, 23, 22, 24, 12, 12.3, 13.1 };
    contours_add(&keyhole, xy, 10, 0);
    contours_add(&pair, xy, 4, 0);
    contours_add(&pair, xy + 10, 4, 0);
    struct mask *one = contours_fill(&keyhole, &grid, NULL), *two = contours_fill(&pair, &grid, NULL);
    assert_same_mask(one, two);
    assert_true(mask_count(one) > 1000);
    mask_destroy(one);
    mask_destroy(two);
    contour_set_finish(&keyhole);
    contour_set_finish(&pair);
}

static void a_circle_has_its_area(void **state)
{
    (void)state;
    struct grid grid = grid_make(100, 100, 13, 0.5, 0.5, 3, vec3(-25, -25, -18));
    struct contour_set set = { 0 };
    for (int k = -5; k <= 5; k++)
        contours_add_circle(&set, 0.123, -0.456, 20, 90, 3 * k);
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    double expected_cm3 = circle_mm2(20, 90) * 33 / 1000;
    assert_near(facts.polygon_cm3, expected_cm3, 1e-9);
    /* 80 voxels across: a border of 250 voxels, each wrong by half a voxel at random */
    assert_near(facts.filled_cm3, expected_cm3, 2e-3);
    assert_int_equal(facts.n_planes, 11);
    assert_close(facts.spacing_mm, 3, 1e-9);
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void neighbours_that_share_an_edge_share_no_voxel(void **state)
{
    (void)state;
    struct grid grid = grid_make(64, 64, 4, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set left = { 0 }, right = { 0 }, whole = { 0 };
    const double border[] = { 30, 10, 30, 20, 34.7, 33.3, 30, 50 }; /* partly through voxel centres */
    contours_add(&left, (double[]){ 10, 10, 30, 10, 30, 20, 34.7, 33.3, 30, 50, 10, 50 }, 6, 1);
    contours_add(&right,
                 (double[]){ 50, 10, border[0], border[1], border[2], border[3], border[4], border[5], border[6],
                             border[7], 50, 50 },
                 6, 1);
    contours_add_box(&whole, 10, 10, 50, 50, 1);
    struct mask *a = contours_fill(&left, &grid, NULL), *b = contours_fill(&right, &grid, NULL),
                *c = contours_fill(&whole, &grid, NULL);
    assert_int_equal(mask_count(c), 40 * 40);
    for (size_t i = 0; i < (size_t)a->words * 64 * 4; i++) {
        assert_int_equal(a->bits[i] & b->bits[i], 0);
        assert_int_equal(a->bits[i] | b->bits[i], c->bits[i]);
    }
    mask_destroy(a);
    mask_destroy(b);
    mask_destroy(c);
    contour_set_finish(&left);
    contour_set_finish(&right);
    contour_set_finish(&whole);
}

static void a_figure_of_eight_fills_both_loops(void **state)
{
    (void)state;
    struct grid grid = grid_make(40, 20, 1, 1, 1, 1, vec3(0.5, 0.25, 0));
    struct contour_set set = { 0 };
    /* crosses itself in the middle: its two halves turn opposite ways */
    contours_add(&set, (double[]){ 0, 0, 40, 20, 40, 0, 0, 20 }, 4, 0);
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    assert_int_equal(facts.n_degenerate, 0);
    assert_close(facts.polygon_cm3, 0.4, 1e-9); /* two triangles, 20 high and 20 wide */
    assert_near(facts.filled_cm3, 0.4, 0.03);
    assert_true(mask_has(mask, 3, 10, 0) && mask_has(mask, 36, 10, 0));
    assert_false(mask_has(mask, 20, 2, 0) || mask_has(mask, 20, 17, 0));
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void planes_stand_for_slabs_whatever_the_slices(void **state)
{
    (void)state;
    /* planes every 5 mm from 0 to 20 stand for -2.5..22.5; slices every 2 mm */
    struct grid grid = grid_make(20, 20, 30, 1, 1, 2, vec3(0, 0, -20));
    struct contour_set set = { 0 };
    for (int i = 4; i >= 0; i--) /* in any sequence */
        contours_add_box(&set, 4.5, 4.5, 9.5 + i, 9.5, 5 * i);
    struct mask *mask = contours_fill(&set, &grid, NULL);
    for (uint32_t k = 0; k < 30; k++) {
        double z = -20 + 2.0 * k;
        int plane = (int)floor((z + 2.5) / 5);
        assert_close(area_of(mask, k), z >= -2.5 && z < 22.5 ? (5 + plane) * 5 : 0, 0);
    }
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void a_real_gap_is_not_filled(void **state)
{
    (void)state;
    struct grid grid = grid_make(10, 10, 40, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    for (int i = 0; i < 10; i++)
        if (i < 4 || i > 6) /* planes 0 3 6 9 and 21 24 27: between 10.5 and 19.5 there is nothing */
            contours_add_box(&set, 1.5, 1.5, 6.5, 6.5, 3 * i);
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    for (uint32_t k = 0; k < 40; k++)
        assert_close(area_of(mask, k), (k <= 10 || (k >= 20 && k <= 28)) ? 25 : 0, 0);
    assert_int_equal(facts.n_gaps, 1);
    assert_close(facts.widest_gap_mm, 12, 1e-9);
    assert_close(facts.polygon_cm3, 25 * 3 * 7 / 1000.0, 1e-9);
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void two_lonely_planes_are_not_joined(void **state)
{
    (void)state;
    struct grid grid = grid_make(10, 10, 40, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    contours_add_box(&set, 1.5, 1.5, 6.5, 6.5, 5);
    contours_add_box(&set, 1.5, 1.5, 6.5, 6.5, 30);
    struct contour_options options = contour_defaults;
    options.spacing_mm = 3; /* the spacing of the other regions of the set */
    struct contour_facts facts;
    struct error err = { 0 };
    struct mask *mask = contour_fill(&set, &grid, &options, &facts, &err);
    assert_non_null(mask);
    assert_int_equal(mask_count(mask), 2 * 3 * 25);
    assert_int_equal(facts.n_gaps, 1);
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void slices_half_way_between_planes_are_filled_once(void **state)
{
    (void)state;
    struct grid grid = grid_make(10, 10, 30, 1, 1, 2.5, vec3(0, 0, -20.05));
    struct contour_set set = { 0 };
    for (int i = 0; i < 6; i++)
        contours_add_box(&set, 1.5, 1.5, 6.5, 6.5, -0.05 + 1.25 + 2.5 * i); /* every border of a slab is a slice */
    struct mask *mask = contours_fill(&set, &grid, NULL);
    assert_int_equal(mask_count(mask), 6 * 25);
    mask_destroy(mask);
    contour_set_finish(&set);
}

/* A tilted ring with a hole and an island beside it, on eight planes, in its own axes. */
static struct contour_set made_ring(void)
{
    struct contour_set set = { 0 };
    for (int i = 0; i < 8; i++) {
        contours_add_circle(&set, 1.1, 2.2, 14 - i, 37, 2.5 * i - 7.3);
        contours_add_circle(&set, 2.7, 3.1, 5, 5, 2.5 * i - 7.3);
        contours_add_box(&set, 16.3, -4.1, 21.2, 3.9, 2.5 * i - 7.3);
    }
    return set;
}

static void compare_with_every_voxel(const struct contour_set *set, const struct affine *turn, const struct grid *grid)
{
    struct mask *mask = contours_fill(set, grid, NULL);
    struct vec3 normal = turn->columns[2],
                u = vec3_normalize(vec3_add(turn->columns[0], vec3_scale(turn->columns[1], 0.3)));
    size_t n = 0;
    for (uint32_t k = 0; k < grid->size[2]; k++)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                struct vec3 point = affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k));
                bool is_inside = contours_enclose(set, normal, u, 1.25, point);
                if (mask_has(mask, i, j, k) != is_inside)
                    fail_msg("voxel %u %u %u: %d, expected %d", i, j, k, !is_inside, is_inside);
                n += is_inside;
            }
    assert_true(n > 500);
    mask_destroy(mask);
}

static void any_orientation_is_filled_as_each_voxel_says(void **state)
{
    (void)state;
    const struct affine turns[] = { rotation_of(0, 0, 0),           rotation_of(0, MATH_PI / 2, 0),
                                    rotation_of(0, 0, MATH_PI / 2), rotation_of(0.4, 0, 0),
                                    rotation_of(0.1, 0.2, 0.3),     rotation_of(1, -2, 3),
                                    rotation_of(-0.7, 0.02, 0.1),   rotation_of(2, MATH_PI / 2, 1) };
    for (size_t t = 0; t < sizeof turns / sizeof turns[0]; t++)
        for (int upside_down = 0; upside_down < 2; upside_down++) {
            struct contour_set set = made_ring();
            contours_move(&set, &turns[t]);
            struct grid grid = grid_make(66, 35, 28, upside_down ? -0.9 : 0.9, 1.3, upside_down ? -1.7 : 1.7,
                                         upside_down ? vec3(27.017, -21.013, 24.011) : vec3(-27.017, -21.013, -24.011));
            compare_with_every_voxel(&set, &turns[t], &grid);
            contour_set_finish(&set);
        }
}

static void an_oblique_grid_is_filled_as_each_voxel_says(void **state)
{
    (void)state;
    struct affine none = rotation_of(0, 0, 0), turn = rotation_of(0.3, -0.2, 0.5);
    struct affine map = { { vec3_scale(turn.columns[0], 1.1), vec3_scale(turn.columns[1], 0.8),
                            vec3_scale(turn.columns[2], 2.3) },
                          vec3(-24.003, -31.007, -19.001) };
    struct grid grid;
    assert_true(grid_init(&grid, (uint32_t[3]){ 40, 60, 30 }, &map, NULL));
    struct contour_set set = made_ring();
    compare_with_every_voxel(&set, &none, &grid);
    contour_set_finish(&set);
}

static void rows_sheared_by_a_tilted_gantry_are_filled_as_each_voxel_says(void **state)
{
    (void)state;
    struct affine none = rotation_of(0, 0, 0);
    struct affine map = { { { 1.1, 0, 0 }, { 0, 0.8, 0 }, { 0.2, 0.7, 2.3 } }, vec3(-24.003, -31.007, -19.001) };
    struct grid grid;
    assert_true(grid_init(&grid, (uint32_t[3]){ 50, 70, 20 }, &map, NULL));
    struct contour_set set = made_ring();
    compare_with_every_voxel(&set, &none, &grid);
    contour_set_finish(&set);
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    (void)state;
    struct contour_set set = made_ring();
    struct grid grid = grid_make(66, 35, 28, 0.9, 1.3, 0.7, vec3(-27.017, -21.013, -9.011));
    struct contour_options options = contour_defaults;
    struct mask *first = NULL;
    for (options.n_threads = 1; options.n_threads < 40; options.n_threads = 3 * options.n_threads + 1) {
        struct error err = { 0 };
        struct mask *mask = contour_fill(&set, &grid, &options, NULL, &err);
        assert_non_null(mask);
        if (first) {
            assert_same_mask(first, mask);
            mask_destroy(mask);
        } else {
            first = mask;
        }
    }
    mask_destroy(first);
    contour_set_finish(&set);
}

static void what_cannot_be_filled_is_counted_and_left_out(void **state)
{
    (void)state;
    struct grid grid = grid_make(40, 40, 10, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    contours_add_box(&set, 4.5, 4.5, 24.5, 24.5, 5);
    contours_add_box(&set, 4.5, 4.5, 24.5, 24.5, 5); /* repeated: still no hole */
    contours_add(&set, (double[]){ 1, 1, 2, 2 }, 2, 5);
    contours_add(&set, (double[]){ 0 }, 0, 5);
    contours_add(&set, (double[]){ 1, 1, 2, 2, 3, 3, 9, 9 }, 4, 5);
    contours_add(&set, (double[]){ 7, 7, 7, 7, 7, 7 }, 3, 5);
    contours_add(&set, (double[]){ 1, 1, NAN, 2, 3, 1 }, 3, 5);
    contours_add(&set, (double[]){ 1, 1, 5, 2, 3, INFINITY }, 3, 5);
    contours_add(&set, (double[]){ 1, 1, 1e300, 2, 3, -1e300 }, 3, 5);
    contours_add_points(&set, (double[]){ 1, 1, 1, 9, 1, 1, 9, 1, 9 }, 3); /* upright */
    contours_add_points(&set, (double[]){ 30.5, 30.5, 5.01, 34.5, 30.5, 4.98, 34.5, 34.5, 5.02, 30.5, 34.5, 4.99 }, 4);
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    assert_int_equal(facts.n_repeated, 1);
    assert_int_equal(facts.n_degenerate, 4);
    assert_int_equal(facts.n_not_finite, 3);
    assert_int_equal(facts.n_not_parallel, 1);
    assert_int_equal(facts.n_not_planar, 1);
    assert_int_equal(facts.n_planes, 1);
    assert_int_equal(mask_count(mask), 20 * 20 + 4 * 4);
    mask_destroy(mask);
    contour_set_finish(&set);
}

static void nothing_to_fill_is_an_empty_mask(void **state)
{
    (void)state;
    struct grid grid = grid_make(4, 4, 4, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    assert_int_equal(mask_count(mask), 0);
    assert_int_equal(facts.n_planes, 0);
    mask_destroy(mask);
}

static void what_lies_beyond_the_grid_is_cut_and_counted(void **state)
{
    (void)state;
    struct grid grid = grid_make(20, 20, 6, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    contours_add_box(&set, -30, -30, 9.5, 9.5, 2);       /* from the corner: 10 x 10 */
    contours_add_box(&set, 15.5, -80, 99, 99, 3);        /* the right side: 4 x 20 */
    contours_add_box(&set, -5000, -5000, 5000, 5000, 4); /* all of it */
    contours_add_box(&set, 100, 100, 120, 120, 1);       /* nothing of it */
    contours_add_box(&set, 3.5, 3.5, 4.5, 4.5, 0);
    contours_add_box(&set, 3.5, 3.5, 4.5, 4.5, 70);
    struct contour_facts facts;
    struct mask *mask = contours_fill(&set, &grid, &facts);
    assert_int_equal(mask_count(mask), 100 + 80 + 400 + 1);
    assert_int_equal(facts.n_outside, 5);
    mask_destroy(mask);
    contour_set_finish(&set);
}

/* A comb of n teeth from left to right, or from bottom to top. */
static struct contour_set made_comb(size_t n, bool is_upright, double height)
{
    double *xy = malloc(2 * n * sizeof *xy);
    assert_non_null(xy);
    for (size_t i = 0; i < n; i++) {
        double along = 500.0 * (double)i / (double)n, across = i % 2 ? height : 1;
        xy[2 * i] = is_upright ? along : across;
        xy[2 * i + 1] = is_upright ? across : along;
    }
    struct contour_set set = { 0 };
    contours_add(&set, xy, n, 5);
    free(xy);
    return set;
}

static void a_million_points_are_filled_or_refused_in_time(void **state)
{
    (void)state;
    struct grid grid = grid_make(512, 512, 10, 1, 1, 1, vec3(0, 0, 0));
    for (int is_upright = 0; is_upright < 2; is_upright++) {
        struct contour_set set = made_comb(1000000, is_upright, 500);
        struct error err = { 0 };
        struct contour_facts facts;
        double start_s = cpu_s();
        struct mask *mask = contour_fill(&set, &grid, &contour_defaults, &facts, &err);
        assert_true(mask || err.code == ERROR_LIMIT);
        assert_true(cpu_s() - start_s < 20); /* with sanitizers; without, it takes a second */
        mask_destroy(mask);
        contour_set_finish(&set);
    }
    struct contour_set fine = { 0 };
    contours_add_circle(&fine, 256, 256, 200, 1000000, 5);
    struct mask *mask = contours_fill(&fine, &grid, NULL);
    assert_near((double)mask_count(mask), MATH_PI * 200 * 200, 1e-3);
    mask_destroy(mask);
    contour_set_finish(&fine);
}

static void more_than_the_written_limits_is_refused(void **state)
{
    (void)state;
    struct grid grid = grid_make(4, 4, 4, 1, 1, 1, vec3(0, 0, 0));
    struct error err = { 0 };
    struct contour_set set = { 0 };
    for (size_t i = 0; i < CONTOUR_MAX_PLANES + 1; i++)
        contours_add_box(&set, 0, 0, 1, 1, (double)i);
    assert_null(contour_fill(&set, &grid, &contour_defaults, NULL, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_string_equal(err.text, "contours on 8193 planes; the limit is 8192");
    contour_set_finish(&set);

    struct contour huge = { .n_points = CONTOUR_MAX_POINTS + 1 };
    set = (struct contour_set){ &huge, 1 };
    assert_null(contour_fill(&set, &grid, &contour_defaults, NULL, &err));
    assert_string_equal(err.text, "contours of 10000001 points; the limit is 10000000");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_square_fills_the_voxels_whose_centres_it_holds),
        cmocka_unit_test(holes_and_islands_alternate),
        cmocka_unit_test(a_keyhole_is_a_hole),
        cmocka_unit_test(a_circle_has_its_area),
        cmocka_unit_test(neighbours_that_share_an_edge_share_no_voxel),
        cmocka_unit_test(a_figure_of_eight_fills_both_loops),
        cmocka_unit_test(planes_stand_for_slabs_whatever_the_slices),
        cmocka_unit_test(a_real_gap_is_not_filled),
        cmocka_unit_test(two_lonely_planes_are_not_joined),
        cmocka_unit_test(slices_half_way_between_planes_are_filled_once),
        cmocka_unit_test(any_orientation_is_filled_as_each_voxel_says),
        cmocka_unit_test(an_oblique_grid_is_filled_as_each_voxel_says),
        cmocka_unit_test(rows_sheared_by_a_tilted_gantry_are_filled_as_each_voxel_says),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(what_cannot_be_filled_is_counted_and_left_out),
        cmocka_unit_test(nothing_to_fill_is_an_empty_mask),
        cmocka_unit_test(what_lies_beyond_the_grid_is_cut_and_counted),
        cmocka_unit_test(a_million_points_are_filled_or_refused_in_time),
        cmocka_unit_test(more_than_the_written_limits_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
