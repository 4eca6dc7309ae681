/* The order of translucent regions: exact at every pixel, for any order of regions and triangles, and the same on every
 * back end; or whole regions over each other, if the scene asks for that. */
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const struct vec3 from_front = { 0, -1, 0 }, up = { 0, 0, 1 };
static const struct made_region red_and_blue[] = { { "red", -1, 0xff2020 }, { "blue", -1, 0x2020ff } };
static const double red[3] = { 1, 0x20 / 255.0, 0x20 / 255.0 }, blue[3] = { 0x20 / 255.0, 0x20 / 255.0, 1 };

static void blend(double under[3], const double rgb[3], double alpha)
{
    for (int c = 0; c < 3; c++)
        under[c] = alpha * shots_facing_light(rgb[c], false) + (1 - alpha) * under[c];
}

/* Red is a plate; blue has one plate in front of it, on the left of the picture, and one behind it, on the right. Any
 * order of whole regions is wrong on one side. */
static double woven_label(struct vec3 p)
{
    if (fabs(p.z) > 25 || fabs(p.x) > 30)
        return 0;
    if (p.y > -5 && p.y < 5)
        return 1;
    return (p.x < 0 && p.y > -20 && p.y < -12) || (p.x > 0 && p.y > 12 && p.y < 20) ? 2 : 0;
}

static struct scene woven_scene(const struct plan *plan, enum scene_translucent_order order)
{
    struct scene scene = shots_scene(plan);
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    scene.surface.translucent_order = order;
    shots_style(&scene, "red")->opacity = 0.5;
    shots_style(&scene, "blue")->opacity = 0.7;
    return scene;
}

static void regions_that_cross_blend_in_each_pixels_own_order(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(70);
    struct plan *plan = made_plan(&grid, woven_label, red_and_blue, 2);
    struct image *image =
        shots_plain(plan, woven_scene(plan, SCENE_TRANSLUCENT_ORDER_EXACT), shots_view_from(origin, from_front, up, 4));
    for (int side = 0; side < 2; side++) {
        double expected[3] = { 0x08 / 255.0, 0x09 / 255.0, 0x0b / 255.0 };
        blend(expected, side ? blue : red, side ? 0.7 : 0.5); /* left: red lies behind */
        blend(expected, side ? red : blue, side ? 0.5 : 0.7);
        shots_expect_color(shots_pixel(image, side ? 260 : 140, 150), expected);
    }
    image_destroy(image);
    shots_forget(plan);
}

static void the_scene_can_lay_whole_regions_over_each_other(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(70);
    struct plan *plan = made_plan(&grid, woven_label, red_and_blue, 2);
    for (int top = 0; top < 2; top++) { /* the higher order lies on top, on both sides and although blue is nearer */
        struct scene scene = woven_scene(plan, SCENE_TRANSLUCENT_ORDER_HIERARCHY);
        shots_style(&scene, top ? "blue" : "red")->order = 3;
        struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, 4));
        double expected[3] = { 0x08 / 255.0, 0x09 / 255.0, 0x0b / 255.0 };
        blend(expected, top ? red : blue, top ? 0.5 : 0.7);
        blend(expected, top ? blue : red, top ? 0.7 : 0.5);
        shots_expect_color(shots_pixel(image, 140, 150), expected);
        shots_expect_color(shots_pixel(image, 260, 150), expected);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* ---- two balls that cross, each on a layer of its own ----------------------------------------------------------- */

enum { RADIUS = 20 };
static const struct vec3 middles[2] = { { -8, -3, 2 }, { 8, 3, -2 } };
static double first_ball(struct vec3 p)
{
    return vec3_length(vec3_sub(p, middles[0])) <= RADIUS ? 1 : 0;
}
static double second_ball(struct vec3 p)
{
    return vec3_length(vec3_sub(p, middles[1])) <= RADIUS ? 2 : 0;
}

