/* Slice panes of a plan without an image: at each point the colour of the innermost visible region, on whatever label
 * layers the regions are. */
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };

/* Cubes around the origin with half sides 18, 14, 10 and 6 mm, each inside the one before. */
enum { BODY, PTV, CTV, SEED, N_CUBES };
static const double halves_mm[N_CUBES] = { 18, 14, 10, 6 };
static const struct made_region cubes[N_CUBES] = {
    { "body", -1, 0xc08060 }, { "ptv", BODY, 0x4060ff }, { "ctv", PTV, 0x20ff20 }, { "seed", CTV, 0xff2020 }
};
static uint32_t layer_of[N_CUBES];

static bool is_in(struct vec3 p, int cube)
{
    return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) < halves_mm[cube];
}

/* The label of the innermost cube of a layer that holds the point. */
static double label_on(uint32_t layer, struct vec3 p)
{
    for (int cube = N_CUBES - 1; cube >= 0; cube--)
        if (layer_of[cube] == layer && is_in(p, cube))
            return cube + 1;
    return 0;
}
static double first_layer(struct vec3 p)
{
    return label_on(0, p);
}
static double second_layer(struct vec3 p)
{
    return label_on(1, p);
}

static struct plan *cubes_plan(void)
{
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, first_layer, cubes, N_CUBES);
    plan->regions.layers[plan->regions.n_layers++] = made_volume(&grid, VOXEL_U8, second_layer);
    for (int cube = 0; cube < N_CUBES; cube++)
        plan->regions.regions[cube].layer = layer_of[cube];
    region_set_measure(&plan->regions);
    return plan;
}

/* At the middle of the ring between each cube and the next: the colour of the wanted cube, or -1: the background. */
static void expect_rings(struct plan *plan, struct scene scene, const int wanted[N_CUBES])
{
    scene.outline.on_slices = false;
    scene.image.slices.axial.position_mm = 0.5;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 5));
    for (int cube = 0; cube < N_CUBES; cube++) {
        double inner_mm = cube + 1 < N_CUBES ? halves_mm[cube + 1] : 0;
        int x = SHOTS_WIDTH / 2 + (int)((halves_mm[cube] + inner_mm) / 2 * 5);
        uint32_t rgb = wanted[cube] >= 0 ? cubes[wanted[cube]].rgb : 0x08090b;
        const uint8_t expected[3] = { (uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb };
        assert_memory_equal(shots_pixel(image, x, SHOTS_HEIGHT / 2 + 3), expected, 3);
    }
    image_destroy(image);
}

/* All 16 ways of spreading the cubes over two layers, and all 16 of hiding some. */
static void a_point_has_the_colour_of_the_innermost_visible_region_on_any_layers(void **state)
{
    (void)state;
    for (unsigned spread = 0; spread < 16; spread++) {
        for (int cube = 0; cube < N_CUBES; cube++)
            layer_of[cube] = spread >> cube & 1;
        struct plan *plan = cubes_plan();
        for (unsigned hidden = 0; hidden < 16; hidden++) {
            struct scene scene = shots_scene(plan);
            int wanted[N_CUBES];
            for (int cube = 0; cube < N_CUBES; cube++) {
                bool is_hidden = hidden >> cube & 1;
                if (is_hidden)
                    shots_style(&scene, cubes[cube].id)->visible = false;
                wanted[cube] = !is_hidden ? cube : cube > 0 ? wanted[cube - 1] : -1;
            }
            expect_rings(plan, scene, wanted);
        }
        shots_forget(plan);
    }
}

static void a_region_of_higher_order_lies_over_inner_ones(void **state)
{
    (void)state;
    for (unsigned spread = 0; spread < 16; spread++) {
        for (int cube = 0; cube < N_CUBES; cube++)
            layer_of[cube] = spread >> cube & 1;
        struct plan *plan = cubes_plan();
        struct scene scene = shots_scene(plan);
        shots_style(&scene, "ptv")->order = 1;
        expect_rings(plan, scene, (const int[]){ BODY, PTV, PTV, PTV });
        shots_forget(plan);
    }
}

/* Without a hierarchy the smaller region is the inner one. */
static void of_regions_that_only_overlap_the_smaller_is_on_top(void **state)
{
    (void)state;
    for (int cube = 0; cube < N_CUBES; cube++)
        layer_of[cube] = cube == PTV || cube == SEED;
    struct plan *plan = cubes_plan();
    for (int cube = 0; cube < N_CUBES; cube++)
        plan->regions.regions[cube].parent = -1;
    expect_rings(plan, shots_scene(plan), (const int[]){ BODY, PTV, CTV, SEED });
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_has_the_colour_of_the_innermost_visible_region_on_any_layers),
        cmocka_unit_test(a_region_of_higher_order_lies_over_inner_ones),
        cmocka_unit_test(of_regions_that_only_overlap_the_smaller_is_on_top),
    };
    return shots_run("fills", tests, sizeof tests / sizeof tests[0]);
}
