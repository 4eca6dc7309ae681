/* Colour maps and blended images: colours by hand on slice panes and slices in space. */
#include "core/render/visible/color_map.h"
#include "tests/render/shots.h"

enum { PIXELS_PER_MM = 5 };
static const struct vec3 origin = { 0, 0, 0 };

/* Voxels of 1 mm; a column along L for each level in turn. */
static const int levels[] = { 0, 1, 30, 64, 100, 127, 128, 160, 191, 192, 200, 254, 255 };
enum { N_LEVELS = sizeof levels / sizeof levels[0] };

static double level_of_column(struct vec3 p)
{
    int column = (int)floor(p.x + N_LEVELS / 2.0);
    return column >= 0 && column < N_LEVELS ? levels[column] : 0;
}

static struct grid columns_grid(void)
{
    const uint32_t size[3] = { N_LEVELS, 9, 9 };
    return made_grid(size[0], size[1], size[2], made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, origin));
}

static struct plan *image_plan(const struct grid *grid, enum voxel_type type, double (*value)(struct vec3))
{
    struct plan *plan = plan_create("made");
    plan->bounds_lps_mm = grid_bounds_lps_mm(grid);
    made_plan_add_image(plan, grid, type, value);
    return plan;
}

/* Grey level = value, nearest voxel. */
static struct scene byte_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    scene.image.window.center = 127.5;
    scene.image.window.width = 255;
    scene.image.interpolation = SCENE_INTERPOLATION_NEAREST;
    scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    return scene;
}

static const uint8_t *pixel_at(const struct image *image, double right_mm, double up_mm)
{
    return shots_pixel(image, (int)floor(SHOTS_WIDTH / 2.0 + right_mm * PIXELS_PER_MM),
                       (int)floor(SHOTS_HEIGHT / 2.0 - up_mm * PIXELS_PER_MM));
}

/* Darker than the background is drawn as the background. Mixing rounds, and so does storing. */
static void expect_rgb(const uint8_t *pixel, double r, double g, double b, double tolerance)
{
    const double expected[3] = { r, g, b };
    for (int c = 0; c < 3; c++)
        assert_close(pixel[c], fmax(expected[c], shots_background[c]), tolerance);
    assert_int_equal(pixel[3], 255);
}

/* DICOM PS3.6 B.1.1.2, entries of the three tables at the levels. */
static const uint8_t hot_iron[N_LEVELS][3] = { { 0, 0, 0 },      { 2, 0, 0 },     { 60, 0, 0 },     { 128, 0, 0 },
                                               { 200, 0, 0 },    { 254, 0, 0 },   { 255, 0, 0 },    { 255, 64, 0 },
                                               { 255, 126, 0 },  { 255, 128, 0 }, { 255, 144, 32 }, { 255, 252, 248 },
                                               { 255, 255, 255 } };
/* Blue 0, cyan 63.75, green 127.5, yellow 191.25, red 255. */
static const uint8_t rainbow[N_LEVELS][3] = { { 0, 0, 255 },   { 0, 4, 255 },   { 0, 120, 255 }, { 0, 255, 254 },
                                              { 0, 255, 110 }, { 0, 255, 2 },   { 2, 255, 0 },   { 130, 255, 0 },
                                              { 254, 255, 0 }, { 255, 252, 0 }, { 255, 220, 0 }, { 255, 4, 0 },
                                              { 255, 0, 0 } };

