/* Left is left: a plan with marks on the patient's left, front and top is drawn from known directions. Where each mark
 * must appear follows from the definitions of patient axes and views. */
#include "tests/render/shots.h"

static const struct vec3 centre = { 5, -7, 11 }; /* off the origin, so that a mirrored axis cannot go unnoticed */
enum { LEFT_MM = 18, FRONT_MM = 22, TOP_MM = 20, MARK_RADIUS_MM = 7, PIXELS_PER_MM = 4 };

static bool is_near(struct vec3 p, double x, double y, double z)
{
    return vec3_length(vec3_sub(p, vec3_add(centre, vec3(x, y, z)))) <= MARK_RADIUS_MM;
}

/* 1 left (red), 2 front (green), 3 top (blue) */
static double mark_label(struct vec3 p)
{
    return is_near(p, LEFT_MM, 0, 0) ? 1 : is_near(p, 0, -FRONT_MM, 0) ? 2 : is_near(p, 0, 0, TOP_MM) ? 3 : 0;
}

/* The same marks as grey values: 0 elsewhere */
static double mark_value(struct vec3 p)
{
    return is_near(p, LEFT_MM, 0, 0)     ? 1000
           : is_near(p, 0, -FRONT_MM, 0) ? 500
           : is_near(p, 0, 0, TOP_MM)    ? 250
                                         : -1000;
}

static const struct made_region marks[] = { { "left", -1, 0xff0000 },
                                            { "front", -1, 0x00ff00 },
                                            { "top", -1, 0x0000ff } };

/* Anisotropic voxels in three orders: the patient's own axes, left-handed (to the Left, Anterior, Superior), and
 * oblique. */
static struct grid marked_grid(int kind)
{
    const uint32_t size[3] = { 80, 50, 40 };
    double c = cos(0.5), s = sin(0.5);
    struct affine map = made_affine(vec3(1, 0, 0), vec3(0, 1.5, 0), vec3(0, 0, 2), size, centre);
    if (kind == 1)
        map = made_affine(vec3(1, 0, 0), vec3(0, -1.5, 0), vec3(0, 0, 2), size, centre);
    if (kind == 2)
        map = made_affine(vec3(c, s, 0), vec3(-1.5 * s * c, 1.5 * c * c, 1.5 * s), vec3(2 * s * s, -2 * s * c, 2 * c),
                          size, centre);
    return made_grid(size[0], size[1], size[2], map);
}

/* The mark's mean position must be where its middle projects. Voxels of up to 2 mm move it by less than half a voxel.
 */
static void expect_mark(const struct image *image, int channel, double right_mm, double up_mm)
{
    double x, y;
    size_t n = shots_centroid(image, channel, &x, &y);
    double disc_px = MATH_PI * MARK_RADIUS_MM * MARK_RADIUS_MM * PIXELS_PER_MM * PIXELS_PER_MM;
    assert_near(n, disc_px, 0.25);
    assert_close(x, SHOTS_WIDTH / 2.0 + right_mm * PIXELS_PER_MM, PIXELS_PER_MM);
    assert_close(y, SHOTS_HEIGHT / 2.0 - up_mm * PIXELS_PER_MM, PIXELS_PER_MM);
}

