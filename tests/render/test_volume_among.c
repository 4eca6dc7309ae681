/* A volume among other draws: divided at translucent layers, ended by opaque draws, cut by clip planes. */
#include "tests/render/volume_scene.h"

/* At each sample: 15 mm of the volume, a layer, 15 or 17 mm, the other layer, the rest of 70 mm. */
static void translucent_layers_lie_in_a_volume_at_their_depth(void **state)
{
    (void)state;
    struct plan *plan = plates_plan();
    struct view view = shots_view_from(origin, from_front, up, 4);
    struct scene scene = even_scene(plan, 0xffffff, 0.02);
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    shots_style(&scene, "red")->opacity = 0.5;
    shots_style(&scene, "blue")->opacity = 0.7;
    struct image *image = moving(plan, scene, view);
    const double opacity[2] = { 0.5, 0.7 };
    const double front_mm[2][2] = { { 30, 15 }, { 30, 47 } }; /* by side, red and blue: from the volume's face */
    for (int side = 0; side < 2; side++) {
        int far = front_mm[side][1] > front_mm[side][0] ? 1 : 0, near = 1 - far;
        for (int c = 0; c < 3; c++) {
            double layer[2];
            for (int i = 0; i < 2; i++)
                layer[i] = 255 * shots_facing_light((red_and_blue[i].rgb >> (16 - 8 * c) & 255) / 255.0, false);
            double color = mixed(255, pow(0.98, 70 - front_mm[side][far]), shots_background[c]);
            color = mixed(layer[far], 1 - opacity[far], color);
            color = mixed(255, pow(0.98, front_mm[side][far] - front_mm[side][near]), color);
            color = mixed(layer[near], 1 - opacity[near], color);
            color = mixed(255, pow(0.98, front_mm[side][near]), color);
            assert_close(shots_pixel(image, side ? 260 : 140, MIDDLE_Y)[c], color, 2);
        }
    }
    image_destroy(image);
    shots_forget(plan);
}

static void a_volume_ends_at_opaque_surfaces_and_slices(void **state)
{
    (void)state;
    struct plan *plan = plates_plan();
    struct view view = shots_view_from(origin, from_front, up, 4);
    struct scene bare = even_scene(plan, 0xffffff, 0.02), with = even_scene(plan, 0xffffff, 0.02);
    bare.image.volume.visible = false;
    struct image *surfaces = moving(plan, bare, view), *both = moving(plan, with, view);
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 3; c++)
            assert_close(shots_pixel(both, side ? 260 : 140, MIDDLE_Y)[c],
                         mixed(255, pow(0.98, side ? 30 : 15), shots_pixel(surfaces, side ? 260 : 140, MIDDLE_Y)[c]),
                         2);
    image_destroy(surfaces);
    image_destroy(both);
    struct scene slice = even_scene(plan, 0x000000, 0.02);
    shots_style(&slice, "red")->visible = shots_style(&slice, "blue")->visible = false;
    slice.image.slices.coronal.visible = true;
    slice.image.slices.coronal.position_mm = 0;
    slice.image.window.center = 0.5; /* 1 is white */
    slice.image.window.width = 1;
    struct image *half = moving(plan, slice, view);
    assert_close(shots_pixel(half, MIDDLE_X, MIDDLE_Y)[0], 255 * pow(0.98, 35), 1.5);
    image_destroy(half);
    shots_forget(plan);
}

