/* Ambient occlusion of stills: planes keep their colour, corners are as dark as geometry says. */
#include "core/render/visible/occlusion.h"
#include "tests/render/volume_scene.h"

/* Two walls that meet at a right angle: a floor below S 0 and a wall behind P 0. */
static double corner_label(struct vec3 p)
{
    return fabs(p.x) < 28 && ((p.z < 0 && p.z > -28 && fabs(p.y) < 28) || (p.y > 0 && p.y < 28 && p.z < 28)) ? 1 : 0;
}
static double box_label(struct vec3 p)
{
    return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) < 20 ? 1 : 0;
}
static const struct made_region solid[] = { { "solid", -1, 0xc0c0c0 } };

static struct image *take(struct plan *plan, struct scene scene, struct view view, bool is_occluded, int width_px)
{
    struct render_options options = { width_px, width_px * SHOTS_HEIGHT / SHOTS_WIDTH, SURFACE_FULL, true };
    scene.surface.normals = SCENE_NORMALS_FACE;
    scene.still.ambient_occlusion = is_occluded;
    return shots_take(plan, scene, view, &options, NULL);
}

static struct image *still_of(struct plan *plan, struct view view, bool is_occluded, int width_px)
{
    return take(plan, shots_scene(plan), view, is_occluded, width_px);
}

/* A radius of 10 mm, a part of the plan's diagonal. */
static void set_radius(struct plan *plan)
{
    double side = 10 / OCCLUSION_RADIUS_PART / sqrt(3) / 2;
    plan->bounds_lps_mm = (struct box3){ vec3(-side, -side, -side), vec3(side, side, side) };
}

static struct plan *make(double (*label)(struct vec3 p))
{
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, label, solid, 1);
    set_radius(plan);
    return plan;
}

/* The outer faces and edges of a box see all of the light. */
static void a_box_is_not_changed(void **state)
{
    (void)state;
    struct plan *plan = make(box_label);
    struct view view = shots_view_from(vec3(0, 0, 0), vec3(1, -2, 1.5), up, 4.5);
    struct image *without = still_of(plan, view, false, SHOTS_WIDTH), *with = still_of(plan, view, true, SHOTS_WIDTH);
    assert_memory_equal(with->rgba, without->rgba, 4 * SHOTS_WIDTH * SHOTS_HEIGHT);
    image_destroy(without);
    image_destroy(with);
    shots_forget(plan);
}

/* Light at a point of the floor at distance d from a wall that is higher than the radius R: the wall's points within R
 * reach up to the sine sqrt(1 - (u / cos a)^2) at azimuth a, u = d / R. The mean of its square over all azimuths is
 * (acos u - u sqrt(1 - u^2)) / pi. */
static double light_before_wall(double u)
{
    return u >= 1 ? 1 : 1 - (acos(u) - u * sqrt(1 - u * u)) / MATH_PI;
}

static void an_inner_corner_is_as_dark_as_geometry_says(void **state)
{
    (void)state;
    struct plan *plan = make(corner_label);
    double first_size[25];
    for (int size = 0; size < 2; size++) {
        int width_px = SHOTS_WIDTH * (size + 1);
        double px_per_mm = 4.5 * (size + 1);
        /* seen at 45 degrees to floor and wall: S is sqrt(1/2) px_per_mm pixels a mm up on the wall, down on the floor
         */
        struct view view = shots_view_from(vec3(0, 0, 0), vec3(0, -1, 1), up, 4.5);
        struct image *without = still_of(plan, view, false, width_px), *with = still_of(plan, view, true, width_px);
        for (int i = 3; i <= 24; i++) { /* nearer, marching cubes have cut the corner of voxels off */
            double d_mm = i / 2.0, sum[2] = { 0 };
            for (int x = width_px / 2 - 8; x < width_px / 2 + 8; x++) { /* all patterns */
                int y = without->height_px / 2 + (int)(d_mm * px_per_mm * sqrt(0.5));
                sum[0] += shots_pixel(without, x, y)[1];
                sum[1] += shots_pixel(with, x, y)[1];
            }
            double factor = 1 - (1 - OCCLUSION_DARKEST) * (1 - light_before_wall(d_mm / 10));
            /* 12 azimuths count as a whole where the wall begins within one: 1 / 24 of the circle at each side of it,
             * at a sine squared of a half or less, and 0.55 of it in the factor; and the highest of some eight points
             * in each is below the horizon */
            assert_close(sum[1] / sum[0], factor, 0.05);
            if (size == 0)
                first_size[i] = sum[1] / sum[0];
            assert_close(sum[1] / sum[0], first_size[i], 0.02); /* whatever the size of the picture */
        }
        image_destroy(without);
        image_destroy(with);
    }
    shots_forget(plan);
}