static void surfaces_from_the_front_have_the_patients_left_on_screen_right(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        struct image *image =
            shots_plain(plan, shots_scene(plan), shots_view_from(centre, vec3(0, -1, 0), vec3(0, 0, 1), PIXELS_PER_MM));
        expect_mark(image, 0, LEFT_MM, 0);
        expect_mark(image, 1, 0, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

static void surfaces_from_the_left_have_the_front_on_screen_left(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        struct image *image =
            shots_plain(plan, shots_scene(plan), shots_view_from(centre, vec3(1, 0, 0), vec3(0, 0, 1), PIXELS_PER_MM));
        expect_mark(image, 0, 0, 0);
        expect_mark(image, 1, -FRONT_MM, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

static void a_view_without_camera_is_from_the_front_with_the_head_up(void **state)
{
    (void)state;
    struct grid grid = marked_grid(0);
    struct plan *plan = made_plan(&grid, mark_label, marks, 3);
    struct view view = view_default;
    struct image *image = shots_plain(plan, shots_scene(plan), view);
    double x, y;
    assert_true(shots_centroid(image, 0, &x, &y) > 0);
    assert_true(x > 512 + 50);
    assert_close(y, 384, 20);
    assert_true(shots_centroid(image, 2, &x, &y) > 0);
    assert_true(y < 384 - 50);
    assert_close(x, 512, 20);
    image_destroy(image);
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

static struct scene centred_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    scene.image.slices.axial.position_mm = centre.z;
    scene.image.slices.coronal.position_mm = centre.y;
    scene.image.slices.sagittal.position_mm = centre.x;
    return scene;
}

static void cross_sections_of_regions_lie_as_the_panes_say(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        struct image *image =
            shots_plain(plan, centred_scene(plan), shots_view(SCENE_KIND_AXIAL, centre, PIXELS_PER_MM));
        expect_mark(image, 0, LEFT_MM, 0);
        expect_mark(image, 1, 0, FRONT_MM);
        image_destroy(image);
        image = shots_plain(plan, centred_scene(plan), shots_view(SCENE_KIND_CORONAL, centre, PIXELS_PER_MM));
        expect_mark(image, 0, LEFT_MM, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        image = shots_plain(plan, centred_scene(plan), shots_view(SCENE_KIND_SAGITTAL, centre, PIXELS_PER_MM));
        expect_mark(image, 1, -FRONT_MM, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

/* Image panes are grey: window 500 +- 500 shows the left mark white, the front mark mid grey, the top mark at 250 of
 * 1000. */
static void expect_grey(const struct image *image, double right_mm, double up_mm, int grey)
{
    int x = (int)floor(SHOTS_WIDTH / 2.0 + right_mm * PIXELS_PER_MM),
        y = (int)floor(SHOTS_HEIGHT / 2.0 - up_mm * PIXELS_PER_MM);
    const uint8_t *p = shots_pixel(image, x, y);
    for (int c = 0; c < 3; c++)
        assert_close(p[c], fmax(grey, shots_background[c]), 1); /* black is the background */
    assert_int_equal(p[3], 255);
}

static struct image *image_pane(struct plan *plan, enum scene_kind kind)
{
    struct scene scene = centred_scene(plan);
    scene.image.window.center = 500;
    scene.image.window.width = 1000;
    return shots_plain(plan, scene, shots_view(kind, centre, PIXELS_PER_MM));
}

static void image_slices_lie_as_the_panes_say(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        made_plan_add_image(plan, &grid, VOXEL_I16, mark_value);
        struct image *image = image_pane(plan, SCENE_KIND_AXIAL);
        expect_grey(image, LEFT_MM, 0, 255);
        expect_grey(image, -LEFT_MM, 0, 0);
        expect_grey(image, 0, FRONT_MM, 128);
        expect_grey(image, 0, -FRONT_MM, 0);
        image_destroy(image);
        image = image_pane(plan, SCENE_KIND_CORONAL);
        expect_grey(image, LEFT_MM, 0, 255);
        expect_grey(image, 0, TOP_MM, 64);
        expect_grey(image, 0, -TOP_MM, 0);
        image_destroy(image);
        image = image_pane(plan, SCENE_KIND_SAGITTAL);
        expect_grey(image, -FRONT_MM, 0, 128);
        expect_grey(image, FRONT_MM, 0, 0);
        expect_grey(image, 0, TOP_MM, 64);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

static void an_axial_slice_in_space_seen_from_above_has_the_left_on_screen_left(void **state)
{
    (void)state;
    struct grid grid = marked_grid(1);
    struct plan *plan = made_plan(&grid, mark_label, marks, 0);
    made_plan_add_image(plan, &grid, VOXEL_I16, mark_value);
    struct scene scene = centred_scene(plan);
    scene.image.slices.axial.visible = true;
    scene.image.window.center = 500;
    scene.image.window.width = 1000;
    struct image *image =
        shots_plain(plan, scene, shots_view_from(centre, vec3(0, 0, 1), vec3(0, -1, 0), PIXELS_PER_MM));
    expect_grey(image, -LEFT_MM, 0, 255);
    expect_grey(image, LEFT_MM, 0, 0);
    expect_grey(image, 0, FRONT_MM, 128);
    expect_grey(image, 0, -FRONT_MM, 0);
    image_destroy(image);
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_from_the_front_have_the_patients_left_on_screen_right),
        cmocka_unit_test(surfaces_from_the_left_have_the_front_on_screen_left),
        cmocka_unit_test(a_view_without_camera_is_from_the_front_with_the_head_up),
        cmocka_unit_test(cross_sections_of_regions_lie_as_the_panes_say),
        cmocka_unit_test(image_slices_lie_as_the_panes_say),
        cmocka_unit_test(an_axial_slice_in_space_seen_from_above_has_the_left_on_screen_left),
    };
    return shots_run("orientation", tests, sizeof tests / sizeof tests[0]);
}
