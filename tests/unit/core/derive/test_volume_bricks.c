/* The bricks of an image and the leaps between those that are seen, against a search through all voxels; and pictures
 * with and without leaps. */
#include "core/derive/volume_bricks.h"
#include "core/render/soft/volume.h"
#include "core/render/visible/draw_volume.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double no_label(struct vec3 p)
{
    (void)p;
    return 0;
}

/* Blobs on a ground of noise. */
static double blobs(struct vec3 p)
{
    double a = vec3_length(vec3_sub(p, vec3(-9, 4, 3))), b = vec3_length(vec3_sub(p, vec3(8, -6, -5)));
    double hash = fmod(fabs(sin(p.x * 12.9 + p.y * 78.2 + p.z * 37.7)) * 43758.5, 1);
    return 20 + 10 * hash + (a < 5 ? 100 : 0) + (b < 3 ? 60 : 0);
}

static struct plan *make_plan(uint32_t ni, uint32_t nj, uint32_t nk, enum voxel_type type)
{
    const uint32_t size[3] = { ni, nj, nk };
    struct grid grid =
        made_grid(ni, nj, nk, made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, no_label, NULL, 0);
    made_plan_add_image(plan, &grid, type, blobs);
    return plan;
}

static const uint32_t sizes[][3] = { { 33, 29, 31 }, { 32, 28, 36 }, { 1, 17, 5 }, { 9, 1, 1 } };
enum { N_SIZES = sizeof sizes / sizeof sizes[0] };

static void a_brick_has_the_smallest_and_largest_value_that_interpolation_in_it_can_give(void **state)
{
    (void)state;
    for (int test = 0; test < N_SIZES * 4; test++) {
        const uint32_t *size = sizes[test / 4];
        struct plan *plan = make_plan(size[0], size[1], size[2], (enum voxel_type)(test % 4));
        struct volume *volume = plan->images[0].volume;
        volume->slope = test % 2 ? -2 : 0.5; /* a negative slope swaps smallest and largest */
        volume->offset = 7;
        if (volume->type == VOXEL_F32)
            ((float *)volume->voxels)[2] = NAN;
        struct error err = { 0 };
        struct volume_bricks *bricks = volume_bricks_get(derived_of(plan), 0, &err);
        assert_non_null(bricks);
        for (int axis = 0; axis < 3; axis++)
            assert_int_equal(bricks->n[axis], (size[axis] + VOLUME_BRICK - 1) / VOLUME_BRICK);
        size_t at = 0;
        for (uint32_t bk = 0; bk < bricks->n[2]; bk++)
            for (uint32_t bj = 0; bj < bricks->n[1]; bj++)
                for (uint32_t bi = 0; bi < bricks->n[0]; bi++, at++) {
                    double low = INFINITY, high = -INFINITY;
                    for (uint32_t k = VOLUME_BRICK * bk; k <= VOLUME_BRICK * (bk + 1) && k < size[2]; k++)
                        for (uint32_t j = VOLUME_BRICK * bj; j <= VOLUME_BRICK * (bj + 1) && j < size[1]; j++)
                            for (uint32_t i = VOLUME_BRICK * bi; i <= VOLUME_BRICK * (bi + 1) && i < size[0]; i++) {
                                double value = volume_value(volume, i, j, k);
                                low = isfinite(value) ? fmin(low, value) : low;
                                high = isfinite(value) ? fmax(high, value) : high;
                            }
                    assert_close(bricks->low[at], low, 1e-4);
                    assert_close(bricks->high[at], high, 1e-4);
                }
        derive_result_unref(&bricks->base);
        plan_and_derived_destroy(plan);
    }
}

static int distance(int a, int b)
{
    return a < b ? b - a : a - b;
}

static void a_leap_is_the_distance_to_the_nearest_brick_that_is_seen(void **state)
{
    (void)state;
    const struct volume_range ranges[][2] = {
        { { 100, 1000 } }, { { 75, 95 }, { 125, 126 } }, { { -1e9, 1e9 } }, { { 500, 600 } }
    };
    for (int test = 0; test < 4; test++) {
        struct plan *plan = make_plan(49, 45, 41, VOXEL_I16);
        struct error err = { 0 };
        size_t n_ranges = test == 1 ? 2 : 1;
        struct volume_bricks *bricks = volume_bricks_get(derived_of(plan), 0, &err);
        struct volume_leaps *leaps = volume_leaps_get(derived_of(plan), 0, ranges[test], n_ranges, &err);
        assert_non_null(leaps);
        const int n[3] = { (int)leaps->n[0], (int)leaps->n[1], (int)leaps->n[2] };
        const int n_all = n[0] * n[1] * n[2];
        for (int a = 0; a < n_all; a++) {
            int least = 255;
            for (int b = 0; b < n_all; b++) {
                bool is_seen = false;
                for (size_t r = 0; r < n_ranges; r++)
                    is_seen |= (double)bricks->high[b] >= ranges[test][r].low &&
                               (double)bricks->low[b] <= ranges[test][r].high;
                int i = distance(a % n[0], b % n[0]), j = distance(a / n[0] % n[1], b / n[0] % n[1]),
                    k = distance(a / n[0] / n[1], b / n[0] / n[1]);
                int most = i > j ? i : j;
                most = k > most ? k : most;
                least = is_seen && most < least ? most : least;
            }
            assert_int_equal(leaps->leap[a], least);
        }
        derive_result_unref(&bricks->base);
        derive_result_unref(&leaps->base);
        plan_and_derived_destroy(plan);
    }
}

