/* An image as a volume: what a ray absorbs and shows, against closed forms. */
#include "tests/render/volume_scene.h"

/* ---- absorption ----------------------------------------------------------------------------------------------------- */

/* A small generator, so that the test is the same everywhere; 0..1. */
static double chance(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / (1 << 24);
}

static struct vec3 any_direction(uint32_t *state)
{
    for (;;) {
        struct vec3 v = vec3(2 * chance(state) - 1, 2 * chance(state) - 1, 2 * chance(state) - 1);
        if (vec3_length(v) > 0.2 && vec3_length(v) < 1 && vec3_length(vec3_cross(vec3_normalize(v), up)) > 0.1)
            return vec3_normalize(v);
    }
}

/* Length of a line within the outer faces of a grid, mm. */
static double chord_mm(const struct grid *grid, struct vec3 at, struct vec3 direction)
{
    struct vec3 from = affine_point(&grid->ijk_from_lps_mm, at), d = affine_vector(&grid->ijk_from_lps_mm, direction);
    const double o[3] = { from.x, from.y, from.z }, step[3] = { d.x, d.y, d.z };
    double first = -INFINITY, last = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double a = (-0.5 - o[axis]) / step[axis], b = (grid->size[axis] - 0.5 - o[axis]) / step[axis];
        first = fmax(first, fmin(a, b));
        last = fmin(last, fmax(a, b));
    }
    return fmax(0, last - first);
}

/* Boxes of anisotropic voxels, and sheared ones, from any direction: 1 - exp(-mu L). */
static void a_box_of_constant_density_has_the_closed_form_opacity(void **state)
{
    (void)state;
    static const struct {
        struct vec3 i, j, k;
        uint32_t size[3];
    } grids[] = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 30, 30, 30 } },
                  { { 0.5, 0, 0 }, { 0, 0.7, 0 }, { 0, 0, 4 }, { 60, 40, 9 } },
                  { { 0.9, 0.3, 0 }, { -0.2, 1.1, 0.1 }, { 0.8, 0.1, 2.5 }, { 31, 25, 12 } },
                  { { 0, -1, 0 }, { 0, 0, -1.5 }, { 2, 0, 0 }, { 25, 20, 17 } } };
    uint32_t seed = 7;
    for (size_t g = 0; g < sizeof grids / sizeof grids[0]; g++) {
        struct grid grid = made_grid(grids[g].size[0], grids[g].size[1], grids[g].size[2],
                                     made_affine(grids[g].i, grids[g].j, grids[g].k, grids[g].size, origin));
        struct plan *plan = image_plan(&grid, g % 2 ? VOXEL_U8 : VOXEL_I16, one);
        for (int way = 0; way < 3; way++) {
            struct vec3 from = any_direction(&seed), forward = vec3_scale(from, -1);
            struct vec3 right = vec3_normalize(vec3_cross(forward, up)), upward = vec3_cross(right, forward);
            struct image *image = moving(plan, even_scene(plan, 0xffffff, 0.03), shots_view_from(origin, from, up, 5));
            for (int n = 0; n < 40; n++) {
                int x = (int)(chance(&seed) * SHOTS_WIDTH), y = (int)(chance(&seed) * SHOTS_HEIGHT);
                struct vec3 at =
                    vec3_add(vec3_scale(right, (x + 0.5 - MIDDLE_X) / 5), vec3_scale(upward, (MIDDLE_Y - y - 0.5) / 5));
                double passing = pow(1 - 0.03, chord_mm(&grid, at, forward));
                for (int c = 0; c < 3; c++)
                    assert_close(shots_pixel(image, x, y)[c], mixed(255, passing, shots_background[c]), 1.01);
            }
            image_destroy(image);
        }
        shots_forget(plan);
    }
}

/* How far inside a ball of radius 20 about (1, 2, 3). */
static double depth_in_ball(struct vec3 p)
{
    return 20 - vec3_length(vec3_sub(p, vec3(1, 2, 3)));
}

/* 1 - exp(-mu 2 sqrt(r^2 - b^2)). Both ends of a ray in the ball are found to within half an interval of a voxel of
 * 1 mm, evenly spread: at a single pixel up to 2 % of the light, in the mean nothing of first order. */
