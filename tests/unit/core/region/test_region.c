/* Regions: ids, measures, and the hierarchy derived from containment. */
#include "core/region/region.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define IS_SANITIZED true
#elif defined __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define IS_SANITIZED true
#endif
#endif
#ifndef IS_SANITIZED
#define IS_SANITIZED false
#endif

static const struct affine map_2mm = { { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 } }, { 0, 0, 0 } };

static void put_label(struct volume *layer, uint32_t i, uint32_t j, uint32_t k, uint16_t label)
{
    size_t at = ((size_t)k * layer->grid.size[1] + j) * layer->grid.size[0] + i;
    if (layer->type == VOXEL_U8)
        ((uint8_t *)layer->voxels)[at] = (uint8_t)label;
    else
        ((uint16_t *)layer->voxels)[at] = label;
}

static void put_box(struct volume *layer, const uint32_t low[3], const uint32_t high[3], uint16_t label)
{
    for (uint32_t k = low[2]; k <= high[2]; k++)
        for (uint32_t j = low[1]; j <= high[1]; j++)
            for (uint32_t i = low[0]; i <= high[0]; i++)
                put_label(layer, i, j, k, label);
}
#define BOX(layer, a, b, label) put_box(layer, (uint32_t[3]){ a, a, a }, (uint32_t[3]){ b, b, b }, label)

/* Makes regions named a, b, c, ..., each with a label of a given layer. */
static struct region_set set_make(struct volume **layers, size_t n_layers, const uint32_t *layer_of,
                                  const uint16_t *label_of, size_t n)
{
    struct region_set set = { .n_layers = n_layers, .n_regions = n };
    set.regions = calloc(n, sizeof *set.regions);
    for (size_t i = 0; i < n_layers; i++)
        set.layers[i] = layers[i];
    for (size_t i = 0; i < n; i++) {
        set.regions[i].parent = -1;
        set.regions[i].layer = layer_of[i];
        set.regions[i].label = label_of[i];
        set.regions[i].id[0] = (char)('a' + i);
    }
    region_set_measure(&set);
    return set;
}

static void ids_are_safe_in_a_url_and_unique(void **state)
{
    (void)state;
    struct region regions[4] = { 0 };
    struct region_set set = { .regions = regions };
    const struct {
        const char *name, *id;
    } names[] = { { "Optic Nerve_-_Rt", "optic-nerve-rt" },
                  { "optic nerve rt", "optic-nerve-rt-2" },
                  { "\xc3\xa4\xc3\xb6 !", "region" },
                  { "", "region-2" } };
    for (size_t i = 0; i < 4; i++) {
        region_make_id(&set, names[i].name, regions[i].id);
        set.n_regions++;
        assert_string_equal(regions[i].id, names[i].id);
    }
    char name[400], id[REGION_ID_SIZE];
    memset(name, 'x', sizeof name - 1);
    name[sizeof name - 1] = 0;
    region_make_id(&set, name, id);
    assert_true(strlen(id) < REGION_ID_SIZE - 4);
}

static void the_palette_has_at_least_twenty_colours(void **state)
{
    (void)state;
    for (size_t a = 0; a < 20; a++)
        for (size_t b = 0; b < a; b++) {
            uint8_t x[3], y[3];
            region_palette(a, x);
            region_palette(b, y);
            assert_true(abs(x[0] - y[0]) + abs(x[1] - y[1]) + abs(x[2] - y[2]) > 30);
        }
    uint8_t any[3];
    region_palette(1000003, any);
}

static void regions_are_measured_in_both_label_types(void **state)
{
    (void)state;
    const enum voxel_type types[2] = { VOXEL_U8, VOXEL_U16 };
    for (int t = 0; t < 2; t++) {
        uint16_t label = t ? 300 : 30;
        struct volume *layer = layer_make(21, 9, 7, types[t], &map_2mm);
        put_box(layer, (uint32_t[3]){ 1, 2, 3 }, (uint32_t[3]){ 18, 4, 6 }, label);
        struct region_set set = set_make(&layer, 1, (uint32_t[]){ 0, 0 }, (uint16_t[]){ label, 77 }, 2);
        const struct region *region = &set.regions[0];
        assert_int_equal(region->n_voxels, 18 * 3 * 4);
        assert_close(region->volume_cm3, 18 * 3 * 4 * 8 / 1000.0, 1e-12);
        assert_close(region->centre_lps_mm.x, 19, 1e-9); /* index 9.5, 2 mm */
        assert_close(region->centre_lps_mm.z, 9, 1e-9);
        assert_true(region->touches_edge); /* k = 6 is the last */
        assert_int_equal(region->low_ijk[1], 2);
        assert_int_equal(region->high_ijk[0], 18);
        assert_int_equal(set.regions[1].n_voxels, 0);
        region_set_finish(&set);
    }
}