static void levels_have_the_colours_of_the_map(void **state)
{
    (void)state;
    struct grid grid = columns_grid();
    struct plan *plan = image_plan(&grid, VOXEL_U8, level_of_column);
    for (int map = SCENE_COLOR_MAP_GREY; map <= SCENE_COLOR_MAP_RAINBOW; map++)
        for (int is_space = 0; is_space < 2; is_space++) {
            struct scene scene = byte_scene(plan);
            scene.image.color_map = (enum scene_color_map)map;
            scene.image.slices.coronal.visible = is_space;
            struct image *image =
                shots_plain(plan, scene,
                            is_space ? shots_view_from(origin, vec3(0, -1, 0), vec3(0, 0, 1), PIXELS_PER_MM)
                                     : shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
            for (int i = 0; i < N_LEVELS; i++) {
                const uint8_t *c = map == SCENE_COLOR_MAP_HOT_IRON ? hot_iron[i] : rainbow[i], *pixel;
                pixel = pixel_at(image, i - (N_LEVELS - 1) / 2.0, 1.3);
                if (map == SCENE_COLOR_MAP_GREY)
                    expect_rgb(pixel, levels[i], levels[i], levels[i], 0.5);
                else
                    expect_rgb(pixel, c[0], c[1], c[2], 0.5);
            }
            assert_memory_equal(pixel_at(image, 20, 0), shots_background, 3);
            image_destroy(image);
        }
    shots_forget(plan);
}

/* Entries 0, 128 and 255 of the published tables: of viridis, magma, inferno and plasma as D3 has them too, of turbo
 * and cividis those of their authors. */
static void levels_have_the_colours_of_the_published_tables(void **state)
{
    (void)state;
    static const struct {
        enum scene_color_map map;
        uint8_t low[3], middle[3], high[3];
    } published[] = { { SCENE_COLOR_MAP_VIRIDIS, { 68, 1, 84 }, { 33, 145, 140 }, { 253, 231, 37 } },
                      { SCENE_COLOR_MAP_MAGMA, { 0, 0, 4 }, { 183, 55, 121 }, { 252, 253, 191 } },
                      { SCENE_COLOR_MAP_INFERNO, { 0, 0, 4 }, { 188, 55, 84 }, { 252, 255, 164 } },
                      { SCENE_COLOR_MAP_PLASMA, { 13, 8, 135 }, { 204, 71, 120 }, { 240, 249, 33 } },
                      { SCENE_COLOR_MAP_CIVIDIS, { 0, 34, 78 }, { 125, 124, 120 }, { 254, 232, 56 } },
                      { SCENE_COLOR_MAP_TURBO, { 48, 18, 59 }, { 164, 252, 60 }, { 122, 4, 3 } } };
    struct grid grid = columns_grid();
    struct plan *plan = image_plan(&grid, VOXEL_U8, level_of_column);
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        struct scene scene = byte_scene(plan);
        scene.image.color_map = published[i].map;
        struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
        const uint8_t *low = published[i].low, *middle = published[i].middle, *high = published[i].high;
        expect_rgb(pixel_at(image, -6, 0), low[0], low[1], low[2], 1);
        expect_rgb(pixel_at(image, 0, 0), middle[0], middle[1], middle[2], 1); /* of value 128 */
        expect_rgb(pixel_at(image, 6, 0), high[0], high[1], high[2], 1);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* Where low values are white the map begins at the high ones. */
static void a_colour_map_follows_what_low_values_are(void **state)
{
    (void)state;
    struct grid grid = columns_grid();
    struct plan *plan = image_plan(&grid, VOXEL_U8, level_of_column);
    struct scene scene = byte_scene(plan);
    scene.image.color_map = SCENE_COLOR_MAP_HOT_IRON;
    scene.image.low_values = SCENE_LOW_VALUES_WHITE;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
    expect_rgb(pixel_at(image, -6, 0), 255, 255, 255, 0.5); /* of value 0 */
    expect_rgb(pixel_at(image, 6, 0), 0, 0, 0, 0.5);        /* of value 255 */
    expect_rgb(pixel_at(image, -1, 0), 255, 0, 0, 0.5);     /* of value 127: level 128 */
    image_destroy(image);
    shots_forget(plan);
}

static double hundred(struct vec3 p)
{
    return 100 + 0 * p.x;
}

static double hundred_below_the_middle(struct vec3 p)
{
    return p.z < 0 ? 100 : 10;
}

/* 20 everywhere, but nothing where L is beyond 4 mm. */
static double twenty_with_a_gap(struct vec3 p)
{
    return p.x > 4 ? (double)NAN : 20;
}

/* The colour at the column of a level, in a picture of the image `columns`. */
static const uint8_t *pixel_of_column(const struct image *image, int i)
{
    return pixel_at(image, i - (N_LEVELS - 1) / 2.0, 0);
}

/* 255 (v / 255)^(1 / gamma), on slices and in space. The table of tones has 4096 entries: a step of the steepest part
 * that is tested, 1 of 255 at a gamma of 2.2, is 2 of 255. */
static void gamma_raises_greys_to_its_power(void **state)
{
    (void)state;
    static const double gammas[] = { 0.5, 1.4, 2.2 };
    struct grid grid = columns_grid();
    struct plan *plan = image_plan(&grid, VOXEL_U8, level_of_column);
    for (size_t g = 0; g < sizeof gammas / sizeof gammas[0]; g++)
        for (int is_space = 0; is_space < 2; is_space++) {
            struct scene scene = byte_scene(plan);
            scene.image.window.gamma = gammas[g];
            scene.image.slices.coronal.visible = is_space;
            struct image *image =
                shots_plain(plan, scene,
                            is_space ? shots_view_from(origin, vec3(0, -1, 0), vec3(0, 0, 1), PIXELS_PER_MM)
                                     : shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
            for (int i = 0; i < N_LEVELS; i++) {
                double grey = 255 * pow(levels[i] / 255.0, 1 / gammas[g]);
                expect_rgb(pixel_of_column(image, i), grey, grey, grey, 2);
            }
            image_destroy(image);
        }
    shots_forget(plan);
}

static void gamma_comes_before_colours_and_after_what_low_values_are(void **state)
{
    (void)state;
    struct grid grid = columns_grid();
    struct plan *plan = image_plan(&grid, VOXEL_U8, level_of_column);
    struct scene scene = byte_scene(plan);
    scene.image.window.gamma = 2;
    scene.image.color_map = SCENE_COLOR_MAP_HOT_IRON;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
    /* value 64: level 255 sqrt(64 / 255) = 127.7, so red 255, no green */
    expect_rgb(pixel_of_column(image, 3), 255, 0, 0, 1.5);
    /* value 191: level 220.7, so green 2 (220.7 - 128) = 185.4, blue 4 (220.7 - 192) = 114.8 */
    expect_rgb(pixel_of_column(image, 8), 255, 185.4, 114.8, 3);
    image_destroy(image);
    scene = byte_scene(plan);
    scene.image.window.gamma = 2;
    scene.image.low_values = SCENE_LOW_VALUES_WHITE;
    image = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
    /* value 191: 64 of 255 when low is white, and gamma makes it brighter: 127.7 */
    expect_rgb(pixel_of_column(image, 8), 127.7, 127.7, 127.7, 1.5);
    expect_rgb(pixel_of_column(image, 0), 255, 255, 255, 0.5);
    image_destroy(image);
    shots_forget(plan);
}

/* A second image of 10 x 10 x 10 mm, its grid turned by 45 degrees about P: on a coronal pane a square on its corner,
 * which reaches 7.07 mm in each direction. */
static struct plan *blend_plan(double (*first)(struct vec3), double (*second)(struct vec3))
{
    double d = sqrt(0.5);
    const uint32_t size[3] = { 20, 20, 20 };
    struct grid grid = made_cube_grid(40), turned = made_grid(20, 20, 20,
                                                              made_affine(vec3(0.5 * d, 0, 0.5 * d), vec3(0, 0.5, 0),
                                                                          vec3(-0.5 * d, 0, 0.5 * d), size, origin));
    struct plan *plan = image_plan(&grid, VOXEL_I16, first);
    made_plan_add_image(plan, &turned, VOXEL_F32, second);
    return plan;
}

/* The second image in hot iron, its value 20 at level 200, so (255, 144, 32). */
static struct scene blend_scene(const struct plan *plan, double opacity)
{
    struct scene scene = byte_scene(plan);
    (void)snprintf(scene.image.blend.id, sizeof scene.image.blend.id, "image-2");
    scene.image.blend.opacity = opacity;
    scene.image.looks = mem_new(sizeof *scene.image.looks);
    scene.image.n_looks = 1;
    scene.image.looks[0] = (struct scene_image_look_entry){ .id = "image-2", .value = scene_image_look_default };
    scene.image.looks[0].value.window.center = 12.75;
    scene.image.looks[0].value.window.width = 25.5;
    scene.image.looks[0].value.color_map = SCENE_COLOR_MAP_HOT_IRON;
    return scene;
}

static void a_second_image_is_mixed_in_where_it_has_a_value(void **state)
{
    (void)state;
    struct plan *plan = blend_plan(hundred, twenty_with_a_gap);
    for (int linear = 0; linear < 2; linear++)
        for (int is_space = 0; is_space < 2; is_space++) {
            struct scene scene = blend_scene(plan, 0.25);
            scene.image.interpolation = linear ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
            scene.image.slices.coronal.visible = is_space;
            struct image *image =
                shots_plain(plan, scene,
                            is_space ? shots_view_from(origin, vec3(0, -1, 0), vec3(0, 0, 1), PIXELS_PER_MM)
                                     : shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
            expect_rgb(pixel_at(image, 0, 0), 138.75, 111, 83, 1);    /* 0.75 x 100 + 0.25 x (255, 144, 32) */
            expect_rgb(pixel_at(image, -6.7, 0), 138.75, 111, 83, 1); /* near the corner of the turned grid */
            expect_rgb(pixel_at(image, 0, 6.7), 138.75, 111, 83, 1);
            expect_rgb(pixel_at(image, -4.5, 4.5), 100, 100, 100, 1); /* beside its edge: 4.5 + 4.5 > 7.07 */
            expect_rgb(pixel_at(image, -7.5, 0), 100, 100, 100, 1);
            expect_rgb(pixel_at(image, 5.5, 0), 100, 100, 100, 1); /* in the gap */
            expect_rgb(pixel_at(image, -15, -15), 100, 100, 100, 1);
            assert_memory_equal(pixel_at(image, 25, 0), shots_background, 3);
            image_destroy(image);
        }
    shots_forget(plan);
}

/* At opacity 1 nothing of the first is left, at 0 nothing of the second; the first still decides where there is a
 * slice. */
static void opacity_goes_from_one_image_to_the_other(void **state)
{
    (void)state;
    static const double expected[3][3] = { { 100, 100, 100 }, { 177.5, 122, 66 }, { 255, 144, 32 } };
    struct plan *plan = blend_plan(hundred, twenty_with_a_gap);
    for (int i = 0; i < 3; i++) {
        struct image *image =
            shots_plain(plan, blend_scene(plan, i / 2.0), shots_view(SCENE_KIND_AXIAL, origin, PIXELS_PER_MM));
        expect_rgb(pixel_at(image, -2, 1), expected[i][0], expected[i][1], expected[i][2], 1);
        expect_rgb(pixel_at(image, -15, 1), 100, 100, 100, 1);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* The first image's 100 with gamma 2 is 255 sqrt(100 / 255) = 159.7; the second one's level 200 with gamma 0.5 is
 * 255 (200 / 255)^2 = 156.9: hot iron (255, 57.7, 0). */
static void each_of_two_images_has_its_own_gamma(void **state)
{
    (void)state;
    struct plan *plan = blend_plan(hundred, twenty_with_a_gap);
    for (int is_second = 0; is_second < 2; is_second++) {
        struct scene scene = blend_scene(plan, is_second);
        scene.image.window.gamma = 2;
        scene.image.looks[0].value.window.gamma = 0.5;
        struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, PIXELS_PER_MM));
        if (is_second)
            expect_rgb(pixel_at(image, -2, 1), 255, 57.7, 0, 2);
        else
            expect_rgb(pixel_at(image, -2, 1), 159.7, 159.7, 159.7, 1);
        expect_rgb(pixel_at(image, -15, 1), 159.7, 159.7, 159.7, 1);
        image_destroy(image);
    }
    shots_forget(plan);
}

static void without_a_look_the_second_image_has_its_own_first_window_in_grey(void **state)
{
    (void)state;
    struct plan *plan = blend_plan(hundred, twenty_with_a_gap);
    plan->images[1].window_center = 30; /* 20 of 5 .. 55 is level 76.5 */
    plan->images[1].window_width = 50;
    struct scene scene = blend_scene(plan, 1);
    free(scene.image.looks);
    scene.image.looks = NULL;
    scene.image.n_looks = 0;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, PIXELS_PER_MM));
    expect_rgb(pixel_at(image, -2, 1), 76.5, 76.5, 76.5, 1);
    image_destroy(image);
    plan->images[1].is_inverted = true;
    scene = byte_scene(plan);
    (void)snprintf(scene.image.blend.id, sizeof scene.image.blend.id, "image-2");
    scene.image.blend.opacity = 1;
    image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, PIXELS_PER_MM));
    expect_rgb(pixel_at(image, -2, 1), 178.5, 178.5, 178.5, 1);
    image_destroy(image);
    shots_forget(plan);
}