static void a_ball_of_constant_density_has_the_closed_form_opacity(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(56);
    struct plan *plan = image_plan(&grid, VOXEL_F32, depth_in_ball);
    const struct scene_transfer_point ball[] = { { 0, 0xffffff, 0 }, { 0, 0xffffff, 0.02 } };
    for (int is_still = 0; is_still < 2; is_still++) {
        struct view view = shots_view_from(vec3(1, 2, 3), vec3(0.4, -1, 0.3), up, 5);
        struct image *image = (is_still ? still : moving)(plan, volume_scene(plan, ball, 2), view);
        double sum = 0;
        int n = 0;
        for (int y = 5; y < SHOTS_HEIGHT; y += 7)
            for (int x = 5; x < SHOTS_WIDTH; x += 7) {
                double b = hypot(x + 0.5 - MIDDLE_X, y + 0.5 - MIDDLE_Y) / 5;
                double expected = mixed(255, pow(1 - 0.02, 2 * sqrt(fmax(0, 400 - b * b))), shots_background[0]);
                double value = shots_pixel(image, x, y)[0];
                if (b > 19.5 && b < 20.5) /* the outline goes through the pixel */
                    continue;
                assert_close(value, expected, is_still ? 3 : 6);
                if (b < 19.5) {
                    sum += value - expected;
                    n++;
                }
            }
        assert_close(sum / n, 0, 0.3);
        image_destroy(image);
    }
    shots_forget(plan);
}

static void a_perspective_ray_absorbs_by_its_own_length(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_U16, one);
    struct view view = shots_view_from(origin, from_front, up, 4);
    view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    view.camera.position_mm = vec3(0, -60, 0);
    view.camera.fov_deg = 60;
    struct image *image = moving(plan, even_scene(plan, 0xffffff, 0.02), view);
    double per_px = 2 * tan(30 * MATH_PI / 180) / SHOTS_HEIGHT;
    for (int n = 0; n < 30; n++) {
        int x = MIDDLE_X - 100 + 7 * n, y = 60 + 6 * n;
        struct vec3 direction = vec3_normalize(vec3((x + 0.5 - MIDDLE_X) * per_px, 1, (MIDDLE_Y - y - 0.5) * per_px));
        double passing = pow(1 - 0.02, chord_mm(&grid, vec3(0, -60, 0), direction));
        assert_close(shots_pixel(image, x, y)[1], mixed(255, passing, shots_background[1]), 1.01);
    }
    image_destroy(image);
    shots_forget(plan);
}

static void without_points_nothing_is_drawn(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(20);
    struct plan *plan = image_plan(&grid, VOXEL_U8, one);
    struct view view = shots_view_from(origin, from_front, up, 4);
    struct image *image = moving(plan, volume_scene(plan, NULL, 0), view);
    for (int c = 0; c < 3; c++)
        assert_int_equal(shots_pixel(image, MIDDLE_X, MIDDLE_Y)[c], shots_background[c]);
    image_destroy(image);
    shots_forget(plan);
}

/* A ray along L has values over 20 of its 40 mm. */
static void what_is_not_a_number_absorbs_nothing(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_F32, nan_on_the_left);
    struct scene scene = even_scene(plan, 0xffffff, 0.05);
    scene.image.volume.interpolation = SCENE_INTERPOLATION_NEAREST;
    struct image *image = moving(plan, scene, shots_view_from(origin, vec3(1, 0, 0), up, 4));
    double sum = 0;
    for (int i = 0; i < 64; i++)
        sum += shots_pixel(image, MIDDLE_X + i % 8, MIDDLE_Y + i / 8)[0] / 64.0;
    assert_close(sum, mixed(255, pow(0.95, 20), shots_background[0]), 1);
    image_destroy(image);
    shots_forget(plan);
}

static double along_p(struct vec3 p)
{
    return 100 + 2 * p.y;
}
static void values_below_the_limit_absorb_nothing(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_F32, along_p);
    struct scene scene = even_scene(plan, 0xffffff, 0.05);
    scene.image.volume.cull_below = 110; /* y >= 5: 15 mm of 40 */
    struct image *image = moving(plan, scene, shots_view_from(origin, from_front, up, 4));
    double sum = 0;
    for (int i = 0; i < 64; i++)
        sum += shots_pixel(image, MIDDLE_X + i % 8, MIDDLE_Y + i / 8)[0] / 64.0;
    assert_close(sum, mixed(255, pow(0.95, 15), shots_background[0]), 1);
    image_destroy(image);
    shots_forget(plan);
}

/* ---- other methods ------------------------------------------------------------------------------------------------- */

/* Light that is added to the background. */
static double added(double grey, int c)
{
    return 255 * (grey + (1 - grey) * shots_background[c] / 255.0);
}

static struct scene projected(const struct plan *plan, enum scene_volume_method method)
{
    struct scene scene = volume_scene(plan, NULL, 0);
    scene.image.volume.method = method;
    scene.image.window.center = 100;
    scene.image.window.width = 100;
    return scene;
}