static void shells_are_put_into_one_another(void **state)
{
    (void)state;
    struct volume *layer = layer_make(20, 20, 20, VOXEL_U8, &map_2mm);
    BOX(layer, 2, 17, 1);
    BOX(layer, 4, 15, 2);
    BOX(layer, 6, 13, 3);
    BOX(layer, 8, 9, 4);
    /* touches 2 and 3: inside 2 by its outward faces */
    put_box(layer, (uint32_t[3]){ 5, 5, 5 }, (uint32_t[3]){ 5, 6, 6 }, 5);
    struct region_set set = set_make(&layer, 1, (uint32_t[5]){ 0 }, (uint16_t[]){ 4, 3, 2, 1, 5 }, 5);
    region_set_derive_hierarchy(&set);
    assert_int_equal(set.hierarchy, HIERARCHY_DERIVED);
    assert_int_equal(set.regions[0].parent, 1);
    assert_int_equal(set.regions[1].parent, 2);
    assert_int_equal(set.regions[2].parent, 3);
    assert_int_equal(set.regions[3].parent, -1);
    assert_int_equal(set.regions[4].parent, 2);
    assert_int_equal(region_depth(&set, 0), 3);
    size_t inside[5];
    assert_int_equal(region_with_descendants(&set, 2, inside), 4);
    assert_int_equal(inside[0], 2);
    region_set_finish(&set);
}

static void a_brain_cut_by_the_scan_still_lies_in_the_scalp(void **state)
{
    (void)state;
    struct volume *layer = layer_make(20, 20, 20, VOXEL_U8, &map_2mm);
    put_box(layer, (uint32_t[3]){ 2, 2, 0 }, (uint32_t[3]){ 17, 17, 17 }, 1);
    put_box(layer, (uint32_t[3]){ 5, 5, 0 }, (uint32_t[3]){ 14, 14, 14 }, 2);
    struct region_set set = set_make(&layer, 1, (uint32_t[2]){ 0 }, (uint16_t[]){ 1, 2 }, 2);
    region_set_derive_hierarchy(&set);
    assert_int_equal(set.regions[1].parent, 0);
    assert_int_equal(set.regions[0].parent, -1);
    region_set_finish(&set);
}

static void neighbours_and_half_buried_regions_have_no_parent(void **state)
{
    (void)state;
    struct volume *layer = layer_make(20, 20, 20, VOXEL_U8, &map_2mm);
    put_box(layer, (uint32_t[3]){ 2, 2, 2 }, (uint32_t[3]){ 9, 17, 17 }, 1);
    put_box(layer, (uint32_t[3]){ 10, 2, 2 }, (uint32_t[3]){ 17, 17, 17 }, 2);
    put_box(layer, (uint32_t[3]){ 4, 4, 16 }, (uint32_t[3]){ 7, 7, 19 }, 3); /* extends out of it */
    struct region_set set = set_make(&layer, 1, (uint32_t[3]){ 0 }, (uint16_t[]){ 1, 2, 3 }, 3);
    region_set_derive_hierarchy(&set);
    assert_int_equal(set.hierarchy, HIERARCHY_NONE);
    for (int i = 0; i < 3; i++)
        assert_int_equal(set.regions[i].parent, -1);
    region_set_finish(&set);
}

static void a_region_in_a_notch_does_not_lie_inside(void **state)
{
    (void)state;
    struct volume *layer = layer_make(20, 20, 20, VOXEL_U8, &map_2mm);
    BOX(layer, 2, 17, 1);
    put_box(layer, (uint32_t[3]){ 8, 8, 8 }, (uint32_t[3]){ 11, 11, 17 }, 0);
    put_box(layer, (uint32_t[3]){ 8, 8, 8 }, (uint32_t[3]){ 11, 11, 11 }, 2); /* a cube, open on one of its six sides */
    struct region_set set = set_make(&layer, 1, (uint32_t[2]){ 0 }, (uint16_t[]){ 1, 2 }, 2);
    region_set_derive_hierarchy(&set);
    assert_int_equal(set.regions[1].parent, -1);
    region_set_finish(&set);
}