/* Bricks and leaps: less than half of the image, as all of a volume is at most one and a half times the image. */
static void bricks_take_less_than_half_of_an_image(void **state)
{
    (void)state;
    struct plan *plan = make_plan(64, 64, 64, VOXEL_U8);
    struct error err = { 0 };
    struct volume_leaps *leaps = volume_leaps_get(derived_of(plan), 0, &(struct volume_range){ 50, 60 }, 1, &err);
    struct once_cache_usage usage;
    derive_usage(derived_of(plan), &usage);
    assert_in_range(usage.n_bytes, 1, 64 * 64 * 64 / 2 - 1);
    derive_result_unref(&leaps->base);
    plan_and_derived_destroy(plan);
}

enum { WIDTH = 96, HEIGHT = SOFT_BAND_ROWS, STRIDE = WIDTH + SOFT_PADDING };

static void leaps_do_not_change_a_picture(void **state)
{
    (void)state;
    static float depth[STRIDE * HEIGHT];
    static uint32_t color[2][STRIDE * HEIGHT];
    for (int test = 0; test < 12; test++) {
        struct plan *plan = make_plan(49, 45, 41, (enum voxel_type)(test % 4));
        struct error err = { 0 };
        char field[128];
        struct scene scene;
        struct view view = view_default;
        scene_for_plan(plan, &scene);
        scene.image.volume.visible = true;
        scene.image.volume.method = (enum scene_volume_method)(test / 4); /* ray, slices, mip */
        scene.image.volume.cull_below = test / 4 > 0 ? 70 : -1e12;
        const struct scene_transfer_point points[] = {
            { 40, 0xff4020, 0 }, { 90, 0x40ff20, 0.3 }, { 110, 0x2040ff, 0 }, { 140, 0xffffff, 0.9 }
        };
        free(scene.image.volume.points);
        scene.image.volume.points = mem_new(sizeof points);
        memcpy(scene.image.volume.points, points, sizeof points);
        scene.image.volume.n_points = 4;
        view.size_px[0] = WIDTH;
        view.size_px[1] = HEIGHT;
        view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_up = true;
        view.camera.position_mm = vec3(30 - 7 * test, -70, 25);
        view.camera.target_mm = vec3(0, 0, 0);
        view.camera.up = vec3(0, 0, 1);
        view.camera.fov_deg = 20;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        assert_non_null(snapshot);
        struct camera camera;
        camera_resolve(snapshot, &camera);
        struct draw_scope scope = { .snapshot = snapshot, .camera = &camera };
        struct draw_list list = { .samples = 1 };
        assert_true(draw_volume(&list, &scope, &err));
        struct soft_volume volume;
        assert_true(soft_volume_init(&volume, &list.draws[0], &scope, WIDTH, HEIGHT, 1, &err));
        size_t n_drawn = 0;
        for (int is_without = 0; is_without < 2; is_without++) {
            const struct soft_band band = { 0, HEIGHT, WIDTH, STRIDE, depth, color[is_without] };
            for (size_t i = 0; i < STRIDE * HEIGHT; i++) {
                depth[i] = 1;
                color[is_without][i] = 0xff000000u;
            }
            volume.leap = is_without ? NULL : volume.leap;
            soft_volume_kernels_of(soft_kernels_best())->compose(&volume, &band, NULL, 0, 0);
        }
        assert_memory_equal(color[0], color[1], sizeof color[0]);
        for (size_t i = 0; i < STRIDE * HEIGHT; i++)
            n_drawn += color[0][i] != 0xff000000u;
        assert_true(n_drawn > 100);
        soft_volume_finish(&volume);
        free(list.draws);
        free(list.transfer);
        snapshot_unref(snapshot);
        plan_and_derived_destroy(plan);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_brick_has_the_smallest_and_largest_value_that_interpolation_in_it_can_give),
        cmocka_unit_test(a_leap_is_the_distance_to_the_nearest_brick_that_is_seen),
        cmocka_unit_test(bricks_take_less_than_half_of_an_image),
        cmocka_unit_test(leaps_do_not_change_a_picture),
    };
    return cmocka_run_group_tests_name("volume_bricks", tests, NULL, NULL);
}
