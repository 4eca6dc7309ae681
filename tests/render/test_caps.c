/* Caps: each pixel shows what a ray through analytic solids and half-spaces meets, the image where that is a cut; and
 * no pixel between a cap and the surface around it shows the background. */
#include "tests/made_ragged.h"
#include "tests/render/cut_scene.h"

/* As in test_clip.c: boxes of univels are exact; balls are as round as the surface of their voxels, which 0.35 mm (1.6
 * pixels) covers. */
static const double box_margin_px = 0.1, ball_margin_px = 1.6;
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

static struct cut_counts expect_right(const struct cut_scene *cut, const struct view *view, double margin_px,
                                      bool is_still, const char *what)
{
    struct cut_counts counts = cut_scene_compare(cut, *view, margin_px, is_still);
    if (counts.n_wrong > 0 || counts.n_cracks > 0)
        fail_msg("%s: %zu of %zu pixels wrong, %zu cracks", what, counts.n_wrong, counts.n_compared, counts.n_cracks);
    assert_true(counts.n_compared > SHOTS_WIDTH * SHOTS_HEIGHT * 8 / 10); /* else the margins hide the picture */
    return counts;
}

static struct vec3 somewhere_before(struct vec3 normal)
{
    return vec3_add(normal, vec3_scale(cut_random_direction(), 0.9));
}

/* The cap of a ball of radius r cut at d is a disc of radius sqrt(r^2 - d^2); seen in parallel its area shrinks by the
 * cosine between normal and line of sight. */
static void the_cap_of_a_ball_has_the_area_of_its_disc(void **state)
{
    (void)state;
    for (int i = 0; i < 16; i++) {
        struct cut_scene cut = cut_scene_create(one_ball, 1, SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH);
        struct vec3 normal = cut_random_direction(), from = vec3_normalize(somewhere_before(normal));
        double d = 28 * cut_random() - 14, r = 21, rho = sqrt(r * r - d * d);
        cut_free(&cut.scene, normal, d, true);
        struct view view = cut_view(from, true);
        struct cut_counts counts = expect_right(&cut, &view, ball_margin_px, false, "a ball");
        double expected = MATH_PI * rho * rho * vec3_dot(normal, from) * 4.5 * 4.5;
        /* the surface of the voxels is round within 0.2 mm on average: twice that of the disc's radius */
        assert_near(counts.n_cap, expected, 0.4 / rho + 0.005);
        cut_scene_destroy(&cut);
    }
}

static void a_box_is_capped_at_any_plane(void **state)
{
    (void)state;
    for (int i = 0; i < 16; i++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        cut_free(&cut.scene, cut_random_direction(), 18 * cut_random() - 9, true);
        struct view view = cut_view(cut_random_direction(), i % 2);
        expect_right(&cut, &view, box_margin_px, false, "a box");
        cut_scene_destroy(&cut);
    }
}

/* Also with the plane exactly in faces of univels: 2 mm is one, 2.5 mm goes through their middles. */
static void a_box_is_capped_along_its_own_faces(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        cut.scene.clip.axial_high = (struct scene_clip_axis){ i < 2, 2 + 0.5 * i, true };
        cut.scene.clip.coronal_low = (struct scene_clip_axis){ i > 0, -5, true };
        struct view view = cut_view(vec3(0.6, -1, 0.8), i % 2);
        struct cut_counts counts = expect_right(&cut, &view, box_margin_px, false, "faces");
        assert_true(counts.n_cap > 3000);
        cut_scene_destroy(&cut);
    }
}

/* The plane touches the box's own upper face, or misses it by a hundredth of a millimetre: then nothing is cut. */
static void a_plane_beside_a_box_leaves_no_cap(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        cut.scene.clip.axial_high = (struct scene_clip_axis){ true, i ? 9.01 : -9.01, true };
        struct view view = cut_view(vec3(0.6, -1, 0.8), true);
        struct cut_counts counts = expect_right(&cut, &view, box_margin_px, false, "beside");
        assert_int_equal(counts.n_cap, 0);
        cut_scene_destroy(&cut);
    }
}

static void five_shells_are_closed_by_several_planes(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        struct cut_scene cut = cut_scene_create(shells, 5, SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH);
        struct scene_clip_style *clip = &cut.scene.clip;
        clip->axial_high = (struct scene_clip_axis){ i % 3 != 2, 9 * cut_random(), true };
        clip->sagittal_low = (struct scene_clip_axis){ i % 4 < 2, -9 * cut_random(), true };
        clip->coronal_low = (struct scene_clip_axis){ i % 2 == 0, -9 * cut_random(), true };
        cut_free(&cut.scene, vec3(0.5, -1, 1), 12 * cut_random(), true);
        struct view view = cut_view(somewhere_before(vec3(-0.5, -1, 1)), i % 2);
        expect_right(&cut, &view, ball_margin_px, i % 4 == 3, "shells");
        cut_scene_destroy(&cut);
    }
}

