/* Pictures against calculations by hand: which side of a surface is seen, how colours blend, sizes, greys of values. */
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const struct vec3 from_front = { 0, -1, 0 }, up = { 0, 0, 1 };

/* ---- winding, depth, blending ----------------------------------------------------------------------------------- */

static double ball_label(struct vec3 p)
{
    return vec3_length(p) <= 20 ? 1 : 0;
}
static const struct made_region ball[] = { { "ball", -1, 0xc8c8c8 } };

static void the_near_side_of_a_ball_is_seen_lit_from_the_upper_right(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(50);
    struct plan *plan = made_plan(&grid, ball_label, ball, 1);
    struct image *image = shots_plain(plan, shots_scene(plan), shots_view_from(origin, from_front, up, 6));
    int right = shots_pixel(image, 200 + 60, 150 - 60)[0], left = shots_pixel(image, 200 - 60, 150 + 60)[0];
    assert_true(right > left + 60); /* if the far side were drawn, its normals would reverse this */
    double grey = 0xc8 / 255.0;
    assert_close(shots_pixel(image, 200, 150)[0], 255 * shots_facing_light(grey, true),
                 8); /* averaged normals of voxels: a few levels */
    assert_memory_equal(shots_pixel(image, 2, 2), shots_background, 3);
    image_destroy(image);
    shots_forget(plan);
}

/* Nested boxes, half sides 12, 24, 36; labels 3, 2, 1. Their front faces are flat, so in the middle normals are exact.
 */
static double nested_label(struct vec3 p)
{
    double r = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
    return r < 12 ? 3 : r < 24 ? 2 : r < 36 ? 1 : 0;
}
static const struct made_region nested[] = { { "outer", -1, 0xff8040 },
                                             { "middle", 0, 0x40ff80 },
                                             { "inner", 1, 0x8040ff } };

static void blend(double under[3], const double rgb[3], double alpha)
{
    for (int c = 0; c < 3; c++)
        under[c] = alpha * shots_facing_light(rgb[c], alpha >= 1) + (1 - alpha) * under[c];
}

static void translucent_surfaces_blend_from_the_inside_out(void **state)
{
    (void)state;
    static const double outer[3] = { 1, 0x80 / 255.0, 0x40 / 255.0 }, middle[3] = { 0x40 / 255.0, 1, 0x80 / 255.0 },
                        inner[3] = { 0x80 / 255.0, 0x40 / 255.0, 1 };
    struct grid grid = made_cube_grid(80);
    struct plan *plan = made_plan(&grid, nested_label, nested, 3);
    struct scene scene = shots_scene(plan);
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    shots_style(&scene, "outer")->opacity = 0.25;
    shots_style(&scene, "middle")->opacity = 0.5;
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, 3));
    double expected[3] = { 0 };
    blend(expected, inner, 1);
    blend(expected, middle, 0.5);
    blend(expected, outer, 0.25);
    shots_expect_color(shots_pixel(image, 200, 150), expected);
    image_destroy(image);

    /* all three translucent, with rims: facing squarely, alpha is 0.3 of the opacity */
    scene = shots_scene(plan);
    shots_style(&scene, "outer")->opacity = 0.9;
    shots_style(&scene, "middle")->opacity = 0.8;
    shots_style(&scene, "inner")->opacity = 0.7;
    image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, 3));
    double rims[3] = { 0x08 / 255.0, 0x09 / 255.0, 0x0b / 255.0 };
    blend(rims, inner, 0.3 * 0.7);
    blend(rims, middle, 0.3 * 0.8);
    blend(rims, outer, 0.3 * 0.9);
    shots_expect_color(shots_pixel(image, 200, 150), rims);
    image_destroy(image);
    shots_forget(plan);
}