static struct plan *make_crossing_balls(bool is_swapped)
{
    struct grid grid = made_cube_grid(64);
    struct made_region swapped[2] = { red_and_blue[1], red_and_blue[0] };
    struct plan *plan = made_plan(&grid, first_ball, is_swapped ? swapped : red_and_blue, 2);
    plan->regions.layers[1] = made_volume(&grid, VOXEL_U8, second_ball);
    plan->regions.n_layers = 2;
    struct region *red_one = &plan->regions.regions[is_swapped], *blue_one = &plan->regions.regions[!is_swapped];
    red_one->label = 1;
    blue_one->layer = 1;
    blue_one->label = 2;
    region_set_measure(&plan->regions);
    return plan;
}

static struct image *draw_balls(struct renderer *renderer, struct plan *plan, bool is_still)
{
    struct scene scene = shots_scene(plan);
    shots_style(&scene, "red")->opacity = shots_style(&scene, "blue")->opacity = 0.8;
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, is_still };
    struct renderer *other = shots_renderer;
    shots_renderer = renderer;
    struct image *image = shots_take(plan, scene, shots_view_from(origin, from_front, up, 6), &options, NULL);
    shots_renderer = other;
    return image;
}

/* Distance of a ball's near side from its middle, at an offset across the line of sight; false: the offset misses it.
 */
static bool near_side(int ball, double x, double z, double *y)
{
    double across = (x - middles[ball].x) * (x - middles[ball].x) + (z - middles[ball].z) * (z - middles[ball].z);
    *y = middles[ball].y - sqrt(fmax(0, RADIUS * RADIUS - across));
    return across < (RADIUS - 1) * (RADIUS - 1); /* half a voxel's diagonal from the rim */
}

static void crossing_balls_have_the_nearer_one_on_top_everywhere(void **state)
{
    (void)state;
    struct plan *plan = make_crossing_balls(false);
    struct image *image = draw_balls(shots_renderer, plan, false);
    int n_checked[2] = { 0, 0 };
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double across_mm = (x + 0.5 - SHOTS_WIDTH / 2.0) / 6, up_mm = (SHOTS_HEIGHT / 2.0 - y - 0.5) / 6, y_mm[2];
            bool is_on[2] = { near_side(0, across_mm, up_mm, &y_mm[0]), near_side(1, across_mm, up_mm, &y_mm[1]) };
            if (!is_on[0] || !is_on[1] || fabs(y_mm[0] - y_mm[1]) < 1.5) /* a voxel's steps each */
                continue;
            const uint8_t *pixel = shots_pixel(image, x, y);
            bool is_red_near = y_mm[0] < y_mm[1];
            assert_true(is_red_near ? pixel[0] > pixel[2]
                                    : pixel[2] > pixel[0]); /* at 0.8 the upper colour is the stronger */
            n_checked[is_red_near]++;
        }
    assert_true(n_checked[0] > 1000 && n_checked[1] > 1000);
    image_destroy(image);
    shots_forget(plan);
}

static void shuffle_triangles(struct plan *plan, size_t region)
{
    struct error err = { 0 };
    struct mesh *mesh =
        surface_of(plan, region, SURFACE_MARCHING_CUBES, SURFACE_FULL, NULL, &err); /* the one that is kept */
    uint64_t state = 88172645463325252u + region;
    assert_string_equal(err.text, "");
    for (size_t i = mesh->n_triangles - 1; i > 0;
         i--) { /* R. Durstenfeld, Algorithm 235, CACM 1964; G. Marsaglia, Xorshift RNGs, 2003 */
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        size_t j = state % (i + 1);
        for (size_t c = 0; c < 3; c++) {
            uint32_t swap = mesh->indices[3 * i + c];
            mesh->indices[3 * i + c] = mesh->indices[3 * j + c];
            mesh->indices[3 * j + c] = swap;
        }
    }
    mesh_unref(mesh);
}

