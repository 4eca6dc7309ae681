/* Contents of caps: the image, colours and outlines of regions; and which representations have one. */
#include "tests/render/cut_scene.h"

static const struct solid one_box[] = { { .is_box = true, .half_mm = { 12, 17, 9 }, .rgb = 0xff3030 } };
static const struct solid one_ball[] = { { .radius_mm = 21, .rgb = 0xff3030 } };
static const struct solid shells[] = {
    { .radius_mm = 25, .rgb = 0xff3030 },
    { .radius_mm = 20, .rgb = 0x30ff30 },
    { .radius_mm = 15, .rgb = 0x3030ff },
    { .centre_mm = { 4, 3, 2 }, .radius_mm = 8, .rgb = 0xffff20 },
    { .centre_mm = { 4, 3, 2 }, .radius_mm = 4, .rgb = 0x20ffff },
};
/* Neither lies in the other; each on a layer of its own. */
static const struct solid overlapping[] = {
    { .is_box = true, .centre_mm = { -6, 0, 0 }, .half_mm = { 14, 13, 12 }, .rgb = 0xff3030 },
    { .is_box = true, .centre_mm = { 7, 3, -2 }, .half_mm = { 13, 12, 15 }, .rgb = 0x30ff30 },
};

static struct vec3 somewhere_before(struct vec3 normal)
{
    return vec3_add(normal, vec3_scale(cut_random_direction(), 0.9));
}

/* Values that differ from voxel to voxel, by a hash of the place. */
static double rough(struct vec3 p)
{
    double wave = sin(12.9898 * p.x + 78.233 * p.y + 37.719 * p.z) * 43758.5453;
    return floor(200 * (wave - floor(wave))) + 20;
}

static bool seen_dark(const uint8_t *pixel)
{
    return pixel[0] == 0x14 && pixel[1] == 0x12 && pixel[2] == 0x0f;
}

/* A turned grid of 1.4 x 1.9 x 1.1 mm that holds a part of the solids only. */
static void take_rough_image(struct cut_scene *cut)
{
    const uint32_t size[3] = { 24, 18, 30 };
    double c = cos(0.3), s = sin(0.3);
    struct grid grid = made_grid(size[0], size[1], size[2],
                                 made_affine(vec3(1.4 * c, 0, 1.4 * s), vec3(0, -1.9, 0), vec3(-1.1 * s, 0, 1.1 * c),
                                             size, vec3(1, 2, -1)));
    made_plan_add_image(cut->plan, &grid, VOXEL_U8, rough);
    snprintf(cut->scene.image.id, sizeof cut->scene.image.id, "%s", cut->plan->images[1].id);
    cut->scene.image.window.center = 120;
    cut->scene.image.window.width = 256;
}

/* Nearest and linear, at random planes: the pixels of a cap are those of a slice in the same plane, which test_planes
 * compares with the grid; dark where the grid ends. Both in one picture show no fight. */
static void a_cap_shows_the_image_as_a_slice_does(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct cut_scene cut = cut_scene_create(one_ball, 1, SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH);
        take_rough_image(&cut);
        cut.scene.image.interpolation = i % 2 ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
        cut.scene.image.low_values = i % 3 ? SCENE_LOW_VALUES_BLACK : SCENE_LOW_VALUES_WHITE;
        struct vec3 normal = cut_random_direction();
        struct view view = cut_view(somewhere_before(normal), i / 2 % 2);
        cut_free(&cut.scene, normal, 3, true);
        cut.scene.image.obliques = mem_new(sizeof *cut.scene.image.obliques);
        cut.scene.image.n_obliques = 1;
        cut.scene.image.obliques[0].value =
            (struct scene_oblique){ .origin_mm = vec3_scale(normal, 3), .normal = normal };
        struct image *images[3]; /* cap, slice, both */
        for (int k = 0; k < 3; k++) {
            struct scene scene;
            scene_copy(&scene, &cut.scene);
            scene.clip.free.enabled = k != 1;
            scene.image.obliques[0].value.visible = k > 0;
            scene.regions[0].value.visible = k != 1;
            images[k] = shots_plain(cut.plan, scene, view);
        }
        size_t n_image = 0, n_dark = 0, n_both = 0, n_off = 0, n_outside = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                const uint8_t *cap = shots_pixel(images[0], x, y), *slice = shots_pixel(images[1], x, y),
                              *both = shots_pixel(images[2], x, y);
                bool is_grey = cap[0] == cap[1] && cap[1] == cap[2] && memcmp(cap, shots_background, 3) != 0;
                bool has_slice = memcmp(slice, shots_background, 3) != 0;
                n_dark += seen_dark(cap);
                n_outside += seen_dark(cap) && has_slice;
                n_image += is_grey && has_slice;
                n_off += is_grey && has_slice && abs(cap[0] - slice[0]) > 1;
                n_both += (is_grey && has_slice) && memcmp(cap, both, 3) != 0;
            }
        assert_true(n_image > 4000 && n_dark > 500);
        /* nearest: a sample between two voxels may fall to either, as the planes' axes differ and round differently */
        assert_true(n_off <= n_image / 500);
        assert_int_equal(n_both, 0);
        assert_true(n_outside <= n_dark / 100); /* at the grid's very border */
        for (int k = 0; k < 3; k++)
            image_destroy(images[k]);
        cut_scene_destroy(&cut);
    }
}