static void an_opaque_surface_hides_what_it_encloses(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(80);
    struct plan *plan = made_plan(&grid, nested_label, nested, 3);
    struct render_timing all, outer;
    struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, false };
    struct view view = shots_view_from(origin, from_front, up, 3);
    struct image *a = shots_take(plan, shots_scene(plan), view, &options, &all);
    struct scene scene = shots_scene(plan);
    shots_style(&scene, "middle")->visible = false;
    shots_style(&scene, "inner")->opacity = 0;
    struct image *b = shots_take(plan, scene, view, &options, &outer);
    assert_memory_equal(a->rgba, b->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    assert_int_equal(all.n_triangles, outer.n_triangles); /* and is not even drawn */
    image_destroy(a);
    image_destroy(b);
    shots_forget(plan);
}

/* Two separate slabs, one before the other, and a third region of two slabs joined at the side: a fold. */
static double slabs_label(struct vec3 p)
{
    bool is_across = fabs(p.x) < 25 && fabs(p.z) < 25;
    if (is_across && p.y > -30 && p.y < -20)
        return 1;
    if (is_across && p.y > 20 && p.y < 30)
        return 2;
    return 0;
}
static const struct made_region slabs[] = { { "front", -1, 0xff8040 }, { "back", -1, 0x4080ff } };

static void separate_translucent_surfaces_blend_by_distance_from_either_side(void **state)
{
    (void)state;
    static const double front[3] = { 1, 0x80 / 255.0, 0x40 / 255.0 }, back[3] = { 0x40 / 255.0, 0x80 / 255.0, 1 };
    struct grid grid = made_cube_grid(70);
    struct plan *plan = made_plan(&grid, slabs_label, slabs, 2);
    for (int side = 0; side < 2; side++) {
        struct scene scene = shots_scene(plan);
        scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
        shots_style(&scene, "front")->opacity = shots_style(&scene, "back")->opacity = 0.5;
        struct image *image = shots_plain(plan, scene, shots_view_from(origin, vec3(0, side ? 1 : -1, 0), up, 3));
        double expected[3] = { 0x08 / 255.0, 0x09 / 255.0, 0x0b / 255.0 };
        blend(expected, side ? front : back, 0.5);
        blend(expected, side ? back : front, 0.5);
        shots_expect_color(shots_pixel(image, 200, 150), expected);
        image_destroy(image);
    }
    shots_forget(plan);
}

static double fold_label(struct vec3 p)
{
    return slabs_label(p) > 0 || (fabs(p.z) < 25 && fabs(p.y) < 30 && p.x > 20 && p.x < 25) ? 1 : 0;
}

