/* Reducing masks: thin parts stay connected, topology is kept. */
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static void put_in(struct mask *mask, bool is_inside(double x, double y, double z))
{
    for (uint32_t k = 0; k < mask->size[2]; k++)
        for (uint32_t j = 0; j < mask->size[1]; j++)
            for (uint32_t i = 0; i < mask->size[0]; i++) {
                struct vec3 p = affine_point(&mask->lps_mm_from_ijk, vec3(i, j, k));
                if (is_inside(p.x, p.y, p.z))
                    mask_put(mask, i, j, k);
            }
}
static bool in_shell(double x, double y, double z) /* shapes thick enough to be connected by faces at voxels of 1 mm */
{
    double r = sqrt(x * x + y * y + z * z);
    return r < 27 && r >= 25.2;
}
static bool in_ring(double x, double y, double z)
{
    double out = hypot(x, y) - 24;
    return out * out + z * z < 2.5;
}
static bool in_ball(double x, double y, double z)
{
    return x * x + y * y + z * z < 29 * 29;
}

static void thin_shapes_keep_their_shape_when_reduced(void **state)
{
    (void)state;
    static const struct {
        bool (*is_inside)(double, double, double);
        long euler; /* Euler number of the surface: 2 for a sphere */
        uint32_t longest;
    } shapes[] = { { in_shell, 4, 7 }, { in_ring, 0, 8 }, { in_ball, 2, 8 } };
    struct affine map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { -31.3, -30.8, -31.6 } };
    struct error err = { 0 };
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct mask *mask = mask_make(64, 63, 65, &map);
        put_in(mask, shapes[s].is_inside);
        assert_int_equal(euler_of_surface(mask), shapes[s].euler);
        for (uint32_t f = 2; f <= shapes[s].longest; f++)
            for (uint32_t along_z = 1; along_z <= f; along_z += f - 1) {
                struct mask *coarse = mask_reduce(mask, (uint32_t[]){ f, f, along_z }, 2, &err);
                assert_int_equal(euler_of_surface(coarse), shapes[s].euler);
                /* no thicker than necessary: about one layer of blocks where the shape is thinner than that; a ball
                 * with a radius of four blocks has its volume up to a share of its border blocks */
                double least = shapes[s].is_inside == in_ball ? 0.93 : 0.9,
                       most = shapes[s].is_inside == in_ball ? 1.07 : 0.9 + f;
                double volume = (double)mask_count(coarse) * f * f * along_z / (double)mask_count(mask);
                if (shapes[s].is_inside != in_ring && !(volume > least && volume < most))
                    fail_msg("shape %zu reduced by %u, %u: %.3f of its volume", s, f, along_z, volume);
                mask_destroy(coarse);
            }
        mask_destroy(mask);
    }
}

static void a_plate_keeps_its_extent_but_for_a_rim_of_one_block(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct mask *mask = mask_make(64, 64, 12, &unit_map);
    /* a quarter of every block it touches */
    for (uint32_t at = 0; at < 48 * 48; at++)
        mask_put(mask, 8 + at % 48, 8 + at / 48, 5);
    struct mask *coarse = mask_reduce(mask, (uint32_t[]){ 4, 4, 4 }, 1, &err);
    for (uint32_t j = 3; j <= 12; j++)
        for (uint32_t i = 3; i <= 12; i++)
            assert_true(mask_has(coarse, i, j, 1));
    assert_true(mask_count(coarse) <= 12 * 12);
    mask_destroy(coarse);
    mask_destroy(mask);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_keeps_its_extent_but_for_a_rim_of_one_block),
        cmocka_unit_test(thin_shapes_keep_their_shape_when_reduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