/* A slice that hides a surface keeps its greys. */
static double grey(struct vec3 p)
{
    return 100 + p.x;
}
static void slices_keep_their_values(void **state)
{
    (void)state;
    struct plan *plan = make(corner_label);
    struct grid grid = made_cube_grid(60);
    made_plan_add_image(plan, &grid, VOXEL_F32, grey);
    struct image *images[2];
    for (int i = 0; i < 2; i++) {
        struct scene scene = shots_scene(plan);
        struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, true };
        scene.image.slices.coronal.visible = true;
        scene.image.slices.coronal.position_mm = -29;
        scene.still.ambient_occlusion = i == 1;
        images[i] = shots_take(plan, scene, shots_view_from(vec3(0, 0, 0), vec3(0, -1, 0), up, 6), &options, NULL);
    }
    assert_memory_equal(images[0]->rgba, images[1]->rgba, 4 * SHOTS_WIDTH * SHOTS_HEIGHT);
    image_destroy(images[0]);
    image_destroy(images[1]);
    shots_forget(plan);
}

/* ---- volumes ------------------------------------------------------------------------------------------------------ */

static struct plan *make_volume(double (*value)(struct vec3 p))
{
    struct grid grid = made_cube_grid(60);
    struct plan *plan = image_plan(&grid, VOXEL_U8, value);
    set_radius(plan);
    return plan;
}

/* Opaque from one half on, all of one colour. */
static struct scene opaque_scene(const struct plan *plan, enum scene_interpolation interpolation)
{
    const struct scene_transfer_point points[] = { { 0.5, 0xc0c0c0, 0 }, { 0.5, 0xc0c0c0, 1 } };
    struct scene scene = volume_scene(plan, points, 2);
    scene.image.volume.interpolation = interpolation;
    return scene;
}

static struct image *volume_still(struct plan *plan, struct view view, enum scene_interpolation interpolation,
                                  bool is_occluded)
{
    return take(plan, opaque_scene(plan, interpolation), view, is_occluded, SHOTS_WIDTH);
}

/* Factor by which a row is darker: the mean over 16 pixels in the middle, which have all patterns. */
static double mean_factor(const struct image *with, const struct image *without, int y)
{
    double sum[2] = { 0 };
    for (int x = SHOTS_WIDTH / 2 - 8; x < SHOTS_WIDTH / 2 + 8; x++) {
        sum[0] += shots_pixel(without, x, y)[1];
        sum[1] += shots_pixel(with, x, y)[1];
    }
    return sum[1] / sum[0];
}