static void a_folded_translucent_surface_shows_its_front_sheet_once(void **state)
{
    (void)state;
    static const double color[3] = { 1, 0x80 / 255.0, 0x40 / 255.0 };
    struct grid grid = made_cube_grid(70);
    struct plan *plan = made_plan(&grid, fold_label, slabs, 1);
    for (int side = 0; side < 2; side++) { /* whichever order the triangles come in */
        struct scene scene = shots_scene(plan);
        scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
        shots_style(&scene, "front")->opacity = 0.5;
        struct image *image = shots_plain(plan, scene, shots_view_from(origin, vec3(0, side ? 1 : -1, 0), up, 3));
        double expected[3] = { 0x08 / 255.0, 0x09 / 255.0, 0x0b / 255.0 };
        blend(expected, color, 0.5);
        shots_expect_color(shots_pixel(image, 200, 150), expected);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* ---- size ------------------------------------------------------------------------------------------------------- */

static double box_label(struct vec3 p)
{
    return fabs(p.x) < 20 && fabs(p.y) < 20 && fabs(p.z) < 10 ? 1 : 0;
}

static void measure_silhouette(const struct image *image, int *width_px, int *height_px)
{
    *width_px = *height_px = 0;
    for (int x = 0; x < image->width_px; x++)
        *width_px += memcmp(shots_pixel(image, x, image->height_px / 2), shots_background, 3) != 0;
    for (int y = 0; y < image->height_px; y++)
        *height_px += memcmp(shots_pixel(image, image->width_px / 2, y), shots_background, 3) != 0;
}

static void silhouettes_are_as_large_as_the_projection_says(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, box_label, ball, 1); /* 40 x 40 x 20 mm between outer voxel faces */
    int width_px, height_px;
    struct image *image = shots_plain(plan, shots_scene(plan), shots_view_from(origin, from_front, up, 5));
    measure_silhouette(image, &width_px, &height_px);
    assert_close(width_px, 40 * 5, 1);
    assert_close(height_px, 20 * 5, 1);
    image_destroy(image);

    struct view view = shots_view_from(origin, from_front, up, 1);
    view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    view.camera.fov_deg = 40;
    view.camera.has_height_mm = false;
    view.camera.position_mm = vec3(0, -120, 0); /* 100 mm before the near face */
    image = shots_plain(plan, shots_scene(plan), view);
    measure_silhouette(image, &width_px, &height_px);
    double pixels_per_mm = SHOTS_HEIGHT / (2 * 100 * tan(MATH_PI * 20 / 180));
    assert_close(width_px, 40 * pixels_per_mm, 1);
    assert_close(height_px, 20 * pixels_per_mm, 1);
    image_destroy(image);
    shots_forget(plan);
}

static void fewer_pixels_show_the_same_view(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, box_label, ball, 1);
    struct render_options options = { SHOTS_WIDTH / 2, SHOTS_HEIGHT / 2, SURFACE_FULL, false };
    struct image *image =
        shots_take(plan, shots_scene(plan), shots_view_from(origin, from_front, up, 5), &options, NULL);
    int width_px, height_px;
    assert_int_equal(image->width_px, SHOTS_WIDTH / 2);
    measure_silhouette(image, &width_px, &height_px);
    assert_close(width_px, 40 * 5 / 2, 1);
    assert_close(height_px, 20 * 5 / 2, 1);
    image_destroy(image);
    shots_forget(plan);
}

static void what_is_out_of_sight_is_not_drawn_and_what_is_partly_in_sight_is(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, box_label, ball, 1);
    struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, false };
    struct render_timing timing;
    /* 5 pixels a millimetre: 80 mm across, and the box reaches 20 mm to the left of the patient's middle */
    image_destroy(
        shots_take(plan, shots_scene(plan), shots_view_from(vec3(-61, 0, 0), from_front, up, 5), &options, &timing));
    assert_int_equal(timing.n_triangles, 0);
    struct image *image =
        shots_take(plan, shots_scene(plan), shots_view_from(vec3(-59, 0, 0), from_front, up, 5), &options, &timing);
    assert_true(timing.n_triangles > 0);
    assert_memory_not_equal(shots_pixel(image, SHOTS_WIDTH - 2, SHOTS_HEIGHT / 2), shots_background, 3);
    assert_memory_equal(shots_pixel(image, SHOTS_WIDTH - 8, SHOTS_HEIGHT / 2), shots_background, 3);
    image_destroy(image);
    shots_forget(plan);
}

/* ---- greys ------------------------------------------------------------------------------------------------------ */

static double ramp(struct vec3 p)
{
    return floor(10 * p.x);
} /* -300 .. 300: whole numbers, so that 16 bits hold them */
static double high_ramp(struct vec3 p)
{
    return floor(10 * p.x) + 40000;
}
static double small_ramp(struct vec3 p)
{
    return floor(p.x) + 100;
}
static double empty_label(struct vec3 p)
{
    return p.x * 0;
}

static int expected_grey(double value, double center, double width)
{
    double shade = (value - (center - width / 2)) / width;
    return (int)floor(255 * fmin(fmax(shade, 0), 1) + 0.5);
}

