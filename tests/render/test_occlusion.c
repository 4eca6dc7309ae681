/* Ambient occlusion of stills: planes keep their colour, corners are as dark as geometry says. */
#include "core/render/visible/occlusion.h"
#include "tests/render/shots.h"

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
static const struct vec3 up = { 0, 0, 1 };

static struct image *still(struct plan *plan, struct view view, bool is_occluded, int width_px)
{
    struct scene scene = shots_scene(plan);
    struct render_options options = { width_px, width_px * SHOTS_HEIGHT / SHOTS_WIDTH, SURFACE_FULL, true };
    scene.surface.normals = SCENE_NORMALS_FACE;
    scene.still.ambient_occlusion = is_occluded;
    return shots_take(plan, scene, view, &options, NULL);
}

static struct plan *make(double (*label)(struct vec3 p))
{
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, label, solid, 1);
    /* a radius of 10 mm: the cube's diagonal is 60 sqrt(3) mm */
    double side = 10 / OCCLUSION_RADIUS_PART / sqrt(3) / 2;
    plan->bounds_lps_mm = (struct box3){ vec3(-side, -side, -side), vec3(side, side, side) };
    return plan;
}

/* The outer faces and edges of a box see all of the light. */
static void a_box_is_not_changed(void **state)
{
    (void)state;
    struct plan *plan = make(box_label);
    struct view view = shots_view_from(vec3(0, 0, 0), vec3(1, -2, 1.5), up, 4.5);
    struct image *without = still(plan, view, false, SHOTS_WIDTH), *with = still(plan, view, true, SHOTS_WIDTH);
    assert_memory_equal(with->rgba, without->rgba, 4 * SHOTS_WIDTH * SHOTS_HEIGHT);
    image_destroy(without);
    image_destroy(with);
    shots_forget(plan);
}

/* Of a point of the floor at distance d from a wall that is higher than the radius R, the wall's points within R reach
 * up to the sine sqrt(1 - (u / cos a)^2) at azimuth a, u = d / R. The mean of its square over all azimuths is
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
        struct image *without = still(plan, view, false, width_px), *with = still(plan, view, true, width_px);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_not_changed),
        cmocka_unit_test(an_inner_corner_is_as_dark_as_geometry_says),
        cmocka_unit_test(slices_keep_their_values),
    };
    return shots_run("occlusion", tests, sizeof tests / sizeof tests[0]);
}
