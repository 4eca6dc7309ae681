/* Planes in any direction: what a pane, a slice in space, an outline and a pick show on an oblique plane is what
 * evaluating the grid at each pixel's point gives. */
#include "core/pick/pick.h"
#include "tests/render/shots.h"

static const double pixels_per_mm = 6;

/* Through a point off every grid's middle, turned about two axes. */
static struct plane oblique_plane(void)
{
    double a = 0.5, b = 0.35;
    struct vec3 right = vec3(cos(a), sin(a), 0), up = vec3(-sin(a) * sin(b), cos(a) * sin(b), cos(b));
    return (struct plane){ vec3(2.3, -1.7, 0.9), right, up, vec3_cross(right, up) };
}

/* Voxels of 1.6 x 2.1 x 1.3 mm, turned, the second axis backwards. */
static struct grid turned_grid(void)
{
    const uint32_t size[3] = { 24, 18, 30 };
    double c = cos(0.3), s = sin(0.3);
    return made_grid(size[0], size[1], size[2],
                     made_affine(vec3(1.6 * c, 0, 1.6 * s), vec3(0, -2.1, 0), vec3(-1.3 * s, 0, 1.3 * c), size,
                                 vec3(1, 2, -1)));
}

/* Values that differ from voxel to voxel: 0 .. 255, by a hash of the place. */
static double rough(struct vec3 p)
{
    double wave = sin(12.9898 * p.x + 78.233 * p.y + 37.719 * p.z) * 43758.5453;
    return floor(256 * (wave - floor(wave)));
}

static double label_of_octant(struct vec3 p)
{
    return 1 + (p.x > 1) + 2 * (p.y > -0.5);
}
static const struct made_region quarters[] = {
    { "a", -1, 0xff3030 }, { "b", -1, 0x30ff60 }, { "c", -1, 0x3060ff }, { "d", -1, 0xe0d020 }
};

/* A snapshot whose pane, and whose one slice in space, are the plane. */
static struct snapshot *snapshot_on(struct plan *plan, struct scene scene, struct view view, const struct plane *plane)
{
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    snapshot->pane = snapshot->slices[0] = *plane;
    snapshot->n_slices = 1;
    return snapshot;
}

static struct image *picture_of(const struct snapshot *snapshot)
{
    struct error err = { 0 };
    struct camera camera;
    struct render_timing timing;
    struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, false };
    struct image *image = render_snapshot(shots_renderer, snapshot, &options, &camera, &timing, &err);
    assert_string_equal(err.text, "");
    return image;
}

/* The patient point at the middle of a pixel: the plane's origin is in the middle of the picture. */
static struct vec3 point_of_pixel(const struct plane *plane, int x, int y)
{
    double right = (x + 0.5 - SHOTS_WIDTH / 2.0) / pixels_per_mm, up = (SHOTS_HEIGHT / 2.0 - y - 0.5) / pixels_per_mm;
    const struct vec3 *o = &plane->origin_lps_mm, *r = &plane->right, *u = &plane->up;
    return vec3(o->x + right * r->x + up * u->x, o->y + right * r->y + up * u->y, o->z + right * r->z + up * u->z);
}

/* Index coordinates, and how far inside the grid's outer faces, in voxels. */
static double inside_grid(const struct grid *grid, struct vec3 p, double ijk[3])
{
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, p);
    double least = INFINITY;
    ijk[0] = at.x;
    ijk[1] = at.y;
    ijk[2] = at.z;
    for (int a = 0; a < 3; a++)
        least = fmin(least, fmin(ijk[a] + 0.5, grid->size[a] - 0.5 - ijk[a]));
    return least;
}

/* Tri-linear between voxel centres, clamped to the outermost ones: the sum over eight voxels, each weighted by how near
 * it is. */
static double linear_value(const struct volume *volume, const double ijk[3])
{
    double sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        uint32_t at[3];
        double weight = 1;
        for (int a = 0; a < 3; a++) {
            double last = volume->grid.size[a] - 1.0, place = fmin(fmax(ijk[a], 0), last), low = floor(place);
            bool is_high = corner >> a & 1;
            weight *= is_high ? place - low : 1 - (place - low);
            at[a] = (uint32_t)fmin(low + is_high, last);
        }
        sum += weight * volume_value(volume, at[0], at[1], at[2]);
    }
    return sum;
}