static void every_voxel_has_the_grey_its_window_says(void **state)
{
    (void)state;
    static const struct {
        enum voxel_type type;
        double (*value)(struct vec3 p);
        double center, width;
    } cases[] = { { VOXEL_I16, ramp, 20, 333 },
                  { VOXEL_F32, ramp, -50, 400 },
                  { VOXEL_U16, high_ramp, 40000, 500 },
                  { VOXEL_U8, small_ramp, 100, 50 } };
    struct grid grid = made_cube_grid(60);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct plan *plan = made_plan(&grid, empty_label, ball, 0);
        made_plan_add_image(plan, &grid, cases[i].type, cases[i].value);
        struct scene scene = shots_scene(plan);
        scene.image.interpolation = SCENE_INTERPOLATION_NEAREST;
        scene.image.window = (struct scene_window){ cases[i].center, cases[i].width, 1 };
        struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 4));
        for (int voxel = 0; voxel < 60; voxel++) {
            double x_mm = voxel - 29.5, value = cases[i].value(vec3(x_mm, 0, 0));
            const uint8_t *p = shots_pixel(image, 200 + (int)floor(x_mm * 4), 150);
            double grey = expected_grey(value, cases[i].center, cases[i].width);
            assert_close(p[0], fmax(grey, shots_background[0]), 1);
        }
        assert_memory_equal(shots_pixel(image, 200 + 31 * 4, 150), shots_background, 3); /* beyond the grid */
        image_destroy(image);
        shots_forget(plan);
    }
}

static void linear_interpolation_is_linear(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, empty_label, ball, 0);
    made_plan_add_image(plan, &grid, VOXEL_F32, ramp);
    struct scene scene = shots_scene(plan);
    scene.image.window = (struct scene_window){ 0, 300, 1 };
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 8));
    for (int x = 200 - 100; x < 200 + 100; x++)
        assert_close(shots_pixel(image, x, 150)[0], 127.5 + 255 * 10 * ((x + 0.5 - 200) / 8.0) / 300, 1.5);
    image_destroy(image);
    shots_forget(plan);
}

static void a_slice_in_space_leaves_out_what_is_below_the_threshold(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, empty_label, ball, 0);
    made_plan_add_image(plan, &grid, VOXEL_I16, ramp); /* 10 a millimetre to the left */
    struct scene scene = shots_scene(plan);
    scene.image.slices.coronal.visible = true;
    scene.image.window = (struct scene_window){ 0, 600, 1 };
    scene.image.cull_below = 50;
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, 4));
    assert_memory_equal(shots_pixel(image, 200 + 4 * 4, 150), shots_background, 3); /* 40 */
    assert_close(shots_pixel(image, 200 + 6 * 4, 150)[0], 255 * 360 / 600.0, 3); /* 60: half a millimetre is 2 levels */
    image_destroy(image);

    scene = shots_scene(plan); /* the slice's own pane shows everything */
    scene.image.window = (struct scene_window){ 0, 600, 1 };
    scene.image.cull_below = 50;
    image = shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, origin, 4));
    assert_close(shots_pixel(image, 200 - 10 * 4, 150)[0], 255 * 200 / 600.0, 3);
    image_destroy(image);
    shots_forget(plan);
}

static double holed(struct vec3 p)
{
    return vec3_length(p) < 5 ? NAN : 100;
}

static void what_is_not_a_number_is_not_drawn(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(30);
    struct plan *plan = made_plan(&grid, empty_label, ball, 0);
    made_plan_add_image(plan, &grid, VOXEL_F32, holed);
    struct scene scene = shots_scene(plan);
    scene.image.window = (struct scene_window){ 0, 200, 1 };
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 4));
    assert_memory_equal(shots_pixel(image, 200, 150), shots_background, 3);
    assert_int_equal(shots_pixel(image, 200 + 40, 150)[0], 255);
    image_destroy(image);
    shots_forget(plan);
}

