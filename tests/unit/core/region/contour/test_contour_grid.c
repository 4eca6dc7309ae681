/* Choosing grids on which regions keep their volume, and sharing label layers. */
#include "core/region/contour/contour_layer.h"
#include "tests/check.h"
#include "tests/unit/made_contours.h"
#include "tests/unit/made_mask.h"

static struct contour_options options; /* of the last call of choose */

/* Compares with the volume by formula: the area on each plane times the spacing. */
static void assert_holds(const struct contour_set *set, const struct contour_choice *choice, double cm3,
                         double accuracy)
{
    struct contour_facts facts;
    struct error err = { 0 };
    struct mask *mask = contour_fill(set, &choice->grid, &options, &facts, &err);
    if (!mask)
        fail_msg("%s", err.text);
    assert_near(facts.polygon_cm3, cm3, 1e-6);
    assert_near(facts.filled_cm3, cm3, accuracy);
    assert_near(1 + choice->volume_error, facts.filled_cm3 / cm3, 1e-9);
    assert_false(choice->is_short);
    mask_destroy(mask);
}

static void assert_same_grid(const struct grid *a, const struct grid *b)
{
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_memory_equal(&a->lps_mm_from_ijk, &b->lps_mm_from_ijk, sizeof a->lps_mm_from_ijk);
}

static void choose(const struct contour_set *sets, size_t n, const struct grid *image, struct contour_choice *choices)
{
    options = contour_defaults;
    options.spacing_mm = contour_usual_spacing_mm(sets, n, image);
    struct error err = { 0 };
    if (!contour_choose_grids(sets, n, image, &options, choices, &err))
        fail_msg("%s", err.text);
}

static void a_region_the_image_holds_stays_on_the_image(void **state)
{
    (void)state;
    struct grid image = grid_make(128, 128, 40, 1, 1, 3, vec3(-64, -64, -60));
    struct contour_set set = { 0 };
    for (int k = 0; k < 20; k++)
        contours_add_circle(&set, 0.2, 0.1, 30, 64, -30 + 3 * k);
    struct contour_choice choice;
    choose(&set, 1, &image, &choice);
    assert_memory_equal(choice.subdivision, ((uint32_t[3]){ 1, 1, 1 }), sizeof choice.subdivision);
    assert_int_equal(choice.group, 0);
    assert_same_grid(&choice.grid, &image);
    assert_holds(&set, &choice, circle_mm2(30, 64) * 60 / 1000, 0.01);
    contour_set_finish(&set);
}

static void a_region_over_1_cm3_is_within_1_percent_whatever_the_image(void **state)
{
    (void)state;
    static const double slices_mm[] = { 1, 2, 3, 5, 7 }, spacings_mm[] = { 1.25, 2, 2.5, 3, 5 },
                        radii_mm[] = { 7, 9, 14, 33 };
    for (int s = 0; s < 5; s++)
        for (int p = 0; p < 5; p++)
            for (int r = 0; r < 4; r++) {
                double radius = radii_mm[r], spacing = spacings_mm[p];
                struct grid image = grid_make(90, 90, (uint32_t)(140 / slices_mm[s]), 0.97, 0.97, slices_mm[s],
                                              vec3(-43, -43.3, -70.4));
                struct contour_set set = { 0 };
                double cm3 = 0;
                int n_planes = (int)(radius / spacing); /* a ball, at least two planes */
                for (int i = -n_planes; i <= n_planes; i++) {
                    double z = spacing * i, across = sqrt(radius * radius - z * z * 0.98);
                    contours_add_circle(&set, 1.3, -2.2, across, 40, z);
                    cm3 += circle_mm2(across, 40) * spacing / 1000;
                }
                assert_true(cm3 > 1);
                struct contour_choice choice;
                choose(&set, 1, &image, &choice);
                assert_holds(&set, &choice, cm3, 0.01);
                contour_set_finish(&set);
            }
}

