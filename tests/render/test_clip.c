/* Clip planes on shapes and slices: each pixel shows what a ray through analytic solids and half-spaces meets. */
#include "tests/render/cut_scene.h"

/* Boxes end at faces of voxels: their surfaces are exact, and a pixel is compared up to a tenth of its side from any
 * edge. Balls are as round as the surface of their voxels. */
static const double box_margin_px = 0.1, ball_margin_px = 1.6;
static const struct solid one_box[] = { { .is_box = true, .half_mm = { 12, 17, 9 }, .rgb = 0xff3030 } };
static const struct solid three_boxes[] = {
    { .is_box = true, .half_mm = { 20, 21, 19 }, .rgb = 0xff3030 },
    { .is_box = true, .centre_mm = { 2, 1, -1 }, .half_mm = { 14, 13, 15 }, .rgb = 0x30ff30 },
    { .is_box = true, .centre_mm = { 3, 0, -2 }, .half_mm = { 6, 7, 5 }, .rgb = 0x3030ff },
};
static const struct solid two_balls[] = { { .radius_mm = 22, .rgb = 0xff3030 },
                                          { .centre_mm = { 3, -2, 4 }, .radius_mm = 12, .rgb = 0x30ff30 } };

static void expect_right(const struct cut_scene *cut, const struct view *view, double margin_px, const char *what)
{
    struct cut_counts counts = cut_scene_compare(cut, *view, margin_px, false);
    if (counts.n_wrong > 0 || counts.n_cracks > 0)
        fail_msg("%s: %zu of %zu pixels wrong, %zu cracks", what, counts.n_wrong, counts.n_compared, counts.n_cracks);
    assert_true(counts.n_compared > SHOTS_WIDTH * SHOTS_HEIGHT * 8 / 10); /* else the margins hide the picture */
}

static void an_open_box_is_cut_where_the_plane_is(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        struct cut_scene cut =
            cut_scene_create(one_box, 1, i % 2 ? SCENE_REPRESENTATION_UNIVELS : SCENE_REPRESENTATION_SURFACE,
                             SCENE_ALGORITHM_MARCHING_CUBES);
        cut_free(&cut.scene, cut_random_direction(), 16 * cut_random() - 8, false);
        struct view view = cut_view(cut_random_direction(), i / 2 % 2);
        /* marching cubes round the box's edges by half a voxel, 2.25 pixels */
        expect_right(&cut, &view, i % 2 ? box_margin_px : 2.5, "a box");
        cut_scene_destroy(&cut);
    }
}

static void nested_shells_are_seen_through_the_cut(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        struct cut_scene cut =
            cut_scene_create(three_boxes, 3, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        struct vec3 normal = cut_random_direction();
        cut_free(&cut.scene, normal, 10 * cut_random() - 5, false);
        struct view view = cut_view(vec3_add(normal, vec3_scale(cut_random_direction(), 0.8)), i % 2);
        expect_right(&cut, &view, box_margin_px, "boxes");
        cut_scene_destroy(&cut);
    }
}

static void several_planes_leave_a_wedge_or_an_octant(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct cut_scene cut =
            cut_scene_create(three_boxes, 3, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        struct scene_clip_style *clip = &cut.scene.clip;
        clip->axial_high = (struct scene_clip_axis){ true, 0.3 + i, false };
        clip->sagittal_high = (struct scene_clip_axis){ i > 0, 1.2, false };
        clip->coronal_low = (struct scene_clip_axis){ i > 1, -3.4, false };
        clip->axial_low = (struct scene_clip_axis){ i > 3, -12.1, false };
        if (i > 4)
            cut_free(&cut.scene, vec3(1, -1, 2), 2, false);
        struct view view = cut_view(vec3(1, -1.2, 0.8), i % 2);
        expect_right(&cut, &view, box_margin_px, "several planes");
        cut_scene_destroy(&cut);
    }
}

static void an_exempt_region_is_whole_before_the_cut(void **state)
{
    (void)state;
    struct solid solids[3];
    memcpy(solids, three_boxes, sizeof solids);
    solids[1].is_exempt = true;
    for (int i = 0; i < 4; i++) {
        struct cut_scene cut =
            cut_scene_create(solids, 3, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
        struct vec3 normal = cut_random_direction();
        cut_free(&cut.scene, normal, -2, i % 2);
        struct view view = cut_view(normal, i / 2);
        expect_right(&cut, &view, box_margin_px, "an exempt box");
        cut_scene_destroy(&cut);
    }
}

static void balls_are_cut_by_random_planes(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        struct cut_scene cut = cut_scene_create(two_balls, 2, SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH);
        struct vec3 normal = cut_random_direction();
        cut_free(&cut.scene, normal, 20 * cut_random() - 10, false);
        struct view view = cut_view(vec3_add(normal, cut_random_direction()), i % 2);
        expect_right(&cut, &view, ball_margin_px, "balls");
        cut_scene_destroy(&cut);
    }
}