/* Half a level of rounding, and single precision. */
static const double linear_tolerance = 0.6;

static void expect_image(const struct image *image, const struct volume *volume, const struct plane *plane)
{
    size_t n = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double ijk[3], inside = inside_grid(&volume->grid, point_of_pixel(plane, x, y), ijk);
            const uint8_t *pixel = shots_pixel(image, x, y);
            if (inside > 1e-3) {
                assert_close(pixel[0], fmax(linear_value(volume, ijk), shots_background[0]), linear_tolerance);
                n++;
            } else if (inside < -1e-3)
                assert_memory_equal(pixel, shots_background, 3);
        }
    assert_true(n > 20000); /* of 120000 pixels; the grid is about 38 x 38 x 39 mm, 228 pixels a side */
}

static struct scene image_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    scene.outline.on_slices = false;
    scene.image.window.center = 127.5; /* grey = value */
    scene.image.window.width = 255;
    scene.image.interpolation = SCENE_INTERPOLATION_LINEAR;
    return scene;
}

static void an_oblique_pane_shows_the_image_at_each_pixels_point(void **state)
{
    (void)state;
    struct grid grid = turned_grid();
    struct plane plane = oblique_plane();
    struct plan *plan = made_plan(&grid, label_of_octant, quarters, 4);
    made_plan_add_image(plan, &grid, VOXEL_U8, rough);
    struct view view = shots_view(SCENE_KIND_AXIAL, plane.origin_lps_mm, pixels_per_mm);
    struct snapshot *snapshot = snapshot_on(plan, image_scene(plan), view, &plane);
    struct image *image = picture_of(snapshot);
    expect_image(image, plan->images[0].volume, &plane);
    image_destroy(image);
    snapshot_unref(snapshot);
    shots_forget(plan);
}

static void an_oblique_slice_in_space_shows_the_same(void **state)
{
    (void)state;
    struct grid grid = turned_grid();
    struct plane plane = oblique_plane();
    struct plan *plan = made_plan(&grid, label_of_octant, quarters, 4);
    made_plan_add_image(plan, &grid, VOXEL_U8, rough);
    struct scene scene = image_scene(plan);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.visible = false;
    /* seen square on, from the side of right x up */
    struct vec3 from = vec3_cross(plane.right, plane.up);
    struct view view = shots_view_from(plane.origin_lps_mm, from, plane.up, pixels_per_mm);
    struct snapshot *snapshot = snapshot_on(plan, scene, view, &plane);
    struct image *image = picture_of(snapshot);
    expect_image(image, plan->images[0].volume, &plane);
    image_destroy(image);
    snapshot_unref(snapshot);
    shots_forget(plan);
}

static void an_oblique_pane_shows_the_label_at_each_pixels_point(void **state)
{
    (void)state;
    struct grid grid = turned_grid();
    struct plane plane = oblique_plane();
    struct plan *plan = made_plan(&grid, label_of_octant, quarters, 4);
    struct scene scene = shots_scene(plan);
    scene.outline.on_slices = false;
    struct view view = shots_view(SCENE_KIND_SAGITTAL, plane.origin_lps_mm, pixels_per_mm);
    struct snapshot *snapshot = snapshot_on(plan, scene, view, &plane);
    struct image *image = picture_of(snapshot);
    size_t n[5] = { 0 };
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double ijk[3], inside = inside_grid(&grid, point_of_pixel(&plane, x, y), ijk), off = fabs(inside);
            uint32_t at[3] = { 0 };
            for (int a = 0; a < 3; a++) {
                double place = ijk[a] + 0.5;
                off = fmin(off, fabs(place - round(place)));
                at[a] = (uint32_t)fmax(floor(place), 0);
            }
            if (off < 1e-3) /* on the border of two voxels, within single precision */
                continue;
            uint16_t label = inside > 0 ? volume_label(plan->regions.layers[0], at[0], at[1], at[2]) : 0;
            uint32_t rgb = label ? quarters[label - 1].rgb : 0x08090b;
            const uint8_t expected[3] = { (uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb };
            assert_memory_equal(shots_pixel(image, x, y), expected, 3);
            n[label]++;
        }
    for (int label = 1; label <= 4; label++)
        assert_true(n[label] > 2000);
    image_destroy(image);
    snapshot_unref(snapshot);
    shots_forget(plan);
}

