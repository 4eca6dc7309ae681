/* Caps: each pixel shows what a ray through analytic solids and half-spaces meets, the image where that is a cut; and
 * no pixel between a cap and the surface around it shows the background. */
#include "tests/made_ragged.h"
#include "tests/render/cut_scene.h"

/* Margins of test_clip.c: boxes of univels are exact; balls are as round as the surface of their voxels, which 0.35 mm
 * (1.6 pixels) covers. */
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

/* Planes a hundredth of a millimetre above and below the box: nothing of it is cut, or all. */
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

/* Three planes leave an octant of the box, a fourth one cuts its corner off: caps meet each other in edges. */
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
        cmocka_unit_test(no_pixel_between_cap_and_surface_is_left_out),
        cmocka_unit_test(ragged_regions_are_closed_too),
    };
    return shots_run_soft("caps", tests, sizeof tests / sizeof tests[0]);
}
