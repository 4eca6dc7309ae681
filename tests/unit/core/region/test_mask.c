/* Masks from labels and regions: against a test of every voxel; packed, swept and reduced. */
#include "core/base/mem.h"
#include "core/region/boundary.h"
#include "core/region/mask.h"
#include "core/region/mask_pack.h"
#include "core/region/mask_sweep.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static struct volume *random_layer(uint32_t nx, uint32_t ny, uint32_t nz, enum voxel_type type, uint32_t n_values,
                                   uint64_t seed)
{
    struct volume *layer = layer_make(nx, ny, nz, type, &unit_map);
    for (size_t at = 0, n = grid_n_voxels(&layer->grid); at < n; at++)
        if (type == VOXEL_U8)
            ((uint8_t *)layer->voxels)[at] = (uint8_t)(next_random(&seed) % n_values);
        else
            ((uint16_t *)layer->voxels)[at] = (uint16_t)(next_random(&seed) % n_values);
    return layer;
}

/* Bit of a row, also beyond its end. */
static bool bit_at(const struct mask *mask, uint32_t i, uint32_t j, uint32_t k)
{
    return mask->bits[((size_t)k * mask->size[1] + j) * mask->words + i / 64] >> i % 64 & 1;
}

static struct mask *from_labels(const struct volume *layer, const uint16_t *labels, size_t n, int n_threads)
{
    struct error err = { 0 };
    struct mask *mask = mask_from_labels(layer, labels, n, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(mask);
    return mask;
}

static void assert_same_bits(const struct mask *a, const struct mask *b)
{
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_memory_equal(a->bits, b->bits, (size_t)a->words * a->size[1] * a->size[2] * sizeof *a->bits);
}

/* Compares every voxel, and checks that no bit is set beyond the end of a row. */
static void assert_holds(const struct mask *mask, const struct volume *layer, const uint16_t *labels, size_t n_labels)
{
    uint64_t count = 0;
    for (uint32_t k = 0; k < mask->size[2]; k++)
        for (uint32_t j = 0; j < mask->size[1]; j++)
            for (uint32_t i = 0; i < 64 * mask->words; i++) {
                bool expected = false;
                for (size_t l = 0; i < mask->size[0] && l < n_labels; l++)
                    expected |= volume_label(layer, i, j, k) == labels[l];
                count += expected;
                if (bit_at(mask, i, j, k) != expected)
                    fail_msg("voxel %u %u %u is %d", i, j, k, !expected);
            }
    assert_int_equal(mask_count(mask), count);
}

static void labels_become_bits_for_any_width_type_and_set(void **state)
{
    (void)state;
    static const uint16_t one[] = { 3 }, some[] = { 200, 7, 8, 9, 7 }, with_zero[] = { 0, 255 };
    uint16_t odd[40]; /* more runs than the vector code handles */
    for (uint16_t i = 0; i < 40; i++)
        odd[i] = (uint16_t)(2 * i + 1);
    const struct {
        const uint16_t *labels;
        size_t n;
    } sets[] = { { one, 1 }, { some, 5 }, { with_zero, 2 }, { odd, 40 } };
    static const uint32_t widths[] = { 1, 31, 32, 33, 63, 64, 65, 100, 129 };
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++)
        for (int wide = 0; wide < 2; wide++) {
            struct volume *layer = random_layer(widths[w], 4, 5, wide ? VOXEL_U16 : VOXEL_U8, 256, 50 + w);
            for (size_t s = 0; s < sizeof sets / sizeof *sets; s++) {
                struct mask *mask = from_labels(layer, sets[s].labels, sets[s].n, 1);
                assert_holds(mask, layer, sets[s].labels, sets[s].n);
                for (int n_threads = 2; n_threads < 4; n_threads++) {
                    struct mask *more = from_labels(layer, sets[s].labels, sets[s].n, n_threads);
                    assert_same_bits(mask, more);
                    mask_destroy(more);
                }
                mask_destroy(mask);
            }
            volume_unref(layer);
        }
}

static void labels_above_255_are_found_in_wide_layers_and_never_in_bytes(void **state)
{
    (void)state;
    const uint16_t labels[] = { 259, 65535, 32767, 32768 };
    struct volume *wide = layer_make(70, 1, 1, VOXEL_U16, &unit_map),
                  *bytes = layer_make(70, 1, 1, VOXEL_U8, &unit_map);
    uint16_t *voxels = wide->voxels;
    memset(bytes->voxels, 3, 70); /* 259 - 256 */
    for (size_t i = 0; i < 4; i++)
        voxels[17 * i + 2] = labels[i];
    voxels[5] = 3;
    voxels[6] = 65534;
    struct mask *found = from_labels(wide, labels, 4, 1), *none = from_labels(bytes, labels, 4, 1);
    assert_holds(found, wide, labels, 4);
    assert_int_equal(mask_count(found), 4);
    assert_int_equal(mask_count(none), 0);
    mask_destroy(found);
    mask_destroy(none);
    volume_unref(wide);
    volume_unref(bytes);
}