/* 100 + 2 y with y from -19.5 to 19.5: at most 139, in the mean 100. */
static void the_largest_value_and_the_mean_are_those_of_the_field(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    for (int type = VOXEL_U8; type <= VOXEL_F32; type++) {
        struct plan *plan = image_plan(&grid, (enum voxel_type)type, along_p);
        struct view view = shots_view_from(origin, from_front, up, 4);
        struct image *most = moving(plan, projected(plan, SCENE_VOLUME_METHOD_MIP), view),
                     *mean = moving(plan, projected(plan, SCENE_VOLUME_METHOD_AVERAGE), view);
        for (int i = 0; i < 30; i++) {
            int x = MIDDLE_X - 60 + 4 * i, y = MIDDLE_Y - 58 + 3 * i;
            assert_close(shots_pixel(most, x, y)[0], added((139 - 50) / 100.0, 0), 3);
            /* all values are taken up to half an interval of 2 mm off, to one side: 2 of 100 */
            assert_close(shots_pixel(mean, x, y)[0], added(0.5, 0), 5.5);
        }
        image_destroy(most);
        image_destroy(mean);
        shots_forget(plan);
    }
}

/* Level 227 of hot iron: red 2 x 227 is 255 at most, green 2 x 99 = 198, blue 4 x 35 = 140 (DICOM PS3.6 B.1.1); next to
 * it 2 and 4 less or more. All of the light behind is hidden, as red is as bright as can be. */
static void the_largest_value_has_the_colour_of_the_images_map(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_I16, along_p);
    struct scene scene = projected(plan, SCENE_VOLUME_METHOD_MIP);
    scene.image.color_map = SCENE_COLOR_MAP_HOT_IRON;
    struct image *image = moving(plan, scene, shots_view_from(origin, from_front, up, 4));
    const uint8_t *pixel = shots_pixel(image, MIDDLE_X, MIDDLE_Y);
    assert_int_equal(pixel[0], 255);
    assert_close(pixel[1], 198, 2 * 5); /* up to half an interval off: 2 of 100, 5 levels */
    assert_close(pixel[2], 140, 4 * 5);
    image_destroy(image);
    shots_forget(plan);
}

/* The mean counts values from 110 on: y from 5 to 20, 110 to 139 and half a voxel of 139. */
static void the_mean_leaves_out_what_is_below_the_limit(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_F32, along_p);
    struct scene scene = projected(plan, SCENE_VOLUME_METHOD_AVERAGE);
    scene.image.volume.cull_below = 110;
    struct image *image = still(plan, scene, shots_view_from(origin, from_front, up, 4));
    double expected = (14.5 * (110 + 139) / 2 + 0.5 * 139) / 15;
    assert_close(shots_pixel(image, MIDDLE_X, MIDDLE_Y)[0], added((expected - 50) / 100, 0), 2);
    image_destroy(image);
    shots_forget(plan);
}

/* 40 planes 1 mm apart at y = -19.5, -18.5, ...; the first with 100 + 2 y >= 110 is at y = 5.5: 111. Of the nearest
 * voxel the value is the same, as planes and voxels coincide. */