/* 35 % of the uppermost region's colour: the inner of nested ones, the one of the higher order where they overlap. */
static void a_cap_mixes_the_uppermost_regions_colour(void **state)
{
    (void)state;
    for (int order = -1; order <= 1; order += 2) {
        struct cut_scene cut =
            cut_scene_create(overlapping, 2, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        cut.scene.clip.cap.regions = true;
        cut.scene.regions[0].value.order = order;
        cut_free(&cut.scene, vec3(0, 0, 1), 1.3, true);
        struct image *image = shots_plain(cut.plan, cut.scene, cut_view(vec3(0, 0, 1), true)); /* right L, up P */
        cut.scene = shots_scene(cut.plan);
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                double l = (x + 0.5 - SHOTS_WIDTH / 2.0) / 4.5, p = (SHOTS_HEIGHT / 2.0 - y - 0.5) / 4.5;
                bool is_in[2], is_on_side = false;
                for (int k = 0; k < 2; k++) {
                    double beyond_l = fabs(l - overlapping[k].centre_mm.x) - overlapping[k].half_mm.x;
                    double beyond_p = fabs(p - overlapping[k].centre_mm.y) - overlapping[k].half_mm.y;
                    is_in[k] = beyond_l < 0 && beyond_p < 0;
                    is_on_side |= fabs(beyond_l) < 0.02 || fabs(beyond_p) < 0.02;
                }
                if (is_on_side)
                    continue;
                const uint8_t *pixel = shots_pixel(image, x, y);
                int top = is_in[0] && is_in[1] ? (order > 0 ? 0 : 1) : is_in[1];
                for (int c = 0; c < 3; c++) {
                    double color = overlapping[top].rgb >> (16 - 8 * c) & 255;
                    assert_close(pixel[c], is_in[0] || is_in[1] ? 0.65 * CUT_GREY + 0.35 * color : shots_background[c],
                                 1.5);
                }
            }
        image_destroy(image);
        cut_scene_destroy(&cut);
    }
}

/* Without the image a cap is dark, and its colours are the regions' own. */
static void a_cap_without_the_image_is_dark_or_coloured(void **state)
{
    (void)state;
    for (int has_colors = 0; has_colors < 2; has_colors++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        cut.scene.clip.cap.image = false;
        cut.scene.clip.cap.regions = has_colors;
        cut_free(&cut.scene, vec3(0, 0, 1), 1.3, true);
        struct image *image = shots_plain(cut.plan, cut.scene, cut_view(vec3(0, 0, 1), true));
        cut.scene = shots_scene(cut.plan);
        const uint8_t *pixel = shots_pixel(image, SHOTS_WIDTH / 2, SHOTS_HEIGHT / 2);
        const uint8_t expected[2][3] = { { 0x14, 0x12, 0x0f }, { 0xff, 0x30, 0x30 } };
        for (int c = 0; c < 3; c++)
            assert_int_equal(pixel[c], expected[has_colors][c]);
        image_destroy(image);
        cut_scene_destroy(&cut);
    }
}