static void a_grid_beyond_the_drivers_limit_is_refused_with_its_size(void **state)
{
    (void)state;
    const uint32_t size[3] = { 4096, 2, 2 };
    struct grid grid =
        made_grid(size[0], size[1], size[2], made_affine(vec3(0.1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, origin));
    struct plan *plan = made_plan(&grid, empty_label, ball, 0);
    made_plan_add_image(plan, &grid, VOXEL_U8, small_ramp);
    struct scene scene = shots_scene(plan);
    struct view view = shots_view(SCENE_KIND_AXIAL, origin, 1);
    struct error err = { 0 };
    char field[128];
    struct camera camera;
    struct render_timing timing;
    struct render_options options = { 64, 64, SURFACE_FULL, false };
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    struct image *image = render_snapshot(shots_renderer, snapshot, &options, &camera, &timing, &err);
    if (!image) { /* a driver that takes 4096 draws it */
        assert_int_equal(err.code, ERROR_LIMIT);
        assert_non_null(strstr(err.text, "4096 x 2 x 2"));
    }
    image_destroy(image);
    snapshot_unref(snapshot);
    shots_forget(plan);
}

/* ---- stills, coarse surfaces, repeatability --------------------------------------------------------------------- */

/* The number of pixels on the box's slanted edges that are neither background nor face. */
static size_t count_between(const struct image *image)
{
    const uint8_t *face = shots_pixel(image, image->width_px / 2, image->height_px / 2);
    size_t n = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++) {
            const uint8_t *p = shots_pixel(image, x, y);
            n += p[0] > shots_background[0] + 20 && p[0] < face[0] - 20;
        }
    return n;
}

static void stills_have_smooth_edges(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, box_label, ball, 1);
    size_t n[2];
    for (int is_still = 0; is_still < 2; is_still++) {
        struct scene scene = shots_scene(plan);
        scene.surface.normals = SCENE_NORMALS_FACE; /* one colour all over the front face */
        struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, is_still };
        struct image *image =
            shots_take(plan, scene, shots_view_from(origin, from_front, vec3(0.3, 0, 1), 5), &options, NULL);
        n[is_still] = count_between(image);
        image_destroy(image);
    }
    /* marching cubes bevels the box's edges by half a voxel, 2.5 pixels here, which may shade differently: compare, do
     * not count */
    assert_true(n[1] > n[0] + 300); /* the outline is 600 pixels long, about 3 of 4 of them cut by a slanted edge */
    shots_forget(plan);
}

static double large_box_label(struct vec3 p)
{
    return fabs(p.x) < 65 && fabs(p.y) < 65 && fabs(p.z) < 65 ? 1 : 0;
}

static void coarse_surfaces_are_marked_and_have_fewer_triangles(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(134);
    struct plan *plan = made_plan(&grid, large_box_label, ball, 1); /* 6 x 130 x 130 squares: 200 000 triangles */
    struct render_timing full, coarse;
    struct view view = shots_view_from(origin, from_front, up, 2);
    image_destroy(
        shots_take(plan, shots_scene(plan), view, &(struct render_options){ 400, 300, SURFACE_FULL, false }, &full));
    image_destroy(shots_take(plan, shots_scene(plan), view, &(struct render_options){ 400, 300, SURFACE_COARSE, false },
                             &coarse));
    assert_false(full.is_coarse);
    assert_true(coarse.is_coarse);
    assert_true(full.n_triangles > 6 * 128 * 128 * 2);
    assert_true(coarse.n_triangles <= COARSE_MAX_TRIANGLES);
    shots_forget(plan);
}

static double specks_label(struct vec3 p)
{
    return fabs(p.x) < 10 && fabs(p.y) < 10 && fabs(p.z) < 10                         ? 1
           : fabs(p.x - 14.5) < 0.4 && fabs(p.y - 0.5) < 0.4 && fabs(p.z - 0.5) < 0.4 ? 2
                                                                                      : 0;
}

static const struct made_region specks[] = { { "box", -1, 0xff8040 }, { "speck", -1, 0x40ff80 } };