/* An octant of a box is cut out by three planes that keep the rest: nothing cuts it out, all three cut; so what is left
 * is an octant, whose three caps meet in an edge each. */
static void caps_meet_in_edges_without_a_gap(void **state)
{
    (void)state;
    for (int i = 0; i < 10; i++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        struct scene_clip_style *clip = &cut.scene.clip;
        clip->axial_high = (struct scene_clip_axis){ true, 4 * cut_random(), true };
        clip->sagittal_high = (struct scene_clip_axis){ true, 4 * cut_random(), true };
        clip->coronal_low = (struct scene_clip_axis){ true, -4 * cut_random(), true };
        if (i > 4)
            cut_free(&cut.scene, vec3(1, -1, 1), 3, true);
        struct view view = cut_view(vec3(0.7 + 0.3 * cut_random(), -1, 0.9), i % 2);
        expect_right(&cut, &view, box_margin_px, false, "an octant");
        cut_scene_destroy(&cut);
    }
}

static void overlapping_regions_are_one_body(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        struct cut_scene cut =
            cut_scene_create(overlapping, 2, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        struct vec3 normal = cut_random_direction();
        cut_free(&cut.scene, normal, 8 * cut_random() - 4, true);
        struct view view = cut_view(somewhere_before(normal), i % 2);
        expect_right(&cut, &view, box_margin_px, false, "overlapping boxes");
        cut_scene_destroy(&cut);
    }
}

static void an_exempt_region_has_no_cap(void **state)
{
    (void)state;
    struct solid solids[2];
    memcpy(solids, overlapping, sizeof solids);
    solids[1].is_exempt = true;
    size_t n_cap = 0;
    for (int i = 0; i < 4; i++) {
        struct cut_scene cut =
            cut_scene_create(solids, 2, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        struct vec3 normal = vec3(-1, 0.2 * i, 0.5);
        cut_free(&cut.scene, normal, 0.5, true);
        struct view view = cut_view(somewhere_before(normal), i % 2);
        n_cap += expect_right(&cut, &view, box_margin_px, false, "an exempt box").n_cap;
        cut_scene_destroy(&cut);
    }
    assert_true(n_cap > 4000);
}

/* The eye is inside the box: the near plane opens outlines, which must not fill the wrong side. */
static void a_cap_around_the_eye_fills_the_right_side(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        cut_free(&cut.scene, vec3(0.3, -0.4 * i, 1), -3, true);
        struct view view = cut_view(vec3(0.2, -1, 0.3 + 0.1 * i), false);
        view.camera.position_mm = vec3_scale(vec3_normalize(view.camera.position_mm), 9.5);
        expect_right(&cut, &view, box_margin_px, false, "the eye inside");
        cut_scene_destroy(&cut);
    }
}

/* The cap of a translucent region is opaque: where it is seen first, nothing is mixed with the image. */
static void the_cap_of_a_translucent_region_is_opaque(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
    cut.scene.regions[0].value.opacity = 0.3;
    cut_free(&cut.scene, vec3(0, 0, 1), 2.5, true);
    struct image *image = shots_plain(cut.plan, cut.scene, cut_view(vec3(0, 0, 1), true));
    cut.scene = shots_scene(cut.plan);
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double right = fabs(x + 0.5 - SHOTS_WIDTH / 2.0) - 12 * 4.5,
                   up = fabs(y + 0.5 - SHOTS_HEIGHT / 2.0) - 17 * 4.5;
            bool is_inside = right < 0 && up < 0;
            if (fabs(right) < 0.1 || fabs(up) < 0.1) /* the middle of a pixel on a side belongs to either */
                continue;
            const uint8_t *pixel = shots_pixel(image, x, y);
            assert_int_equal(pixel[0], is_inside ? CUT_GREY : shots_background[0]);
            assert_int_equal(pixel[2], is_inside ? CUT_GREY : shots_background[2]);
        }
    image_destroy(image);
    cut_scene_destroy(&cut);
}

/* ---- what a cap shows ------------------------------------------------------------------------------------------- */

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

/* ---- cracks ----------------------------------------------------------------------------------------------------- */

/* A ray that enters a closed surface through the cut leaves it through the surface: the same pixels are background with
 * a cap and without one, when the inside of the surface is seen. */
static void expect_no_crack(const struct cut_scene *cut, struct view view, enum surface_detail detail)
{
    struct image *images[2];
    struct render_timing timing;
    for (int i = 0; i < 2; i++) {
        struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, detail, false };
        struct scene scene;
        scene_copy(&scene, &cut->scene);
        scene.clip.free.cap = i == 0;
        images[i] = shots_take(cut->plan, scene, view, &options, &timing);
        assert_int_equal(timing.is_coarse, detail == SURFACE_COARSE);
    }
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            bool is_empty[2];
            for (int i = 0; i < 2; i++)
                is_empty[i] = memcmp(shots_pixel(images[i], x, y), shots_background, 3) == 0;
            if (is_empty[0] != is_empty[1])
                fail_msg("pixel %d, %d is background %s a cap", x, y, is_empty[0] ? "only with" : "only without");
        }
    image_destroy(images[0]);
    image_destroy(images[1]);
}