static void a_small_region_is_within_5_percent_and_never_vanishes(void **state)
{
    (void)state;
    struct grid image = grid_make(60, 60, 30, 1.17, 1.17, 5, vec3(-35, -35, -75));
    struct contour_set sets[4] = { 0 };
    static const double radii_mm[] = { 0.8, 1.5, 2.5, 4 };
    for (int i = 0; i < 4; i++) { /* between slices */
        contours_add_circle(&sets[i], -30 + 12.3 * i, 3, radii_mm[i], 24, 1.9);
        contours_add_circle(&sets[i], -30 + 12.3 * i, 3, radii_mm[i], 24, 3.4);
    }
    struct contour_choice choices[4];
    choose(sets, 4, &image, choices);
    for (int i = 0; i < 4; i++) {
        assert_holds(&sets[i], &choices[i], circle_mm2(radii_mm[i], 24) * 3 / 1000, 0.05);
        contour_set_finish(&sets[i]);
    }
}

static void voxels_of_a_finer_grid_divide_those_of_the_image(void **state)
{
    (void)state;
    struct affine turn = rotation_of(0.2, 0.3, -0.4);
    struct affine map = { { vec3_scale(turn.columns[0], 1.2), vec3_scale(turn.columns[1], 1.2),
                            vec3_scale(turn.columns[2], 4) },
                          vec3(9, 8, 7) };
    struct grid image;
    assert_true(grid_init(&image, (uint32_t[3]){ 50, 50, 20 }, &map, NULL));
    struct contour_set set = { 0 };
    for (int i = 0; i < 5; i++) /* every 2.5 mm where slices are every 4 mm */
        contours_add_circle(&set, 30, 30, 6, 30, 22 + 2.5 * i);
    struct affine place = turn;
    place.origin = map.origin;
    contours_move(&set, &place);
    struct contour_choice choice;
    choose(&set, 1, &image, &choice);
    assert_int_equal(choice.group, 1);
    assert_true(choice.subdivision[2] > 1);
    /* the outer corners of the fine grid are corners of image voxels */
    const uint32_t *size = choice.grid.size;
    for (int corner = 0; corner < 2; corner++) {
        struct vec3 at = corner ? vec3(size[0] - 0.5, size[1] - 0.5, size[2] - 0.5) : vec3(-0.5, -0.5, -0.5);
        struct vec3 in_image = affine_point(&image.ijk_from_lps_mm, affine_point(&choice.grid.lps_mm_from_ijk, at));
        assert_close(in_image.x + 0.5, round(in_image.x + 0.5), 1e-9);
        assert_close(in_image.y + 0.5, round(in_image.y + 0.5), 1e-9);
        assert_close(in_image.z + 0.5, round(in_image.z + 0.5), 1e-9);
    }
    for (int a = 0; a < 3; a++) {
        struct vec3 whole = vec3_scale(choice.grid.lps_mm_from_ijk.columns[a], choice.subdivision[a]);
        assert_close(vec3_length(vec3_sub(whole, image.lps_mm_from_ijk.columns[a])), 0, 1e-12);
        assert_int_equal(size[a] % choice.subdivision[a], 0);
    }
    assert_holds(&set, &choice, circle_mm2(6, 30) * 12.5 / 1000, 0.01);
    contour_set_finish(&set);
}

static void regions_that_need_the_same_share_a_grid(void **state)
{
    (void)state;
    struct grid image = grid_make(200, 200, 50, 1, 1, 5, vec3(-100, -100, -125));
    struct contour_set sets[4] = { 0 };
    /* 10 mm long with planes every 2.5 mm; slices every 5 mm: two in the middle, or one or three */
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            contours_add_box(&sets[i], -60.5 + 70 * i, -20.5, -30.5 + 70 * i, 9.5, 2.5 * k + 1);
    for (int k = 0; k < 20; k++)
        contours_add_box(&sets[2], -80.5, -80.5, 79.5, 79.5, -50 + 5 * k);
    struct contour_choice choices[4];
    choose(sets, 4, &image, choices);
    assert_int_equal(choices[0].group, 1);
    assert_int_equal(choices[1].group, 1);
    assert_same_grid(&choices[0].grid, &choices[1].grid);
    assert_int_equal(choices[2].group, 0);
    assert_int_equal(choices[3].group, 0); /* nothing in it */
    assert_true(isnan(choices[3].volume_error));
    assert_holds(&sets[0], &choices[0], 30 * 30 * 7.5 / 1000, 0.01);
    assert_holds(&sets[1], &choices[1], 30 * 30 * 7.5 / 1000, 0.01);
    for (int i = 0; i < 3; i++)
        contour_set_finish(&sets[i]);
}