/* A plane through the middle of the outermost points' voxels leaves those whose centre is below it. */
static void points_are_cut_by_their_centre(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(one_box, 1, SCENE_REPRESENTATION_POINTS, SCENE_ALGORITHM_MARCHING_CUBES);
    struct view view = cut_view(vec3(0, -1, 0), true); /* from the front: S is up, the box 24 x 18 mm */
    cut.scene.points.size_px = 1;
    for (int row = 0; row < 18; row++) {
        struct scene scene;
        scene_copy(&scene, &cut.scene);
        scene.clip.axial_high = (struct scene_clip_axis){ true, row - 8.0, false }; /* centres are at halves */
        struct image *image = shots_plain(cut.plan, scene, view);
        size_t n = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++)
                n += memcmp(shots_pixel(image, x, y), shots_background, 3) != 0;
        assert_int_equal(n, 24 * (row + 1)); /* 4.5 pixels apart: each its own pixel; those behind lie behind */
        image_destroy(image);
    }
    cut_scene_destroy(&cut);
}

/* Lines around each axial slice of the box, in one plane each: a coronal plane cuts the upper and lower sides. */
static void outlines_are_cut_where_the_plane_is(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(one_box, 1, SCENE_REPRESENTATION_OUTLINE, SCENE_ALGORITHM_MARCHING_CUBES);
    struct view view = cut_view(vec3(0, 0, 1), true);
    view.camera.up = vec3(0, -1, 0);
    for (int i = 0; i < 6; i++) {
        double cut_mm = -10.3 + 4 * i;
        struct scene scene;
        scene_copy(&scene, &cut.scene);
        scene.clip.coronal_high = (struct scene_clip_axis){ true, cut_mm, false };
        struct image *image = shots_plain(cut.plan, scene, view);
        double lowest = -INFINITY, highest = INFINITY;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++)
                if (memcmp(shots_pixel(image, x, y), shots_background, 3) != 0) {
                    lowest = fmax(lowest, (y + 0.5 - SHOTS_HEIGHT / 2.0) / 4.5);
                    highest = fmin(highest, (y + 0.5 - SHOTS_HEIGHT / 2.0) / 4.5);
                }
        assert_close(lowest, cut_mm, 1.5 / 4.5);     /* half a line's width beyond its end, and half a pixel */
        assert_close(highest, -17, 0.5 + 1.5 / 4.5); /* outlines run through centres or sides of the voxels */
        image_destroy(image);
    }
    cut_scene_destroy(&cut);
}

/* A slice shows its part below the plane; of a slice in the plane itself all. */
static void slices_are_cut_where_the_plane_is(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(one_box, 1, SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH);
    cut.scene.regions[0].value.visible = false;
    cut.scene.image.slices.axial.visible = true;
    cut.scene.image.slices.axial.position_mm = 3;
    struct view view = cut_view(vec3(0, 0, 1), true);
    for (int i = 0; i < 8; i++) {
        struct vec3 normal = cut_random_direction();
        double distance_mm = 20 * cut_random() - 10;
        struct scene scene;
        scene_copy(&scene, &cut.scene);
        bool is_same = i == 0;
        cut_free(&scene, is_same ? vec3(0, 0, 7) : normal, is_same ? 3 : distance_mm, i % 2);
        struct image *image = shots_plain(cut.plan, scene, view);
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                /* from above, up is P: right is L */
                struct vec3 p = vec3((x + 0.5 - SHOTS_WIDTH / 2.0) / 4.5, (SHOTS_HEIGHT / 2.0 - y - 0.5) / 4.5, 3);
                double height_mm = is_same ? -1 : vec3_dot(p, normal) - distance_mm;
                bool is_in_grid = fabs(p.x) < 28 && fabs(p.y) < 28;
                if (fabs(height_mm) > 1e-6)
                    assert_int_equal(shots_pixel(image, x, y)[0] == CUT_GREY, is_in_grid && height_mm < 0);
            }
        image_destroy(image);
    }
    cut_scene_destroy(&cut);
}

/* A part that is cut off does not count in the picture of the rest: the cut of a translucent shell lets the background
 * through. */
static void a_translucent_shell_is_cut_too(void **state)
{
    (void)state;
    struct cut_scene cut = cut_scene_create(one_box, 1, SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES);
    cut.scene.regions[0].value.opacity = 0.5;
    cut_free(&cut.scene, vec3(1, 0, 0), 2.3, false); /* what is left of it: L -12 .. 2.3 */
    struct image *image = shots_plain(cut.plan, cut.scene, cut_view(vec3(0, -1, 0), true));
    cut.scene = shots_scene(cut.plan);
    for (int x = 0; x < SHOTS_WIDTH; x++) {
        double left_mm = (x + 0.5 - SHOTS_WIDTH / 2.0) / 4.5;
        bool is_there = memcmp(shots_pixel(image, x, SHOTS_HEIGHT / 2), shots_background, 3) != 0;
        assert_int_equal(is_there, left_mm > -12 && left_mm < 2.3);
    }
    image_destroy(image);
    cut_scene_destroy(&cut);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_open_box_is_cut_where_the_plane_is),
        cmocka_unit_test(nested_shells_are_seen_through_the_cut),
        cmocka_unit_test(several_planes_leave_a_wedge_or_an_octant),
        cmocka_unit_test(an_exempt_region_is_whole_before_the_cut),
        cmocka_unit_test(balls_are_cut_by_random_planes),
        cmocka_unit_test(points_are_cut_by_their_centre),
        cmocka_unit_test(outlines_are_cut_where_the_plane_is),
        cmocka_unit_test(slices_are_cut_where_the_plane_is),
        cmocka_unit_test(a_translucent_shell_is_cut_too),
    };
    return shots_run_soft("clip planes", tests, sizeof tests / sizeof tests[0]);
}