/* In space air is left out by the first image's value, whatever the second has there; a pane shows it. */
static void slices_in_space_are_culled_by_the_first_image(void **state)
{
    (void)state;
    struct plan *plan = blend_plan(hundred_below_the_middle, twenty_with_a_gap);
    struct scene scene = blend_scene(plan, 0.5);
    scene.image.slices.coronal.visible = true;
    scene.image.cull_below = 50;
    struct image *image =
        shots_plain(plan, scene, shots_view_from(origin, vec3(0, -1, 0), vec3(0, 0, 1), PIXELS_PER_MM));
    expect_rgb(pixel_at(image, -1, -3), 177.5, 122, 66, 1);
    assert_memory_equal(pixel_at(image, -1, 3), shots_background, 3);
    image_destroy(image);
    scene = blend_scene(plan, 0.5);
    scene.image.cull_below = 50;
    image = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
    expect_rgb(pixel_at(image, -1, 3), 132.5, 77, 21, 1);
    image_destroy(image);
    shots_forget(plan);
}

/* Grey over the same grey. */
static void an_image_over_itself_is_the_image(void **state)
{
    (void)state;
    struct grid grid = columns_grid();
    struct plan *plan = image_plan(&grid, VOXEL_U8, level_of_column);
    plan->images[0].window_center = 127.5;
    plan->images[0].window_width = 255;
    struct scene scene = byte_scene(plan);
    (void)snprintf(scene.image.blend.id, sizeof scene.image.blend.id, "image-1");
    struct image *mixed = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM)),
                 *plain = shots_plain(plan, byte_scene(plan), shots_view(SCENE_KIND_CORONAL, origin, PIXELS_PER_MM));
    assert_memory_equal(mixed->rgba, plain->rgba, SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    image_destroy(mixed);
    image_destroy(plain);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_have_the_colours_of_the_map),
        cmocka_unit_test(levels_have_the_colours_of_the_published_tables),
        cmocka_unit_test(gamma_raises_greys_to_its_power),
        cmocka_unit_test(gamma_comes_before_colours_and_after_what_low_values_are),
        cmocka_unit_test(each_of_two_images_has_its_own_gamma),
        cmocka_unit_test(a_colour_map_follows_what_low_values_are),
        cmocka_unit_test(a_second_image_is_mixed_in_where_it_has_a_value),
        cmocka_unit_test(opacity_goes_from_one_image_to_the_other),
        cmocka_unit_test(without_a_look_the_second_image_has_its_own_first_window_in_grey),
        cmocka_unit_test(slices_in_space_are_culled_by_the_first_image),
        cmocka_unit_test(an_image_over_itself_is_the_image),
    };
    return shots_run("colors", tests, sizeof tests / sizeof tests[0]);
}