static void contours_that_leave_the_image_keep_their_volume(void **state)
{
    (void)state;
    struct grid image = grid_make(64, 64, 10, 1, 1, 3, vec3(0, 0, 0)); /* slices reach from -1.5 to 28.5 */
    struct contour_set sets[4] = { 0 };
    for (int k = -10; k < 20; k++) {
        contours_add_box(&sets[0], 9.5, 9.5, 39.5, 39.5, 3 * k);  /* beyond both ends */
        contours_add_box(&sets[1], 30.5, 9.5, 90.5, 39.5, 3 * k); /* and to the side */
    }
    for (int k = 0; k < 8; k++) {
        contours_add_box(&sets[2], -20.5, 9.5, 9.5, 39.5, 3 * k); /* to the side alone */
        contours_add_box(&sets[3], 9.5, 9.5, 39.5, 39.5, 3 * k);  /* inside */
    }
    struct contour_choice choices[4];
    choose(sets, 4, &image, choices);
    assert_holds(&sets[0], &choices[0], 30 * 30 * 90 / 1000.0, 1e-9);
    assert_holds(&sets[1], &choices[1], 60 * 30 * 90 / 1000.0, 1e-9);
    assert_holds(&sets[2], &choices[2], 30 * 30 * 24 / 1000.0, 1e-9);
    for (int i = 0; i < 3; i++) {
        assert_true(choices[i].is_beyond);
        assert_true(choices[i].group > 0);
        /* voxels of the image and of the grid coincide where both exist */
        struct vec3 spacing = grid_spacing_mm(&choices[i].grid), origin = choices[i].grid.lps_mm_from_ijk.origin;
        assert_close(spacing.x, 1, 1e-9);
        assert_close(spacing.z, 3, 1e-9);
        assert_close(origin.x - round(origin.x), 0, 1e-9);
        assert_close(origin.z / 3 - round(origin.z / 3), 0, 1e-9);
    }
    assert_false(choices[3].is_beyond);
    assert_same_grid(&choices[3].grid, &image);
    for (int i = 0; i < 4; i++)
        contour_set_finish(&sets[i]);
}

static void planes_beyond_a_lonely_slice_get_slices_of_their_own(void **state)
{
    (void)state;
    static const double tilt[] = { 0, 0.3 }; /* radians */
    for (int t = 0; t < 2; t++) {
        struct affine turn = rotation_of(tilt[t], tilt[t] / 2, 0);
        struct grid image;
        struct affine map = { { turn.columns[0], vec3_scale(turn.columns[1], 2), turn.columns[2] },
                              vec3(0, 0, 0) }; /* 1 mm thick, as assumed */
        assert_true(grid_init(&image, (uint32_t[3]){ 128, 64, 1 }, &map, NULL));
        struct contour_set set = { 0 };
        for (int k = 0; k < 40; k++)
            contours_add_box(&set, 20.5, 21, 60.5, 61, 2.5 * k - 31.2); /* no plane lies on the slice */
        contours_move(&set, &turn);
        struct contour_choice choice;
        choose(&set, 1, &image, &choice);
        assert_true(choice.is_beyond);
        assert_holds(&set, &choice, 40 * 40 * 100 / 1000.0, 0.01);
        assert_close(vec3_length(vec3_sub(choice.grid.lps_mm_from_ijk.columns[2], vec3_scale(turn.columns[2], 2.5))), 0,
                     1e-6);
        struct vec3 at = affine_point(&choice.grid.ijk_from_lps_mm, affine_point(&turn, vec3(20, 22, 2.5 * 7 - 31.2)));
        assert_close(at.x - round(at.x), 0, 1e-6); /* on a voxel of the image's lattice and on a plane */
        assert_close(at.y - round(at.y), 0, 1e-6);
        assert_close(at.z - round(at.z), 0, 1e-6);
        contour_set_finish(&set);
    }
}