static void a_volume_is_as_dark_in_its_corner_as_a_surface(void **state)
{
    (void)state;
    need_another_driver();
    struct view view = shots_view_from(vec3(0, 0, 0), vec3(0, -1, 1), up, 4.5);
    struct plan *plans[2] = { make(corner_label), make_volume(corner_label) };
    struct image *surface[2], *volume[2];
    for (int i = 0; i < 2; i++) {
        surface[i] = still_of(plans[0], view, i == 1, SHOTS_WIDTH);
        volume[i] = volume_still(plans[1], view, SCENE_INTERPOLATION_NEAREST, i == 1);
    }
    for (int i = 3; i <= 24; i++) {
        double d_mm = i / 2.0;
        for (int is_wall = 0; is_wall < 2; is_wall++) {
            int y = SHOTS_HEIGHT / 2 + (is_wall ? -1 : 1) * (int)(d_mm * 4.5 * sqrt(0.5));
            double of_volume = mean_factor(volume[1], volume[0], y);
            /* the surface is rounded in the corner, the volume hides all only 0.1 mm below its faces: both move the
             * horizon by 0.1 mm or so, 0.01 of the radius, and its mean square by as much */
            assert_close(of_volume, mean_factor(surface[1], surface[0], y), 0.02);
            assert_close(of_volume, 1 - (1 - OCCLUSION_DARKEST) * (1 - light_before_wall(d_mm / 10)), 0.05);
        }
    }
    for (int i = 0; i < 2; i++) {
        image_destroy(surface[i]);
        image_destroy(volume[i]);
        shots_forget(plans[i]);
    }
}

/* How far from the nearest edge a line meets the box of box_label, mm; -1: it misses the box. */
static double mm_from_edge(struct vec3 at, struct vec3 direction)
{
    const double from[3] = { at.x, at.y, at.z }, step[3] = { direction.x, direction.y, direction.z };
    double first = -INFINITY, last = INFINITY, distance_mm = INFINITY;
    int face = 0;
    for (int axis = 0; axis < 3; axis++) {
        double a = (-20 - from[axis]) / step[axis], b = (20 - from[axis]) / step[axis];
        if (fmin(a, b) > first) {
            first = fmin(a, b);
            face = axis;
        }
        last = fmin(last, fmax(a, b));
    }
    for (int axis = 0; axis < 3; axis++)
        if (axis != face)
            distance_mm = fmin(distance_mm, 20 - fabs(from[axis] + first * step[axis]));
    return first < last ? distance_mm : -1;
}

static void faces_of_a_volume_are_not_changed(void **state)
{
    (void)state;
    need_another_driver();
    struct plan *plan = make_volume(box_label);
    struct vec3 from = vec3(1, -2, 1.5), forward = vec3_scale(vec3_normalize(from), -1);
    struct vec3 right = vec3_normalize(vec3_cross(forward, up)), upward = vec3_cross(right, forward);
    for (int is_linear = 0; is_linear < 2; is_linear++) {
        enum scene_interpolation interpolation = is_linear ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
        struct view view = shots_view_from(vec3(0, 0, 0), from, up, 4.5);
        struct image *without = volume_still(plan, view, interpolation, false),
                     *with = volume_still(plan, view, interpolation, true);
        int n_on_faces = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                struct vec3 at = vec3_add(vec3_scale(right, (x + 0.5 - MIDDLE_X) / 4.5),
                                          vec3_scale(upward, (MIDDLE_Y - y - 0.5) / 4.5));
                double edge_mm = mm_from_edge(at, forward);
                int change = shots_pixel(without, x, y)[1] - shots_pixel(with, x, y)[1];
                /* a pixel on an edge may have the normal of neither face, and counts in the mean of the 4 x 4 around:
                 * 2 pixels, 1.2 mm on the face seen at the lowest angle; two in 16 of them lose at most a fourth */
                if (edge_mm > 2)
                    assert_int_equal(change, 0);
                else
                    assert_in_range(change, 0, 192 / 4 * 2 / 16);
                n_on_faces += edge_mm > 2;
            }
        assert_true(n_on_faces > 30000);
        image_destroy(without);
        image_destroy(with);
    }
    shots_forget(plan);
}

