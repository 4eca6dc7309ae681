/* The border of a mask, compared with a test of every voxel's six neighbours. */
#include <string.h>

#include "core/region/boundary.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/sera_head.h"

static struct mask *boundary(const struct mask *mask, bool is_open_at_edge, int n_threads)
{
    struct error err = { 0 };
    struct mask *border = mask_boundary(mask, is_open_at_edge, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(border);
    return border;
}

static bool is_inside(const struct mask *mask, int64_t i, int64_t j, int64_t k, bool beyond)
{
    bool is_in = i >= 0 && j >= 0 && k >= 0 && i < mask->size[0] && j < mask->size[1] && k < mask->size[2];
    return is_in ? mask_has(mask, i, j, k) : beyond;
}

static void border_voxels_are_those_with_an_outside_neighbour(void **state)
{
    (void)state;
    static const uint32_t sizes[][3] = { { 1, 1, 1 },  { 1, 5, 4 },  { 63, 7, 4 },
                                         { 64, 7, 1 }, { 65, 1, 6 }, { 129, 6, 5 } };
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (uint32_t percent = 30; percent <= 100; percent += 35)
            for (int open = 0; open < 2; open++) {
                struct mask *mask = random_mask(sizes[s][0], sizes[s][1], sizes[s][2], percent, s, &unit_map);
                struct mask *border = boundary(mask, open, 1);
                for (int64_t k = 0; k < mask->size[2]; k++)
                    for (int64_t j = 0; j < mask->size[1]; j++)
                        for (int64_t i = 0; i < 64 * (int64_t)mask->words; i++) {
                            bool expected = i < mask->size[0] && mask_has(mask, i, j, k);
                            bool is_deep = true;
                            for (int way = 0; expected && way < 6; way++) {
                                int64_t step = way % 2 ? 1 : -1;
                                is_deep = is_deep &&
                                          is_inside(mask, i + (way / 2 == 0 ? step : 0), j + (way / 2 == 1 ? step : 0),
                                                    k + (way / 2 == 2 ? step : 0), open);
                            }
                            const uint64_t *row = border->bits + ((size_t)k * mask->size[1] + (size_t)j) * mask->words;
                            assert_int_equal(row[i / 64] >> i % 64 & 1, expected && !is_deep);
                        }
                mask_destroy(border);
                mask_destroy(mask);
            }
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    struct mask *mask = random_mask(100, 31, 17, 70, 9, &unit_map);
    struct mask *one = boundary(mask, false, 1);
    for (int n = 2; n <= 3; n++) {
        struct mask *more = boundary(mask, false, n);
        assert_memory_equal(one->bits, more->bits, (size_t)31 * 17 * mask->words * sizeof *mask->bits);
        mask_destroy(more);
    }
    mask_destroy(one);
    mask_destroy(mask);
}

/* A block of 6 x 6 x 6 around one of 4 x 4 x 4. With the hierarchy, the border is the shell of the outer block. Alone,
 * the outer block is a shell, and all of it is border. */
static void with_the_hierarchy_a_region_has_no_border_along_what_is_inside_it(void **state)
{
    (void)state;
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[3]){ 10, 10, 10 }, &unit_map, &err));
    struct region_set set = { .n_layers = 1, .n_regions = 2, .hierarchy = HIERARCHY_FILE };
    struct region regions[2] = { { .label = 1, .parent = -1 }, { .label = 2, .parent = 0 } };
    set.regions = regions;
    set.layers[0] = volume_create(&grid, VOXEL_U8, &err);
    for (int k = 2; k < 8; k++)
        for (int j = 2; j < 8; j++)
            for (int i = 2; i < 8; i++) {
                bool is_core = i > 2 && i < 7 && j > 2 && j < 7 && k > 2 && k < 7;
                ((uint8_t *)set.layers[0]->voxels)[(k * 10 + j) * 10 + i] = is_core ? 2 : 1;
            }
    struct mask *with = mask_from_region(&set, 0, 1, &err), *own = mask_from_region_own(&set, 0, 1, &err);
    struct mask *border_with = boundary(with, false, 1), *border_own = boundary(own, false, 1);
    assert_int_equal(mask_count(with), 216);
    assert_int_equal(mask_count(border_with), 216 - 64);
    assert_int_equal(mask_count(own), 216 - 64);
    assert_int_equal(mask_count(border_own), 216 - 64);
    assert_null(mask_from_region_own(&set, 2, 1, &err));
    assert_string_equal(err.text, "region 2: the plan has 2");
    mask_destroy(with);
    mask_destroy(own);
    mask_destroy(border_with);
    mask_destroy(border_own);
    volume_unref(set.layers[0]);
}

/* Sera3d's own six-neighbour counts, with and without its hierarchy, and with the cut of the scan counted as border or
 * not. */
static void counts_equal_the_original_sera3d_on_its_own_head(void **state)
{
    (void)state;
    static const uint64_t expected[2][2][3] = {
        { { 91488, 42307, 4978 }, { 68786, 42307, 4978 } }, { { 134181, 47425, 4978 }, { 112095, 47425, 4978 } }
    }; /* [own][open][region] */
    struct volume *layer = sera_head_read();
    if (!layer)
        skip();
    struct region_set *set = sera_head_regions(layer);
    for (size_t r = 0; r < 3; r++)
        for (int is_own = 0; is_own < 2; is_own++) {
            struct mask *mask = sera_head_mask(set, r, is_own);
            for (int open = 0; open < 2; open++) {
                struct mask *border = boundary(mask, open, 2);
                assert_int_equal(mask_count(border), expected[is_own][open][r]);
                mask_destroy(border);
            }
            mask_destroy(mask);
        }
    sera_head_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(border_voxels_are_those_with_an_outside_neighbour),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(with_the_hierarchy_a_region_has_no_border_along_what_is_inside_it),
        cmocka_unit_test(counts_equal_the_original_sera3d_on_its_own_head),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