/* Also the coarse surface, which a plan of more than 80 000 triangles shows while it moves: its cap closes that one. */
static void no_pixel_between_cap_and_surface_is_left_out(void **state)
{
    (void)state;
    const uint32_t size[3] = { 112, 112, 112 };
    struct grid grid = made_grid(size[0], size[1], size[2],
                                 made_affine(vec3(0.5, 0, 0), vec3(0, 0.5, 0), vec3(0, 0, 0.5), size, vec3(0, 0, 0)));
    for (int algorithm = 0; algorithm < 3; algorithm++) {
        struct cut_scene cut = cut_scene_create_on(&grid, shells, 2, SCENE_REPRESENTATION_SURFACE,
                                                   algorithm == 0   ? SCENE_ALGORITHM_MARCHING_CUBES
                                                   : algorithm == 1 ? SCENE_ALGORITHM_SMOOTH
                                                                    : SCENE_ALGORITHM_EIGHT_CELL);
        for (int i = 0; i < 16; i++) {
            struct vec3 normal = cut_random_direction();
            cut_free(&cut.scene, normal, 20 * cut_random() - 10, true);
            expect_no_crack(&cut, cut_view(cut_random_direction(), i % 2), i % 4 < 2 ? SURFACE_COARSE : SURFACE_FULL);
        }
        cut_scene_destroy(&cut);
    }
}

/* A region with thin spikes and plates, a cavity, a tunnel, univels that touch at edges and corners, and another region
 * inside. */
static void ragged_regions_are_closed_too(void **state)
{
    (void)state;
    static const enum scene_algorithm algorithms[] = { SCENE_ALGORITHM_SMOOTH, SCENE_ALGORITHM_MARCHING_CUBES,
                                                       SCENE_ALGORITHM_EIGHT_CELL };
    struct cut_scene cut = { .plan = ragged_plan() };
    struct box3 box = cut.plan->bounds_lps_mm;
    struct vec3 middle = vec3_scale(vec3_add(box.low, box.high), 0.5);
    cut.scene = shots_scene(cut.plan);
    for (int i = 0; i < 32; i++) {
        for (size_t r = 0; r < cut.scene.n_regions; r++)
            cut.scene.regions[r].value.representation =
                i % 4 == 3 ? SCENE_REPRESENTATION_UNIVELS : SCENE_REPRESENTATION_SURFACE;
        cut.scene.surface.algorithm = algorithms[i % 4 % 3];
        struct vec3 normal = cut_random_direction();
        cut_free(&cut.scene, normal, 0, true);
        cut.scene.clip.free.origin_mm = vec3_add(middle, vec3_scale(normal, 24 * cut_random() - 12));
        struct view view = cut_view(cut_random_direction(), i % 2);
        view.camera.target_mm = vec3_add(view.camera.target_mm, middle);
        view.camera.position_mm = vec3_add(view.camera.position_mm, middle);
        expect_no_crack(&cut, view, SURFACE_FULL);
    }
    cut_scene_destroy(&cut);
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
        cmocka_unit_test(the_cap_of_a_ball_has_the_area_of_its_disc),
        cmocka_unit_test(a_box_is_capped_at_any_plane),
        cmocka_unit_test(a_box_is_capped_along_its_own_faces),
        cmocka_unit_test(a_plane_beside_a_box_leaves_no_cap),
        cmocka_unit_test(five_shells_are_closed_by_several_planes),
        cmocka_unit_test(caps_meet_in_edges_without_a_gap),
        cmocka_unit_test(overlapping_regions_are_one_body),
        cmocka_unit_test(an_exempt_region_has_no_cap),
        cmocka_unit_test(a_cap_around_the_eye_fills_the_right_side),
        cmocka_unit_test(the_cap_of_a_translucent_region_is_opaque),
        cmocka_unit_test(a_cap_shows_the_image_as_a_slice_does),
        cmocka_unit_test(a_cap_mixes_the_uppermost_regions_colour),
        cmocka_unit_test(a_cap_without_the_image_is_dark_or_coloured),
        cmocka_unit_test(a_cap_outlines_its_regions),
        cmocka_unit_test(bodies_have_caps_and_lines_have_none),
        cmocka_unit_test(no_pixel_between_cap_and_surface_is_left_out),
        cmocka_unit_test(ragged_regions_are_closed_too),
        cmocka_unit_test(threads_and_processors_do_not_change_a_capped_picture),
    };
    return shots_run_soft("caps", tests, sizeof tests / sizeof tests[0]);
}