static void clip_planes_cut_a_volume_unless_it_is_exempt(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_I16, one);
    struct view view = shots_view_from(origin, from_front, up, 4);
    for (int way = 0; way < 4; way++) {
        struct scene scene = even_scene(plan, 0xffffff, 0.05);
        scene.clip.coronal_high.enabled = way != 2; /* behind: nothing to close */
        scene.clip.coronal_high.position_mm = 3;
        scene.clip.free.enabled = way >= 1;
        scene.clip.free.normal = vec3(0, -2, 0); /* cuts off what is before y = -9 */
        scene.clip.free.origin_mm = vec3(5, -9, 7);
        scene.clip.free.cap = false;
        scene.image.volume.clipped = way < 3;
        const double left_mm[4] = { 23, 12, 29, 40 };
        struct image *image = moving(plan, scene, view);
        assert_close(shots_pixel(image, MIDDLE_X, MIDDLE_Y)[0],
                     mixed(255, pow(0.95, left_mm[way]), shots_background[0]), 1.01);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* 2 L + P: on the plane y = -5 the value at x is 2 x - 5. */
static double across(struct vec3 p)
{
    return 2 * p.x + p.y;
}
static void a_capped_cut_through_a_volume_shows_the_image_where_the_volume_is_seen(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_F32, across);
    struct view view = shots_view_from(origin, from_front, up, 4);
    const struct scene_transfer_point seen[] = { { 0, 0xffffff, 0 }, { 0, 0xffffff, 0.5 } };
    struct scene scene = volume_scene(plan, seen, 2);
    scene.clip.coronal_low.enabled = true;
    scene.clip.coronal_low.position_mm = -5;
    scene.image.window.center = 20;
    scene.image.window.width = 50;
    struct image *image = moving(plan, scene, view);
    for (int x = MIDDLE_X + 12; x < MIDDLE_X + 70; x += 5) { /* right of the picture is the patient's left, +x */
        double value = 2 * (x + 0.5 - MIDDLE_X) / 4 - 5;
        assert_true(value > 0);
        assert_close(shots_pixel(image, x, MIDDLE_Y)[1], fmax(255 * (value + 5) / 50, shots_background[1]), 1.5);
    }
    assert_int_equal(shots_pixel(image, MIDDLE_X - 70, MIDDLE_Y)[1], shots_background[1]); /* less than 0 all along */
    image_destroy(image);
    shots_forget(plan);
}

/* Voxels of 2 mm, 8 px: from middle to middle of two voxels a nearest slice has one of their two greys. */
static void a_slice_of_nearest_voxels_stays_one_after_a_picture_of_the_volume(void **state)
{
    (void)state;
    const uint32_t size[3] = { 20, 20, 20 };
    struct grid grid =
        made_grid(20, 20, 20, made_affine(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 2), size, vec3(1, 1, 1)));
    struct plan *plan = image_plan(&grid, VOXEL_I16, across);
    struct scene scene = even_scene(plan, 0xffffff, 0.1);
    image_destroy(moving(plan, scene, shots_view_from(origin, from_front, up, 4)));
    scene = volume_scene(plan, NULL, 0);
    scene.image.volume.visible = false;
    scene.image.interpolation = SCENE_INTERPOLATION_NEAREST;
    scene.image.window.center = 0;
    scene.image.window.width = 100;
    scene.image.slices.coronal.position_mm = 0;
    struct image *image = moving(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, 4));
    for (int voxel = -8; voxel < 8; voxel++) /* their middles are at 0, 2, 4 mm ... */
        for (int x = 1; x < 7; x++)
            assert_close(shots_pixel(image, MIDDLE_X + 8 * voxel - 4 + x, MIDDLE_Y)[0],
                         255 * (2 * 2 * voxel + 50) / 100.0, 1);
    image_destroy(image);
    shots_forget(plan);
}

/* Where a neighbour is not a number there is no gradient, and of the light DRAW_VOLUME_FLAT is left, as where nothing
 * changes: 0.8 of 128. */
static void beside_what_is_not_a_number_a_volume_is_lit_as_without_gradient(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = image_plan(&grid, VOXEL_F32, nan_on_the_left);
    struct scene scene = even_scene(plan, 0x808080, 1);
    scene.image.volume.shaded = true;
    scene.image.volume.interpolation = SCENE_INTERPOLATION_NEAREST;
    struct image *image = moving(plan, scene, shots_view_from(origin, vec3(1, 0, 0), up, 4));
    for (int i = 0; i < 64; i++)
        assert_close(shots_pixel(image, MIDDLE_X + i % 8, MIDDLE_Y + i / 8)[0], 0.8 * 128, 2);
    image_destroy(image);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(translucent_layers_lie_in_a_volume_at_their_depth),
        cmocka_unit_test(a_volume_ends_at_opaque_surfaces_and_slices),
        cmocka_unit_test(clip_planes_cut_a_volume_unless_it_is_exempt),
        cmocka_unit_test(a_capped_cut_through_a_volume_shows_the_image_where_the_volume_is_seen),
        cmocka_unit_test(a_slice_of_nearest_voxels_stays_one_after_a_picture_of_the_volume),
        cmocka_unit_test(beside_what_is_not_a_number_a_volume_is_lit_as_without_gradient),
    };
    return shots_run("volume_among", tests, sizeof tests / sizeof tests[0]);
}