static const struct vec3 ball_centre = { 4, 0, 3 };
static double ball(struct vec3 p)
{
    return vec3_length(vec3_sub(p, ball_centre)) < 13 ? 1 : 0;
}
static double black(struct vec3 p)
{
    return 0 * p.x;
}
static const struct made_region one_ball[] = { { "ball", -1, 0x30ff60 } };

/* Pixels of the ball's colour lie on the circle in which the plane cuts the ball. */
static void expect_circle(const struct image *image, const struct plane *plane, double tolerance_mm)
{
    double height = vec3_dot(vec3_sub(ball_centre, plane->origin_lps_mm), plane->normal);
    struct vec3 middle = vec3_sub(ball_centre, vec3_scale(plane->normal, height));
    double radius = sqrt(13 * 13 - height * height), least = INFINITY, most = 0;
    size_t n = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            const uint8_t *pixel = shots_pixel(image, x, y);
            if (pixel[1] < 200 || pixel[0] > 80)
                continue;
            double r = vec3_length(vec3_sub(point_of_pixel(plane, x, y), middle));
            least = fmin(least, r);
            most = fmax(most, r);
            n++;
        }
    assert_true(n > 300);
    assert_true(least > radius - tolerance_mm && most < radius + tolerance_mm);
}

/* Outlines come from the univels, the check's line from the surface. Half a diagonal of a voxel of 1 mm, half the line
 * of 1.5 pixels. */
static void outlines_and_the_check_on_an_oblique_pane_lie_where_the_plane_cuts_the_region(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(44);
    struct plane plane = oblique_plane();
    for (int is_check = 0; is_check < 2; is_check++) {
        struct plan *plan = made_plan(&grid, ball, one_ball, 1);
        made_plan_add_image(plan, &grid, VOXEL_U8, black);
        struct scene scene = shots_scene(plan);
        scene.outline.method = SCENE_OUTLINE_METHOD_MARCHING_SQUARES;
        scene.outline.width_px = 1.5;
        scene.check.visible = is_check;
        struct view view = shots_view(SCENE_KIND_CORONAL, plane.origin_lps_mm, pixels_per_mm);
        struct snapshot *snapshot = snapshot_on(plan, scene, view, &plane);
        struct image *image = picture_of(snapshot);
        expect_circle(image, &plane, sqrt(3) / 2 + 0.75 / pixels_per_mm + 0.1);
        image_destroy(image);
        snapshot_unref(snapshot);
        shots_forget(plan);
    }
}

static void a_pick_on_an_oblique_pane_gives_the_pixels_point(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(44);
    struct plane plane = oblique_plane();
    struct plan *plan = made_plan(&grid, ball, one_ball, 1);
    struct view view = shots_view(SCENE_KIND_CORONAL, plane.origin_lps_mm, pixels_per_mm);
    struct snapshot *snapshot = snapshot_on(plan, shots_scene(plan), view, &plane);
    struct pick_hit hits[PICK_MAX_HITS];
    struct vec3 expected = point_of_pixel(&plane, 210, 130);
    assert_int_equal(snapshot_pick(snapshot, 210.5, 130.5, hits), 1);
    assert_true(subject_equal(hits[0].subject, subject_region(0)));
    assert_close(vec3_length(vec3_sub(hits[0].point_lps_mm, expected)), 0, 1e-9);
    snapshot_unref(snapshot);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_oblique_pane_shows_the_image_at_each_pixels_point),
        cmocka_unit_test(an_oblique_slice_in_space_shows_the_same),
        cmocka_unit_test(an_oblique_pane_shows_the_label_at_each_pixels_point),
        cmocka_unit_test(outlines_and_the_check_on_an_oblique_pane_lie_where_the_plane_cuts_the_region),
        cmocka_unit_test(a_pick_on_an_oblique_pane_gives_the_pixels_point),
    };
    return shots_run("planes", tests, sizeof tests / sizeof tests[0]);
}