/* A surface as the floor, the image as a wall with a cut at y = 5 before it. */
static double floor_label(struct vec3 p)
{
    return p.z < 0 && p.z > -28 && fabs(p.x) < 28 && fabs(p.y) < 28 ? 1 : 0;
}
static double wall_value(struct vec3 p)
{
    return p.z > 0 && p.z < 28 && fabs(p.x) < 28 && p.y > 0 && p.y < 28 ? 100 + p.x : 0;
}
static struct image *cut_wall_still(struct plan *plan, bool is_capped, enum scene_volume_method method,
                                    bool is_occluded)
{
    const struct scene_transfer_point points[] = { { 50, 0xc0c0c0, 0 }, { 50, 0xc0c0c0, 1 } };
    struct scene scene = volume_scene(plan, points, 2);
    scene.image.volume.interpolation = SCENE_INTERPOLATION_NEAREST;
    scene.image.volume.method = method;
    scene.clip.coronal_low.enabled = true;
    scene.clip.coronal_low.position_mm = 5;
    scene.clip.coronal_low.cap = is_capped;
    shots_style(&scene, "solid")->clipped = false;
    return take(plan, scene, shots_view_from(vec3(0, 5, 0), vec3(0, -1, 1), up, 4.5), is_occluded, SHOTS_WIDTH);
}

static void a_cut_face_of_a_volume_darkens_a_floor_and_keeps_its_greys(void **state)
{
    (void)state;
    need_another_driver();
    struct plan *plan = make(floor_label);
    struct grid grid = made_cube_grid(60);
    made_plan_add_image(plan, &grid, VOXEL_U8, wall_value);
    for (int is_capped = 0; is_capped < 2; is_capped++) {
        struct image *images[2];
        for (int i = 0; i < 2; i++)
            images[i] = cut_wall_still(plan, is_capped, SCENE_VOLUME_METHOD_RAY, i == 1);
        for (int i = 3; i <= 24; i++) {
            double d_mm = i / 2.0, factor = 1 - (1 - OCCLUSION_DARKEST) * (1 - light_before_wall(d_mm / 10));
            int down_px = (int)(d_mm * 4.5 * sqrt(0.5)); /* tolerance: as in the corner of surfaces */
            assert_close(mean_factor(images[1], images[0], MIDDLE_Y + down_px), factor, 0.05);
            double on_wall = mean_factor(images[1], images[0], MIDDLE_Y - down_px);
            if (is_capped)
                assert_true(on_wall == 1);
            else
                assert_close(on_wall, factor, 0.05);
        }
        image_destroy(images[0]);
        image_destroy(images[1]);
    }
    shots_forget(plan);
}

static void a_picture_with_projected_values_is_left_as_it_is(void **state)
{
    (void)state;
    need_another_driver();
    static const enum scene_volume_method methods[] = { SCENE_VOLUME_METHOD_SLICES, SCENE_VOLUME_METHOD_MIP,
                                                        SCENE_VOLUME_METHOD_AVERAGE };
    struct plan *plan = make(floor_label);
    struct grid grid = made_cube_grid(60);
    made_plan_add_image(plan, &grid, VOXEL_U8, wall_value);
    for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
        struct image *images[2];
        for (int i = 0; i < 2; i++)
            images[i] = cut_wall_still(plan, true, methods[m], i == 1);
        assert_memory_equal(images[1]->rgba, images[0]->rgba, 4 * SHOTS_WIDTH * SHOTS_HEIGHT);
        image_destroy(images[0]);
        image_destroy(images[1]);
    }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_not_changed),
        cmocka_unit_test(an_inner_corner_is_as_dark_as_geometry_says),
        cmocka_unit_test(slices_keep_their_values),
        cmocka_unit_test(a_volume_is_as_dark_in_its_corner_as_a_surface),
        cmocka_unit_test(faces_of_a_volume_are_not_changed),
        cmocka_unit_test(a_cut_face_of_a_volume_darkens_a_floor_and_keeps_its_greys),
        cmocka_unit_test(a_picture_with_projected_values_is_left_as_it_is),
    };
    return shots_run("occlusion", tests, sizeof tests / sizeof tests[0]);
}