/* A box is smaller by half a voxel on either side; a lone voxel is gone, and marching cubes brings both back. */
static void the_scene_says_how_regions_become_surfaces(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, specks_label, specks, 2);
    struct view view = shots_view_from(origin, from_front, up, 10);
    struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, false };
    for (int turn = 0; turn < 4; turn++) {
        bool is_cells = turn & 1;
        struct scene scene = shots_scene(plan);
        scene.surface.algorithm = is_cells ? SCENE_ALGORITHM_EIGHT_CELL : SCENE_ALGORITHM_MARCHING_CUBES;
        struct render_timing timing;
        shots_style(&scene, "box")->visible = turn < 2;
        int width_px = 0, height_px = 0;
        struct image *image = shots_take(plan, scene, view, &options, &timing);
        if (turn < 2) {
            measure_silhouette(image, &width_px, &height_px);
            assert_close(height_px, is_cells ? 190 : 200, 2);
        }
        if (turn == 2)
            assert_int_equal(timing.n_triangles, 8);
        if (turn == 3)
            assert_int_equal(timing.n_triangles, 0);
        image_destroy(image);
    }
    shots_forget(plan);
}

static void equal_snapshots_give_equal_bytes(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(80);
    struct plan *plan = made_plan(&grid, nested_label, nested, 3);
    made_plan_add_image(plan, &grid, VOXEL_I16, ramp);
    struct image *images[2];
    for (int i = 0; i < 2; i++) {
        struct scene scene = shots_scene(plan);
        shots_style(&scene, "outer")->opacity = 0.3;
        scene.image.slices.axial.visible = true;
        struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, true };
        images[i] = shots_take(plan, scene, shots_view_from(origin, vec3(0.3, -1, 0.4), up, 3), &options, NULL);
        if (i == 0) { /* another picture between the two must not change the second */
            struct image *other = shots_plain(plan, shots_scene(plan), shots_view(SCENE_KIND_CORONAL, origin, 2));
            image_destroy(other);
        }
    }
    assert_memory_equal(images[0]->rgba, images[1]->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    image_destroy(images[0]);
    image_destroy(images[1]);
    shots_forget(plan);
}

static void large_stills_have_no_seam_between_bands(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, box_label, ball, 1);
    struct view view = shots_view_from(origin, from_front, up, 1);
    view.size_px[0] = 4096; /* 4096 x 2048 pixels with 4 samples: two bands */
    view.size_px[1] = 2048;
    view.camera.height_mm = 2048 / 60.0; /* 60 pixels a millimetre: the 40 x 20 mm face */
    struct render_options options = { 4096, 2048, SURFACE_FULL, true };
    struct image *image = shots_take(plan, shots_scene(plan), view, &options, NULL);
    int width_px, height_px;
    measure_silhouette(image, &width_px, &height_px);
    assert_close(width_px, 40 * 60, 2);
    assert_close(height_px, 20 * 60, 2);
    image_destroy(image);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_near_side_of_a_ball_is_seen_lit_from_the_upper_right),
        cmocka_unit_test(translucent_surfaces_blend_from_the_inside_out),
        cmocka_unit_test(an_opaque_surface_hides_what_it_encloses),
        cmocka_unit_test(separate_translucent_surfaces_blend_by_distance_from_either_side),
        cmocka_unit_test(a_folded_translucent_surface_shows_its_front_sheet_once),
        cmocka_unit_test(silhouettes_are_as_large_as_the_projection_says),
        cmocka_unit_test(fewer_pixels_show_the_same_view),
        cmocka_unit_test(what_is_out_of_sight_is_not_drawn_and_what_is_partly_in_sight_is),
        cmocka_unit_test(every_voxel_has_the_grey_its_window_says),
        cmocka_unit_test(linear_interpolation_is_linear),
        cmocka_unit_test(what_is_not_a_number_is_not_drawn),
        cmocka_unit_test(a_slice_in_space_leaves_out_what_is_below_the_threshold),
        cmocka_unit_test(a_grid_beyond_the_drivers_limit_is_refused_with_its_size),
        cmocka_unit_test(stills_have_smooth_edges),
        cmocka_unit_test(coarse_surfaces_are_marked_and_have_fewer_triangles),
        cmocka_unit_test(the_scene_says_how_regions_become_surfaces),
        cmocka_unit_test(equal_snapshots_give_equal_bytes),
        cmocka_unit_test(large_stills_have_no_seam_between_bands),
    };
    return shots_run("pictures", tests, sizeof tests / sizeof tests[0]);
}