static void vector_and_portable_packing_give_the_same_bits(void **state)
{
    (void)state;
    const struct mask_packer *best = mask_packer_best();
    if (best == &mask_packer_portable)
        skip(); /* no AVX2: nothing to compare */
    struct label_test *test = mem_new(sizeof *test);
    uint64_t seed = 9, a[5], b[5];
    uint8_t bytes[300];
    uint16_t words[300], labels[100];
    for (int round = 0; round < 3000; round++) {
        uint32_t n = 1 + next_random(&seed) % 300, n_labels = 1 + next_random(&seed) % (round % 2 ? 6 : 100);
        for (uint32_t i = 0; i < n_labels; i++)
            labels[i] = (uint16_t)(round % 3 ? next_random(&seed) % 256 : next_random(&seed));
        for (uint32_t i = 0; i < n; i++) {
            bytes[i] = (uint8_t)next_random(&seed);
            words[i] = next_random(&seed) % 2 ? labels[next_random(&seed) % n_labels] : (uint16_t)next_random(&seed);
        }
        label_test_init(test, labels, n_labels);
        size_t n_bytes = (n + 63) / 64 * sizeof *a;
        best->pack_u8(test, bytes, n, a);
        mask_packer_portable.pack_u8(test, bytes, n, b);
        assert_memory_equal(a, b, n_bytes);
        best->pack_u16(test, words, n, a);
        mask_packer_portable.pack_u16(test, words, n, b);
        assert_memory_equal(a, b, n_bytes);
    }
    free(test);
}