static void contours_beyond_the_reach_are_cut_and_large_ones_get_coarse_voxels(void **state)
{
    (void)state;
    struct grid image = grid_make(64, 64, 10, 1, 1, 3, vec3(0, 0, 0));
    struct contour_set sets[2] = { 0 };
    contours_add_box(&sets[0], 9.5, 9.5, 39.5, 39.5, 0);
    contours_add_box(&sets[0], 9.5, 9.5, 39.5, 39.5, 31 + CONTOUR_MAX_REACH_MM);
    for (int k = 0; k < 600; k++)
        contours_add_box(&sets[1], -300, -300, 300, 300, 3 * k); /* 216 Mi voxels of the image */
    struct contour_choice choices[2];
    choose(sets, 2, &image, choices);
    assert_false(choices[0].is_beyond);
    assert_same_grid(&choices[0].grid, &image);
    assert_true(choices[1].is_beyond);
    assert_in_range(grid_n_voxels(&choices[1].grid), 1, contour_defaults.most_voxels);
    assert_holds(&sets[1], &choices[1], 600 * 600 * 1800 / 1000.0, 0.01);
    for (int i = 0; i < 2; i++)
        contour_set_finish(&sets[i]);
}

static void few_voxels_for_many_planes_are_enough_to_end(void **state)
{
    (void)state;
    struct grid image = grid_make(64, 64, 2, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set set = { 0 };
    for (int k = 0; k < 1500; k++)
        contours_add_box(&set, 9.5, 9.5, 39.5, 39.5, k);
    struct contour_choice choice;
    struct error err = { 0 };
    options = contour_defaults;
    options.most_voxels = 20000; /* 13 per plane */
    assert_true(contour_choose_grids(&set, 1, &image, &options, &choice, &err));
    assert_true(choice.is_beyond);
    assert_in_range(grid_n_voxels(&choice.grid), 1, 20000);
    contour_set_finish(&set);
}

static void without_an_image_the_grid_lies_in_the_planes(void **state)
{
    (void)state;
    struct contour_set sets[2] = { 0 };
    for (int k = 0; k < 12; k++)
        contours_add_circle(&sets[0], 12, 30, 25, 50, 2.5 * k - 100.25);
    for (int k = 0; k < 4; k++)
        contours_add_circle(&sets[1], 12, 30, 5, 50, 2.5 * k - 90.25);
    struct affine turn = rotation_of(0.4, 0.1, -0.2);
    contours_move(&sets[0], &turn);
    contours_move(&sets[1], &turn);
    struct contour_choice choices[2];
    choose(sets, 2, NULL, choices);
    struct vec3 along = choices[0].grid.lps_mm_from_ijk.columns[2];
    assert_close(vec3_length(vec3_sub(along, vec3_scale(turn.columns[2], 2.5))), 0, 1e-6);
    struct vec3 at =
        affine_point(&choices[0].grid.ijk_from_lps_mm, affine_point(&turn, vec3(12, 30, 2.5 * 3 - 100.25)));
    assert_close(at.z, round(at.z), 1e-6);
    assert_holds(&sets[0], &choices[0], circle_mm2(25, 50) * 30 / 1000, 0.01);
    assert_holds(&sets[1], &choices[1], circle_mm2(5, 50) * 10 / 1000, 0.05);
    contour_set_finish(&sets[0]);
    contour_set_finish(&sets[1]);
}

static void a_made_grid_stays_within_its_limits(void **state)
{
    (void)state;
    struct contour_set set = { 0 };
    contours_add_box(&set, -9e4, -9e4, 9e4, 9e4, -9e4);
    contours_add_box(&set, -9e4, -9e4, 9e4, 9e4, -9e4 + 0.1);
    contours_add_box(&set, -9e4, -9e4, 9e4, 9e4, 9e4);
    options = contour_defaults;
    options.most_voxels = 1000000;
    struct contour_choice choice;
    struct error err = { 0 };
    if (!contour_choose_grids(&set, 1, NULL, &options, &choice, &err))
        assert_int_equal(err.code, ERROR_RANGE); /* 90 m in 4096 slices: spacings end at 10 m */
    else
        assert_true(grid_n_voxels(&choice.grid) <= options.most_voxels);
    contour_set_finish(&set);

    assert_false(contour_choose_grids(&set, 1, NULL, &options, &choice, &err));
    assert_string_equal(err.text, "no region has a closed contour, and there is no image to take a grid from");
}

static void a_region_too_intricate_does_not_keep_the_others_out(void **state)
{
    (void)state;
    struct grid image = grid_make(512, 512, 10, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set sets[2] = { 0 };
    enum { N = 1000000 };
    double *xy = malloc(2 * N * sizeof *xy);
    assert_non_null(xy);
    for (size_t i = 0; i < N; i++) {
        xy[2 * i] = 500.0 * (double)i / N;
        xy[2 * i + 1] = i % 2 ? 500 : 1;
    }
    contours_add(&sets[0], xy, N, 5);
    free(xy);
    contours_add_box(&sets[1], 10.5, 10.5, 99.5, 99.5, 5);
    struct contour_choice choices[2];
    choose(sets, 2, &image, choices);
    assert_true(choices[0].is_short);
    assert_holds(&sets[1], &choices[1], 89 * 89 / 1000.0, 0.01);
    struct error err = { 0 };
    assert_null(contour_fill(&sets[0], &choices[0].grid, &contour_defaults, NULL, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    contour_set_finish(&sets[0]);
    contour_set_finish(&sets[1]);
}

/* Ten slices are in the slabs: on the image 640 rows cross the edges of a plane, on its continuation 19000. */
static void a_region_too_intricate_beyond_the_image_is_cut_to_it(void **state)
{
    (void)state;
    struct grid image = grid_make(64, 64, 20, 1, 1, 1, vec3(0, 0, 0));
    struct contour_set sets[2] = { 0 };
    enum { N = 10000 };
    double *xy = malloc(2 * N * sizeof *xy);
    assert_non_null(xy);
    for (size_t i = 0; i < N; i++) {
        xy[2 * i] = 60.0 * (double)i / N;
        xy[2 * i + 1] = i % 2 ? 1900 : 1;
    }
    for (int z = 5; z <= 10; z += 5) {
        contours_add(&sets[0], xy, N, z);
        contours_add_box(&sets[1], 10.5, 10.5, 99.5, 99.5, z);
    }
    free(xy);
    struct contour_choice choices[2];
    choose(sets, 2, &image, choices);
    assert_false(choices[0].is_beyond);
    assert_int_equal(choices[0].group, 0);
    assert_same_grid(&choices[0].grid, &image);
    assert_true(fabs(choices[0].volume_error) < INFINITY); /* the choice on the image is kept */
    mask_destroy(contours_fill(&sets[0], &choices[0].grid, NULL));
    assert_true(choices[1].is_beyond);
    assert_holds(&sets[1], &choices[1], 89 * 89 * 10 / 1000.0, 0.01);
    contour_set_finish(&sets[0]);
    contour_set_finish(&sets[1]);
}

static void the_usual_spacing_is_the_one_most_planes_have(void **state)
{
    (void)state;
    struct contour_set sets[4] = { 0 };
    for (int k = 0; k < 20; k++)
        contours_add_box(&sets[0], 0, 0, 9, 9, 3 * k);
    for (int k = 0; k < 12; k++)
        contours_add_box(&sets[1], 0, 0, 9, 9, 5 * k);
    for (int k = 0; k < 11; k++)
        contours_add_box(&sets[2], 0, 0, 9, 9, 5.001 * k);
    contours_add_box(&sets[3], 0, 0, 9, 9, 7);
    struct grid image = grid_make(4, 4, 4, 1, 1, 2.25, vec3(0, 0, 0));
    assert_close(contour_usual_spacing_mm(sets, 2, &image), 3, 1e-9);
    assert_close(contour_usual_spacing_mm(sets, 3, &image), 5, 1e-9);
    assert_close(contour_usual_spacing_mm(sets + 3, 1, &image), 2.25, 1e-9);
    assert_close(contour_usual_spacing_mm(sets + 3, 1, NULL), 1, 1e-9);
    for (int i = 0; i < 4; i++)
        contour_set_finish(&sets[i]);
}

static void masks_share_a_layer_as_long_as_they_share_no_voxel(void **state)
{
    (void)state;
    struct grid grid = grid_make(130, 7, 3, 1, 1, 1, vec3(5, 6, 7));
    struct contour_set a = { 0 }, b = { 0 }, c = { 0 };
    contours_add_box(&a, 7, 7, 134.6, 9.6, 8);   /* i 2..129, j 1..3: crosses two word borders */
    contours_add_box(&b, 5.5, 9.6, 70.5, 12, 8); /* below it */
    contours_add_box(&c, 69.5, 8.5, 70.5, 10.5, 8);
    struct mask *masks[] = { contours_fill(&a, &grid, NULL), contours_fill(&b, &grid, NULL),
                             contours_fill(&c, &grid, NULL) };
    struct error err = { 0 };
    struct volume *layer = mask_layer_create(masks[0], &err);
    assert_non_null(layer);
    assert_int_equal(layer->type, VOXEL_U8);
    assert_same_grid(&layer->grid, &grid);
    assert_true(mask_layer_is_free(masks[1], layer));
    mask_layer_put(masks[1], layer, 2);
    assert_false(mask_layer_is_free(masks[2], layer));
    struct volume *wide = volume_create(&grid, VOXEL_U16, &err);
    assert_non_null(wide);
    assert_true(mask_layer_is_free(masks[2], wide));
    mask_layer_put(masks[2], wide, 700);
    assert_false(mask_layer_is_free(masks[0], wide));
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 7; j++)
            for (uint32_t i = 0; i < 130; i++) {
                assert_int_equal(volume_label(layer, i, j, k),
                                 mask_has(masks[0], i, j, k) + 2 * mask_has(masks[1], i, j, k));
                assert_int_equal(volume_label(wide, i, j, k), 700 * mask_has(masks[2], i, j, k));
            }
    volume_unref(layer);
    volume_unref(wide);
    for (int i = 0; i < 3; i++)
        mask_destroy(masks[i]);
    contour_set_finish(&a);
    contour_set_finish(&b);
    contour_set_finish(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_region_the_image_holds_stays_on_the_image),
        cmocka_unit_test(a_region_over_1_cm3_is_within_1_percent_whatever_the_image),
        cmocka_unit_test(a_small_region_is_within_5_percent_and_never_vanishes),
        cmocka_unit_test(voxels_of_a_finer_grid_divide_those_of_the_image),
        cmocka_unit_test(regions_that_need_the_same_share_a_grid),
        cmocka_unit_test(contours_that_leave_the_image_keep_their_volume),
        cmocka_unit_test(planes_beyond_a_lonely_slice_get_slices_of_their_own),
        cmocka_unit_test(few_voxels_for_many_planes_are_enough_to_end),
        cmocka_unit_test(contours_beyond_the_reach_are_cut_and_large_ones_get_coarse_voxels),
        cmocka_unit_test(without_an_image_the_grid_lies_in_the_planes),
        cmocka_unit_test(a_made_grid_stays_within_its_limits),
        cmocka_unit_test(a_region_too_intricate_does_not_keep_the_others_out),
        cmocka_unit_test(a_region_too_intricate_beyond_the_image_is_cut_to_it),
        cmocka_unit_test(the_usual_spacing_is_the_one_most_planes_have),
        cmocka_unit_test(masks_share_a_layer_as_long_as_they_share_no_voxel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