static void the_order_of_regions_and_of_triangles_makes_no_difference(void **state)
{
    (void)state;
    for (int is_still = 0; is_still < 2; is_still++) {
        struct plan *plan = make_crossing_balls(false), *swapped = make_crossing_balls(true),
                    *shuffled = make_crossing_balls(false);
        shuffle_triangles(shuffled, 0);
        shuffle_triangles(shuffled, 1);
        struct image *a = draw_balls(shots_renderer, plan, is_still),
                     *b = draw_balls(shots_renderer, swapped, is_still),
                     *c = draw_balls(shots_renderer, shuffled, is_still);
        assert_memory_equal(a->rgba, b->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        assert_memory_equal(a->rgba, c->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(a);
        image_destroy(b);
        image_destroy(c);
        shots_forget(plan);
        shots_forget(swapped);
        shots_forget(shuffled);
    }
}

static void every_back_end_draws_the_same(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct renderer *soft = renderer_create(RENDER_SOFT, &err);
    struct plan *plan = make_crossing_balls(false);
    for (int is_still = 0; is_still < 2; is_still++) {
        struct image *a = draw_balls(shots_renderer, plan, is_still), *b = draw_balls(soft, plan, is_still);
        size_t n = (size_t)SHOTS_WIDTH * SHOTS_HEIGHT, n_far = 0;
        for (size_t i = 0; i < n; i++)
            for (size_t channel = 0; channel < 3; channel++)
                if (abs(a->rgba[4 * i + channel] - b->rgba[4 * i + channel]) > 8) {
                    n_far++;
                    break;
                }
        assert_true(n_far < n / 250); /* back ends round vertices differently, so some pixels at edges and where the
                                         balls cross differ */
        image_destroy(a);
        image_destroy(b);
    }
    renderer_forget(soft, plan);
    renderer_destroy(soft);
    shots_forget(plan);
}

/* ---- many ------------------------------------------------------------------------------------------------------- */

/* More plates than one composition takes, side by side in front of a large one. */
enum { COLUMNS = 12, ROWS = 7, PLATES = COLUMNS * ROWS };
static double plates_label(struct vec3 p)
{
    if (p.y > 20 && p.y < 30)
        return 1;
    int column = (int)floor((p.x + 36) / 6), row = (int)floor((p.z + 21) / 6);
    bool is_gap = fmod(p.x + 36, 6) > 4 || fmod(p.z + 21, 6) > 4;
    return is_gap || column < 0 || column >= COLUMNS || row < 0 || row >= ROWS || p.y > -10 || p.y < -20
               ? 0
               : 2 + row * COLUMNS + column;
}

static void many_regions_are_all_drawn(void **state)
{
    (void)state;
    struct made_region regions[PLATES + 1];
    char ids[PLATES + 1][16];
    for (int i = 0; i <= PLATES; i++) {
        snprintf(ids[i], sizeof ids[i], "r%d", i);
        regions[i] = (struct made_region){ ids[i], -1, i == 0 ? 0x2020ffu : 0xff2020u };
    }
    struct grid grid = made_cube_grid(80);
    struct plan *plan = made_plan(&grid, plates_label, regions, PLATES + 1);
    struct scene scene = shots_scene(plan);
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.opacity = 0.5;
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, 5));
    double expected[3] = { 0x08 / 255.0, 0x09 / 255.0, 0x0b / 255.0 };
    blend(expected, blue, 0.5);
    blend(expected, red, 0.5);
    for (int row = 0; row < ROWS; row++)
        for (int column = 0; column < COLUMNS; column++) {
            const uint8_t *pixel =
                shots_pixel(image, 200 + (int)(5 * (column * 6 - 36 + 2.5)), 150 - (int)(5 * (row * 6 - 21 + 2.5)));
            for (int c = 0; c < 3; c++)
                assert_close(pixel[c], 255 * expected[c],
                             12); /* averaged normals of a plate of 4 x 4 voxels; without it: 60 off */
        }
    image_destroy(image);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regions_that_cross_blend_in_each_pixels_own_order),
        cmocka_unit_test(the_scene_can_lay_whole_regions_over_each_other),
        cmocka_unit_test(crossing_balls_have_the_nearer_one_on_top_everywhere),
        cmocka_unit_test(the_order_of_regions_and_of_triangles_makes_no_difference),
        cmocka_unit_test(every_back_end_draws_the_same),
        cmocka_unit_test(many_regions_are_all_drawn),
    };
    return shots_run("translucent", tests, sizeof tests / sizeof tests[0]);
}