static void no_labels_and_images_are_refused(void **state)
{
    (void)state;
    struct volume *layer = layer_make(4, 4, 4, VOXEL_U8, &unit_map), *image = layer_make(4, 4, 4, VOXEL_F32, &unit_map);
    struct error err = { 0 };
    assert_null(mask_from_labels(layer, NULL, 0, 1, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_null(mask_from_labels(image, (uint16_t[]){ 1 }, 1, 1, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    volume_unref(layer);
    volume_unref(image);
}

static void a_region_brings_its_descendants_on_the_same_grid(void **state)
{
    (void)state;
    struct affine other = unit_map;
    other.origin.x = 0.5;
    /* regions: 0 head (label 1), 1 brain inside it (2), 2 tumour inside that (3), 3 a neighbour (4); on layer 1, same
     * grid: 4 a vessel in the brain (1); on layer 2, half a voxel shifted: 5 a target in the brain (1) */
    struct region regions[6] = { { .parent = -1, .label = 1 },
                                 { .parent = 0, .label = 2 },
                                 { .parent = 1, .label = 3 },
                                 { .parent = -1, .label = 4 },
                                 { .parent = 1, .layer = 1, .label = 1 },
                                 { .parent = 1, .layer = 2, .label = 1 } };
    struct region_set set = { .n_layers = 3, .regions = regions, .n_regions = 6 };
    set.layers[0] = layer_make(10, 1, 1, VOXEL_U8, &unit_map);
    set.layers[1] = layer_make(10, 1, 1, VOXEL_U16, &unit_map);
    set.layers[2] = layer_make(10, 1, 1, VOXEL_U8, &other);
    memcpy(set.layers[0]->voxels, (uint8_t[]){ 0, 1, 2, 3, 2, 1, 4, 0, 0, 0 }, 10);
    ((uint16_t *)set.layers[1]->voxels)[8] = 1;
    ((uint8_t *)set.layers[2]->voxels)[9] = 1;
    static const uint64_t expected[6] = { 0x13e, 0x11c, 0x08, 0x40, 0x100, 0x200 };
    struct error err = { 0 };
    for (size_t r = 0; r < 6; r++) {
        struct mask *mask = mask_from_region(&set, r, 2, &err);
        assert_non_null(mask);
        assert_int_equal(mask->bits[0], expected[r]);
        mask_destroy(mask);
    }
    assert_null(mask_from_region(&set, 6, 2, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    for (size_t l = 0; l < 3; l++)
        volume_unref(set.layers[l]);
}

static void reducing_keeps_what_is_half_full_and_nothing_that_is_empty(void **state)
{
    (void)state;
    struct volume *layer = random_layer(131, 19, 13, VOXEL_U8, 2, 77); /* divisible by none of the factors */
    const uint16_t label = 1;
    struct mask *mask = from_labels(layer, &label, 1, 2);
    struct error err = { 0 };
    for (uint32_t f = 2; f <= 8; f++) {
        struct mask *one = mask_reduce(mask, (uint32_t[]){ f, f, f }, 1, &err),
                    *three = mask_reduce(mask, (uint32_t[]){ f, f, f }, 3, &err);
        assert_non_null(one);
        assert_same_bits(one, three);
        for (int axis = 0; axis < 3; axis++)
            assert_int_equal(one->size[axis], (mask->size[axis] + f - 1) / f);
        for (uint32_t k = 0; k < one->size[2]; k++)
            for (uint32_t j = 0; j < one->size[1]; j++)
                for (uint32_t i = 0; i < one->size[0]; i++) {
                    uint32_t inside = 0, all = 0;
                    for (uint32_t z = k * f; z < (k + 1) * f && z < 13; z++)
                        for (uint32_t y = j * f; y < (j + 1) * f && y < 19; y++)
                            for (uint32_t x = i * f; x < (i + 1) * f && x < 131; x++, all++)
                                inside += mask_has(mask, x, y, z);
                    if (2 * inside >= all || inside == 0) /* blocks in between are decided by topology */
                        assert_int_equal(mask_has(one, i, j, k), inside > 0);
                }
        mask_destroy(one);
        mask_destroy(three);
    }
    assert_null(mask_reduce(mask, (uint32_t[]){ 2, 0, 2 }, 1, &err));
    assert_null(mask_reduce(mask, (uint32_t[]){ 2, 2, 9 }, 1, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    mask_destroy(mask);
    volume_unref(layer);
}

static void a_reduced_mask_keeps_its_outer_faces(void **state)
{
    (void)state;
    struct affine map = { { { 0, 2, 0 }, { -3, 0, 0 }, { 0, 0, 5 } }, { 10, 20, 30 } };
    struct volume *layer = layer_make(12, 24, 6, VOXEL_U8, &map);
    memset(layer->voxels, 1, 12 * 24 * 6);
    struct error err = { 0 };
    struct mask *mask = from_labels(layer, (uint16_t[]){ 1 }, 1, 1),
                *coarse = mask_reduce(mask, (uint32_t[]){ 3, 3, 3 }, 2, &err);
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 fine = affine_point(&mask->lps_mm_from_ijk, vec3(corner & 1 ? 11.5 : -0.5, corner & 2 ? 23.5 : -0.5,
                                                                     corner & 4 ? 5.5 : -0.5));
        struct vec3 same = affine_point(&coarse->lps_mm_from_ijk, vec3(corner & 1 ? 3.5 : -0.5, corner & 2 ? 7.5 : -0.5,
                                                                       corner & 4 ? 1.5 : -0.5));
        assert_close(vec3_length(vec3_sub(fine, same)), 0, 1e-9);
    }
    mask_destroy(mask);
    mask_destroy(coarse);
    volume_unref(layer);
}

static void a_small_region_does_not_vanish_when_reduced(void **state)
{
    (void)state;
    struct volume *layer = layer_make(40, 40, 40, VOXEL_U8, &unit_map);
    uint8_t *voxels = layer->voxels;
    voxels[0] = 1;
    voxels[(20 * 40 + 20) * 40 + 20] = 1; /* two in one block of 4: indices 20 and 21 */
    voxels[(20 * 40 + 20) * 40 + 21] = 1;
    struct error err = { 0 };
    struct mask *mask = from_labels(layer, (uint16_t[]){ 1 }, 1, 1);
    for (int n_threads = 1; n_threads < 4; n_threads++) {
        struct mask *coarse = mask_reduce(mask, (uint32_t[]){ 4, 4, 4 }, n_threads, &err);
        assert_int_equal(mask_count(coarse), 2); /* one voxel for each piece */
        assert_true(mask_has(coarse, 0, 0, 0));
        assert_true(mask_has(coarse, 5, 5, 5));
        mask_destroy(coarse);
    }
    mask_destroy(mask);
    volume_unref(layer);
}

/* Regions 0 to 8 on four layers: nested ones, two with one label, one without a voxel; layer 2 has another grid, layer
 * 3 fewer labels. */
static void one_sweep_gives_the_masks_that_are_made_one_by_one(void **state)
{
    (void)state;
    enum { N = 9 };
    struct affine other = unit_map;
    other.origin.x = 0.5;
    struct region regions[N] = {
        { .parent = -1, .label = 1 },
        { .parent = 0, .label = 2 },
        { .parent = 1, .label = 3 },
        { .parent = -1, .label = 2 },
        { .parent = 1, .layer = 1, .label = 4 },
        { .parent = 1, .layer = 2, .label = 1 },
        { .parent = 5, .layer = 2, .label = 2 },
        { .parent = -1, .label = 99 },
        { .parent = 4, .layer = 3, .label = 3000 },
    };
    static const uint32_t sizes[][3] = { { 1, 1, 1 },  { 64, 3, 4 },  { 63, 5, 2 },
                                         { 65, 4, 7 }, { 130, 9, 6 }, { 200, 30, 11 } };
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (uint32_t n_values = 2; n_values < 300; n_values *= 6) {
            const uint32_t *size = sizes[s];
            struct region_set set = { .n_layers = 4, .regions = regions, .n_regions = N };
            set.layers[0] = random_layer(size[0], size[1], size[2], VOXEL_U8, n_values < 256 ? n_values : 256, s);
            set.layers[1] = random_layer(size[0], size[1], size[2], VOXEL_U16, n_values, s + 70);
            set.layers[2] = layer_make(size[0], size[1], size[2], VOXEL_U8, &other);
            set.layers[3] = layer_make(size[0], size[1], size[2], VOXEL_U16, &unit_map);
            memset(set.layers[2]->voxels, 2, grid_n_voxels(&set.layers[2]->grid)); /* whole words of one label */
            /* the masks begin with the second slice, */
            memset(set.layers[1]->voxels, 0, (size_t)size[0] * size[1] * sizeof(uint16_t));
            ((uint16_t *)set.layers[3]->voxels)[0] = 3000; /* but with the first slice in a later layer */
            struct mask_wish wishes[2 * N];
            for (size_t w = 0; w < 2 * N; w++)
                wishes[w] = (struct mask_wish){ w % N, w >= N };
            for (int n_threads = 0; n_threads < 4; n_threads++) {
                struct error err = { 0 };
                struct mask *masks[2 * N];
                assert_true(mask_sweep(&set, wishes, 2 * N, n_threads, masks, &err));
                for (size_t w = 0; w < 2 * N; w++) {
                    struct mask *alone =
                        w < N ? mask_from_region(&set, w, 1, &err) : mask_from_region_own(&set, w - N, 1, &err);
                    assert_same_bits(masks[w], alone);
                    assert_memory_equal(&masks[w]->lps_mm_from_ijk, &alone->lps_mm_from_ijk,
                                        sizeof alone->lps_mm_from_ijk);
                    /* no bit lies outside the stated extent */
                    assert_int_equal(mask_count(masks[w]), mask_count(alone));
                    mask_destroy(alone);
                    mask_destroy(masks[w]);
                }
            }
            for (size_t layer = 0; layer < 4; layer++)
                volume_unref(set.layers[layer]);
        }
}

static void a_sweep_refuses_what_masks_refuse(void **state)
{
    (void)state;
    struct region region = { .parent = -1, .label = 1 };
    struct region_set set = { .n_layers = 1, .regions = &region, .n_regions = 1 };
    struct error err = { 0 };
    struct mask *none = NULL;
    set.layers[0] = layer_make(4, 4, 4, VOXEL_F32, &unit_map);
    assert_false(mask_sweep(&set, &(struct mask_wish){ 0, false }, 1, 1, &none, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_false(mask_sweep(&set, &(struct mask_wish){ 1, false }, 1, 1, &none, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_null(none);
    volume_unref(set.layers[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_become_bits_for_any_width_type_and_set),
        cmocka_unit_test(labels_above_255_are_found_in_wide_layers_and_never_in_bytes),
        cmocka_unit_test(vector_and_portable_packing_give_the_same_bits),
        cmocka_unit_test(no_labels_and_images_are_refused),
        cmocka_unit_test(one_sweep_gives_the_masks_that_are_made_one_by_one),
        cmocka_unit_test(a_sweep_refuses_what_masks_refuse),
        cmocka_unit_test(a_region_brings_its_descendants_on_the_same_grid),
        cmocka_unit_test(reducing_keeps_what_is_half_full_and_nothing_that_is_empty),
        cmocka_unit_test(a_reduced_mask_keeps_its_outer_faces),
        cmocka_unit_test(a_small_region_does_not_vanish_when_reduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