static void regions_on_other_layers_lie_inside_when_their_voxels_do(void **state)
{
    (void)state;
    struct volume *layers[3] = { layer_make(20, 20, 20, VOXEL_U8, &map_2mm), layer_make(20, 20, 20, VOXEL_U8, &map_2mm),
                                 layer_make(12, 12, 12, VOXEL_U8, &map_2mm) };
    BOX(layers[0], 2, 17, 1);
    BOX(layers[1], 4, 15, 1);
    BOX(layers[2], 5, 9, 1);
    BOX(layers[2], 6, 8, 2);
    put_box(layers[0], (uint32_t[3]){ 18, 0, 0 }, (uint32_t[3]){ 19, 0, 0 }, 2); /* elsewhere */
    struct region_set set = set_make(layers, 3, (uint32_t[]){ 0, 1, 2, 2, 0 }, (uint16_t[]){ 1, 1, 1, 2, 2 }, 5);
    region_set_derive_hierarchy(&set);
    assert_int_equal(set.regions[1].parent, 0);
    assert_int_equal(set.regions[2].parent, 1);
    assert_int_equal(set.regions[3].parent, 2);
    assert_int_equal(set.regions[4].parent, -1);
    region_set_finish(&set);
}

static void two_equal_masks_make_no_circle(void **state)
{
    (void)state;
    struct volume *layers[2] = { layer_make(9, 9, 9, VOXEL_U8, &map_2mm), layer_make(9, 9, 9, VOXEL_U8, &map_2mm) };
    BOX(layers[0], 2, 6, 1);
    BOX(layers[1], 2, 6, 1);
    struct region_set set = set_make(layers, 2, (uint32_t[]){ 0, 1 }, (uint16_t[]){ 1, 1 }, 2);
    region_set_derive_hierarchy(&set);
    assert_int_equal(set.regions[0].parent, -1);
    assert_int_equal(set.regions[1].parent, 0);
    region_set_finish(&set);
}

static void a_tree_of_five_labels_in_256_256_128_takes_under_50_ms(void **state)
{
    (void)state;
    struct volume *layer = layer_make(256, 256, 128, VOXEL_U8, &map_2mm);
    for (uint16_t n = 0; n < 5; n++)
        put_box(layer, (uint32_t[3]){ 10u + 20u * n, 10u + 20u * n, 5u + 10u * n },
                (uint32_t[3]){ 245u - 20u * n, 245u - 20u * n, 122u - 10u * n }, (uint16_t)(n + 1));
    struct region_set set = set_make(&layer, 1, (uint32_t[5]){ 0 }, (uint16_t[]){ 1, 2, 3, 4, 5 }, 5);
    double best_s = INFINITY;
    for (int run = 0; run < 5; run++) {
        for (int i = 0; i < 5; i++)
            set.regions[i].parent = -1;
        double started_s = cpu_s();
        region_set_derive_hierarchy(&set);
        best_s = fmin(best_s, cpu_s() - started_s);
    }
    for (int i = 1; i < 5; i++)
        assert_int_equal(set.regions[i].parent, i - 1);
    print_message("tree of five labels: %.1f ms\n", 1000 * best_s);
    if (!IS_SANITIZED)
        assert_true(best_s < 0.05);
    region_set_finish(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ids_are_safe_in_a_url_and_unique),
        cmocka_unit_test(the_palette_has_at_least_twenty_colours),
        cmocka_unit_test(regions_are_measured_in_both_label_types),
        cmocka_unit_test(shells_are_put_into_one_another),
        cmocka_unit_test(a_brain_cut_by_the_scan_still_lies_in_the_scalp),
        cmocka_unit_test(neighbours_and_half_buried_regions_have_no_parent),
        cmocka_unit_test(a_region_in_a_notch_does_not_lie_inside),
        cmocka_unit_test(regions_on_other_layers_lie_inside_when_their_voxels_do),
        cmocka_unit_test(two_equal_masks_make_no_circle),
        cmocka_unit_test(a_tree_of_five_labels_in_256_256_128_takes_under_50_ms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