static void the_first_of_the_slices_that_is_not_culled_is_seen(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_I16, along_p);
    for (int is_nearest = 0; is_nearest < 2; is_nearest++) {
        struct scene scene = projected(plan, SCENE_VOLUME_METHOD_SLICES);
        scene.image.volume.cull_below = 109.5;
        scene.image.volume.steps = 40;
        scene.image.volume.interpolation = is_nearest ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
        struct image *image = moving(plan, scene, shots_view_from(origin, from_front, up, 4));
        assert_close(shots_pixel(image, MIDDLE_X + 9, MIDDLE_Y - 5)[2], 255 * 0.61, 1.01);
        assert_int_equal(shots_pixel(image, 5, 5)[2], shots_background[2]);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* ---- light ---------------------------------------------------------------------------------------------------------- */

/* A surface that faces the viewer is lit as a triangle there would be; so is the same seen from behind. */
static void a_surface_in_a_volume_is_lit_as_a_surface(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_F32, along_p);
    const struct scene_transfer_point wall[] = {
        { 99, 0x808080, 0 }, { 99, 0x808080, 1 }, { 101, 0x808080, 1 }, { 101, 0x808080, 0 }
    };
    for (int side = -1; side <= 1; side += 2) {
        struct scene scene = volume_scene(plan, wall, 4);
        scene.image.volume.shaded = true;
        struct image *image = still(plan, scene, shots_view_from(origin, vec3(0, side, 0), up, 4));
        double expected = 255 * shots_facing_light(128 / 255.0, true);
        assert_close(shots_pixel(image, MIDDLE_X, MIDDLE_Y)[0], mixed(expected, 0.001, shots_background[0]), 3);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* ---- our own rasteriser ---------------------------------------------------------------------------------------------- */

static double waves(struct vec3 p)
{
    return 300 * sin(p.x * 0.31) * cos(p.y * 0.23) * sin(p.z * 0.27 + 1);
}

static void threads_and_processors_do_not_change_a_picture(void **state)
{
    (void)state;
    if (renderer_facts(shots_renderer)->back_end != RENDER_SOFT)
        skip(); /* the others have no say in their threads */
    const uint32_t size[3] = { 45, 37, 51 };
    struct grid grid =
        made_grid(45, 37, 51, made_affine(vec3(1, 0.1, 0), vec3(0, 1.2, 0.2), vec3(0.1, 0, 0.8), size, origin));
    static const struct {
        int n_threads;
        bool is_portable;
    } ways[] = { { 1, false }, { 2, false }, { 7, false }, { 1, true }, { 7, true } };
    const struct scene_transfer_point points[] = {
        { -250, 0x80ff40, 0.4 }, { -150, 0x0000ff, 0 }, { 100, 0xff8040, 0 }, { 200, 0xffffff, 0.3 }
    };
    for (int picture = 0; picture < 12; picture++) {
        struct plan *plan = made_plan(&grid, plates, red_and_blue, 2);
        made_plan_add_image(plan, &grid, (enum voxel_type)(picture % 4), waves);
        struct image *first = NULL;
        for (size_t way = 0; way < sizeof ways / sizeof ways[0]; way++) {
            struct scene scene = volume_scene(plan, points, 4);
            scene.image.volume.method = (enum scene_volume_method)(picture / 4 == 2 ? 1 + picture % 4 % 3 : 0);
            scene.image.volume.shaded = picture / 4 == 1;
            scene.image.volume.interpolation = picture % 3 ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
            shots_style(&scene, "red")->opacity = 0.5;
            scene.clip.axial_high.enabled = true;
            scene.clip.axial_high.position_mm = 12;
            scene.still.ambient_occlusion = picture == 3 || picture == 5;
            struct view view = shots_view_from(origin, vec3(0.5, -1, 0.7), up, 4);
            if (picture % 2)
                view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
            renderer_tune(shots_renderer, ways[way].n_threads, ways[way].is_portable);
            struct image *image = (picture % 2 ? still : moving)(plan, scene, view);
            if (first) {
                assert_memory_equal(image->rgba, first->rgba, (size_t)4 * SHOTS_WIDTH * SHOTS_HEIGHT);
                image_destroy(image);
            } else
                first = image;
        }
        image_destroy(first);
        shots_forget(plan);
    }
    renderer_tune(shots_renderer, 2, false);
}

static bool is_always_due(void *context)
{
    (void)context;
    return true;
}
static void pauses_do_not_change_a_picture(void **state)
{
    (void)state;
    struct plan *plan = plates_plan();
    struct view view = shots_view_from(origin, vec3(0.5, -1, 0.7), up, 4);
    struct scene scene = even_scene(plan, 0xffffff, 0.02), same = even_scene(plan, 0xffffff, 0.02);
    shots_style(&scene, "red")->opacity = shots_style(&same, "red")->opacity = 0.4;
    struct image *whole = still(plan, scene, view);
    struct render_options options = { view.size_px[0], view.size_px[1], SURFACE_FULL, true };
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &same, &view, 1, field, &err);
    struct render_picture *picture = render_begin(shots_renderer, snapshot, &options);
    enum render_state at = RENDER_PAUSED;
    int n_parts = 0;
    for (; at == RENDER_PAUSED; n_parts++)
        at = render_go_on(picture, &(struct render_pause){ is_always_due, NULL }, &err);
    struct camera camera;
    struct render_timing timing;
    struct image *paused = render_end(picture, &camera, &timing);
    if (renderer_facts(shots_renderer)->back_end == RENDER_SOFT)
        assert_true(n_parts > 5);
    assert_memory_equal(paused->rgba, whole->rgba, (size_t)4 * SHOTS_WIDTH * SHOTS_HEIGHT);
    snapshot_unref(snapshot);
    image_destroy(whole);
    image_destroy(paused);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_of_constant_density_has_the_closed_form_opacity),
        cmocka_unit_test(a_ball_of_constant_density_has_the_closed_form_opacity),
        cmocka_unit_test(a_perspective_ray_absorbs_by_its_own_length),
        cmocka_unit_test(without_points_nothing_is_drawn),
        cmocka_unit_test(what_is_not_a_number_absorbs_nothing),
        cmocka_unit_test(values_below_the_limit_absorb_nothing),
        cmocka_unit_test(the_largest_value_and_the_mean_are_those_of_the_field),
        cmocka_unit_test(the_largest_value_has_the_colour_of_the_images_map),
        cmocka_unit_test(the_mean_leaves_out_what_is_below_the_limit),
        cmocka_unit_test(the_first_of_the_slices_that_is_not_culled_is_seen),
        cmocka_unit_test(a_surface_in_a_volume_is_lit_as_a_surface),
        cmocka_unit_test(pauses_do_not_change_a_picture),
        cmocka_unit_test(threads_and_processors_do_not_change_a_picture),
    };
    return shots_run("volume", tests, sizeof tests / sizeof tests[0]);
}