/* The border of a box's cap is a rectangle: its pixels within half a line's width of it have the region's colour. */
static void a_cap_outlines_its_regions(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
    cut.scene.clip.cap.outlines = true;
    cut_free(&cut.scene, vec3(0, 0, 1), 1.3, true);
    struct image *image = shots_plain(cut.plan, cut.scene, cut_view(vec3(0, 0, 1), true));
    cut.scene = shots_scene(cut.plan);
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double right = fabs(x + 0.5 - SHOTS_WIDTH / 2.0) - 12 * 4.5,
                   up = fabs(y + 0.5 - SHOTS_HEIGHT / 2.0) - 17 * 4.5;
            double beyond = fmax(right, up); /* of the border, in pixels */
            const uint8_t *pixel = shots_pixel(image, x, y);
            if (fabs(beyond) < 0.4)
                assert_true(pixel[0] == 0xff && pixel[1] == 0x30 && pixel[2] == 0x30);
            else if (beyond < -1.2)
                assert_int_equal(pixel[1], CUT_GREY);
            else if (beyond > 1.2)
                assert_int_equal(pixel[1], shots_background[1]);
        }
    image_destroy(image);
    cut_scene_destroy(&cut);
}

/* ---- representations -------------------------------------------------------------------------------------------- */

/* Surface, univels, nurbs and solid points are bodies; outlines, points and the fan are not. The cap's border is the
 * shape's own: a univels cap has the area of whole univels. */
static void bodies_have_caps_and_lines_have_none(void **state)
{
    (void)state;
    for (int r = 0; r <= SCENE_REPRESENTATION_FAN; r++) {
        enum scene_representation kind = (enum scene_representation)r;
        struct cut_scene cut = cut_scene_create(one_ball, 1, kind, SCENE_ALGORITHM_SMOOTH);
        cut.scene.clip.axial_high = (struct scene_clip_axis){ true, 0.25, true };
        struct image *image = shots_plain(cut.plan, cut.scene, cut_view(vec3(0, 0, 1), true));
        cut.scene = shots_scene(cut.plan);
        size_t n_cap = 0, n_univels = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                const uint8_t *pixel = shots_pixel(image, x, y);
                n_cap += pixel[0] == CUT_GREY && pixel[1] == CUT_GREY && pixel[2] == CUT_GREY;
            }
        for (int j = -28; j < 28; j++) /* univels of the slice at S 0.5 mm */
            for (int i = -28; i < 28; i++)
                n_univels += vec3_length(vec3(i + 0.5, j + 0.5, 0.5)) < 21;
        bool is_body = kind == SCENE_REPRESENTATION_SURFACE || kind == SCENE_REPRESENTATION_UNIVELS ||
                       kind == SCENE_REPRESENTATION_NURBS || kind == SCENE_REPRESENTATION_SOLID;
        if (!is_body)
            assert_int_equal(n_cap, 0);
        else if (kind == SCENE_REPRESENTATION_UNIVELS) /* borders of univels on borders of pixels round either way */
            assert_near(n_cap, (double)n_univels * 4.5 * 4.5, 0.003);
        else /* the disc; nurbs are fitted to traces through the outermost univels: half a univel less */
            assert_near(n_cap, MATH_PI * 21 * 21 * 4.5 * 4.5, kind == SCENE_REPRESENTATION_NURBS ? 0.1 : 0.03);
        image_destroy(image);
        cut_scene_destroy(&cut);
    }
}

static void threads_and_processors_do_not_change_a_capped_picture(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(shells, 5, SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH);
    take_rough_image(&cut);
    cut.scene.clip.cap.regions = cut.scene.clip.cap.outlines = true;
    cut.scene.clip.coronal_low = (struct scene_clip_axis){ true, -3, true };
    cut_free(&cut.scene, vec3(0.5, -1, 1), 4, true);
    struct image *first = NULL;
    for (int way = 0; way < 4; way++) {
        struct scene scene;
        scene_copy(&scene, &cut.scene);
        renderer_tune(shots_renderer, way % 2 ? 3 : 1, way / 2);
        struct image *image = shots_plain(cut.plan, scene, cut_view(vec3(-0.2, -1, 1), false));
        if (first)
            assert_memory_equal(first->rgba, image->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        if (first)
            image_destroy(image);
        else
            first = image;
    }
    renderer_tune(shots_renderer, 2, false);
    image_destroy(first);
    cut_scene_destroy(&cut);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cap_shows_the_image_as_a_slice_does),
        cmocka_unit_test(a_cap_mixes_the_uppermost_regions_colour),
        cmocka_unit_test(a_cap_without_the_image_is_dark_or_coloured),
        cmocka_unit_test(a_cap_outlines_its_regions),
        cmocka_unit_test(bodies_have_caps_and_lines_have_none),
        cmocka_unit_test(threads_and_processors_do_not_change_a_capped_picture),
    };
    return shots_run_soft("looks of caps", tests, sizeof tests / sizeof tests[0]);
}
