/* Outlines of regions on slice panes: where the plane cuts the surface, against geometry, and the image under them. */
#include <math.h>

#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const enum scene_kind kinds[] = { SCENE_KIND_AXIAL, SCENE_KIND_CORONAL, SCENE_KIND_SAGITTAL };

/* Right is patient left on axial and coronal panes, posterior on sagittal ones; up is anterior on axial panes, superior
 * on the others. */
static void on_pane(enum scene_kind kind, struct vec3 p, double pixels_per_mm, double *x, double *y)
{
    double right = kind == SCENE_KIND_SAGITTAL ? p.y : p.x, up = kind == SCENE_KIND_AXIAL ? -p.y : p.z;
    *x = SHOTS_WIDTH / 2.0 + right * pixels_per_mm;
    *y = SHOTS_HEIGHT / 2.0 - up * pixels_per_mm;
}

static void set_slices(struct scene *scene, struct vec3 at)
{
    scene->image.slices.sagittal.position_mm = at.x;
    scene->image.slices.coronal.position_mm = at.y;
    scene->image.slices.axial.position_mm = at.z;
}

static struct scene outlined(const struct plan *plan, enum scene_outline_method method, struct vec3 at)
{
    struct scene scene = shots_scene(plan);
    scene.outline.method = method;
    scene.image.window.center = 0.5;
    scene.image.window.width = 1;
    set_slices(&scene, at);
    return scene;
}

/* A still at one sample a pixel, as the voxels are larger than pixels: stills show surfaces, moving pictures may not.
 */
static struct image *take(struct plan *plan, struct scene scene, struct view view)
{
    const struct render_options still = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, true };
    return shots_take(plan, scene, view, &still, NULL);
}

static bool is_green(const uint8_t *p)
{
    return p[1] > 150 && p[0] < 100 && p[2] < 100;
}

/* ---- one univel ------------------------------------------------------------------------------------------------- */

/* Grids of 2 x 3 x 4.5 mm: axes along L, P, S, and axes that run the other way and are exchanged. */
static struct grid anisotropic_grid(bool is_flipped)
{
    const uint32_t size[3] = { 13, 13, 13 };
    struct vec3 l = vec3(2, 0, 0), p = vec3(0, 3, 0), s = vec3(0, 0, 4.5), centre = vec3(1.3, -0.7, 2.1);
    return is_flipped ? made_grid(13, 13, 13,
                                  made_affine(vec3_scale(s, -1), vec3_scale(l, -1), vec3_scale(p, -1), size, centre))
                      : made_grid(13, 13, 13, made_affine(l, p, s, size, centre));
}

static struct vec3 univel; /* the centre of the only univel */
static double is_univel(struct vec3 p)
{
    return vec3_length(vec3_sub(p, univel)) < 0.1;
}
static const struct made_region one[] = { { "one", -1, 0x20ff20 } };

/* The mean position of what is bright in a picture: of pixels by their green, weighted. */
static size_t mean_of(const struct image *image, bool is_line, double *x, double *y)
{
    double sum = 0, sum_x = 0, sum_y = 0;
    size_t n = 0;
    for (int row = 0; row < SHOTS_HEIGHT; row++)
        for (int column = 0; column < SHOTS_WIDTH; column++) {
            const uint8_t *p = shots_pixel(image, column, row);
            double weight = is_line ? fmax(0, p[1] - p[0] - 16) : fmax(0, p[0] - 16.0);
            sum += weight;
            sum_x += weight * (column + 0.5);
            sum_y += weight * (row + 0.5);
            n += weight > 0;
        }
    *x = sum_x / sum;
    *y = sum_y / sum;
    return n;
}

/* The outline and the bright voxel have the voxel's centre as theirs: both are symmetric about it. */
static void one_univel_is_outlined_around_its_voxel_in_the_image(void **state)
{
    (void)state;
    for (int is_flipped = 0; is_flipped < 2; is_flipped++) {
        struct grid grid = anisotropic_grid(is_flipped);
        univel = affine_point(&grid.lps_mm_from_ijk, vec3(8, 5, 6));
        struct plan *plan = made_plan(&grid, is_univel, one, 1);
        made_plan_add_image(plan, &grid, VOXEL_F32, is_univel);
        for (int k = 0; k < 3; k++)
            for (int is_linear = 0; is_linear < 2; is_linear++)
                for (int has_line = 0; has_line < 2; has_line++) {
                    struct scene scene = outlined(plan, SCENE_OUTLINE_METHOD_SURFACE, univel);
                    double x, y, found_x, found_y;
                    scene.image.interpolation = is_linear ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
                    scene.outline.on_slices = has_line;
                    struct image *image = take(plan, scene, shots_view(kinds[k], origin, 10));
                    assert_true(mean_of(image, has_line, &found_x, &found_y) > 40);
                    on_pane(kinds[k], univel, 10, &x, &y);
                    assert_close(found_x, x, 0.6); /* pixels, of which a voxel has 20 to 45 */
                    assert_close(found_y, y, 0.6);
                    image_destroy(image);
                }
        shots_forget(plan);
    }
}

/* ---- a sphere --------------------------------------------------------------------------------------------------- */

enum { SPHERE_PX_PER_MM = 6 };
static const double sphere_mm = 17;
static double sphere(struct vec3 p)
{
    return vec3_length(p) < sphere_mm;
}
static const struct made_region ball[] = { { "ball", -1, 0x20ff20 } };

/* Mean, least and most distance of green pixels from the picture's middle, in mm. */
static void measure(const struct image *image, double *mean, double *least, double *most)
{
    double sum = 0;
    size_t n = 0;
    *least = INFINITY;
    *most = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double r = hypot(x + 0.5 - SHOTS_WIDTH / 2.0, y + 0.5 - SHOTS_HEIGHT / 2.0) / SPHERE_PX_PER_MM;
            if (!is_green(shots_pixel(image, x, y)))
                continue;
            sum += r;
            n++;
            *least = fmin(*least, r);
            *most = fmax(*most, r);
        }
    assert_true(n > 300);
    *mean = sum / (double)n;
}

/* Univels of 1 mm: the outline is within half a univel of the sphere everywhere, plus half of its width and a pixel. On
 * the mean it is nearer: traced outlines, through the centres of border univels, are half a univel too small. */
static void a_spheres_outline_is_within_half_a_univel_of_its_radius(void **state)
{
    (void)state;
    static const enum scene_algorithm algorithms[] = { SCENE_ALGORITHM_SMOOTH, SCENE_ALGORITHM_MARCHING_CUBES };
    struct grid grid = made_cube_grid(49);
    struct plan *plan = made_plan(&grid, sphere, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, sphere);
    double traced = 0;
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++) {
            bool is_traced = a == 2;
            struct scene scene = outlined(plan, is_traced ? SCENE_OUTLINE_METHOD_TRACED : SCENE_OUTLINE_METHOD_SURFACE,
                                          vec3(0.2, 0.2, 0.2));
            scene.surface.algorithm = algorithms[a % 2];
            struct image *image = take(plan, scene, shots_view(kinds[k], origin, SPHERE_PX_PER_MM));
            double mean, least, most, slack = 1.75 / SPHERE_PX_PER_MM;
            measure(image, &mean, &least, &most);
            if (is_traced) {
                traced = mean;
            } else {
                assert_close(mean, sphere_mm, 0.25);
                assert_true(least > sphere_mm - 0.5 - slack && most < sphere_mm + 0.5 + slack);
            }
            image_destroy(image);
        }
    assert_close(traced, sphere_mm - 0.5, 0.25);
    shots_forget(plan);
}

/* A region drawn as univels is outlined along the faces of these: at whole millimetres here. */
static double block(struct vec3 p)
{
    return fabs(p.x) < 5 && fabs(p.y) < 5 && fabs(p.z) < 5;
}
static void univels_are_outlined_along_their_faces(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(20); /* centres at halves */
    struct plan *plan = made_plan(&grid, block, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, block);
    struct scene scene = outlined(plan, SCENE_OUTLINE_METHOD_SURFACE, vec3(0.5, 0.5, 0.5));
    shots_style(&scene, "ball")->representation = SCENE_REPRESENTATION_UNIVELS;
    scene.outline.width_px = 3;
    struct image *image = take(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 10));
    for (int way = -1; way <= 1; way += 2) {
        assert_true(is_green(shots_pixel(image, SHOTS_WIDTH / 2 + way * 50, SHOTS_HEIGHT / 2 + 12)));
        assert_true(is_green(shots_pixel(image, SHOTS_WIDTH / 2 + 12, SHOTS_HEIGHT / 2 + way * 50)));
        assert_false(is_green(shots_pixel(image, SHOTS_WIDTH / 2 + way * 45, SHOTS_HEIGHT / 2 + 12)));
    }
    image_destroy(image);
    shots_forget(plan);
}

/* ---- the halo, and surfaces that are not built ------------------------------------------------------------------- */

static double white(struct vec3 p)
{
    return p.x * 0 + 2;
}

/* A line 3 px wide, then 1 px of #07080a to each side, on white. The edge x = 5 mm lies between pixels 249 and 250. */
static void a_dark_pixel_to_each_side_sets_a_line_off_from_bone(void **state)
{
    (void)state;
    static const struct made_region pair[] = { { "ball", -1, 0x20ff20 }, { "beside", -1, 0xffff20 } };
    struct grid grid = made_cube_grid(20);
    struct plan *plan = made_plan(&grid, block, pair, 2);
    made_plan_add_image(plan, &grid, VOXEL_F32, white);
    static const uint8_t halo[3] = { 0x07, 0x08, 0x0a }, line[3] = { 0x20, 0xff, 0x20 }, bone[3] = { 255, 255, 255 };
    for (int ratio = 1; ratio <= 2; ratio++) { /* a line of 2 is 4 px wide on a screen with pixel_ratio 2, its halo 2 */
        struct scene scene = outlined(plan, SCENE_OUTLINE_METHOD_SURFACE, vec3(0.5, 0.5, 0.5));
        shots_style(&scene, "ball")->representation = SCENE_REPRESENTATION_UNIVELS;
        scene.outline.width_px = 4.0 / ratio;
        struct view view = shots_view(SCENE_KIND_AXIAL, origin, 10);
        view.pixel_ratio = ratio;
        struct image *image = take(plan, scene, view);
        for (int x = 244; x < 256; x++) {
            const uint8_t *wanted = x >= 248 && x < 252 ? line : x >= 248 - ratio && x < 252 + ratio ? halo : bone;
            for (int c = 0; c < 3; c++)
                assert_close(shots_pixel(image, x, 150)[c], wanted[c], 1);
        }
        image_destroy(image);
    }
    shots_forget(plan);
}

/* Words stand in the strip at the foot of a slice: below a fifth of its height, lines over the slice have 30 % of their
 * strength there, above it all of it. Right of the middle the block's edge runs down between pixels 249 and 250. */
static void lines_fade_in_the_strip_at_the_foot(void **state)
{
    (void)state;
    enum { FOOT = 28, EDGE = 250, ABOVE = 230 };
    struct grid grid = made_cube_grid(20);
    struct plan *plan = made_plan(&grid, block, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, white);
    static const double line[3] = { 0x20, 0xff, 0x20 }, halo[3] = { 0x07, 0x08, 0x0a };
    for (int ratio = 1; ratio <= 2; ratio++) {
        struct image *images[2];
        for (int i = 0; i < 2; i++) {
            struct scene scene = outlined(plan, SCENE_OUTLINE_METHOD_SURFACE, vec3(0.5, 0.5, 0.5));
            shots_style(&scene, "ball")->representation = SCENE_REPRESENTATION_UNIVELS;
            scene.outline.width_px = 4.0 / ratio;
            struct view view = shots_view(SCENE_KIND_AXIAL, vec3(0, -12, 0), 10); /* the block is cut off below */
            view.pixel_ratio = ratio;
            view.foot_px = i == 0 ? 0 : FOOT;
            images[i] = take(plan, scene, view);
        }
        const int first = SHOTS_HEIGHT - FOOT * ratio, faded = first + FOOT * ratio / 5 + 1;
        assert_memory_equal(images[1]->rgba, images[0]->rgba, 4 * (size_t)SHOTS_WIDTH * (size_t)first);
        for (int c = 0; c < 3; c++) {
            assert_close(shots_pixel(images[1], EDGE, ABOVE)[c], line[c], 1);
            for (int y = first; y < SHOTS_HEIGHT; y++) {
                const double share = y < faded ? 0.65 : 0.3, slack = y < faded ? 0.35 * 255 + 1 : 1.5;
                assert_close(shots_pixel(images[1], EDGE, y)[c], 255 - share * (255 - line[c]), slack);
                assert_close(shots_pixel(images[1], EDGE + 2, y)[c], 255 - share * (255 - halo[c]), slack);
                assert_int_equal(shots_pixel(images[1], EDGE - 40, y)[c], 255); /* the slice itself does not fade */
            }
        }
        image_destroy(images[0]);
        image_destroy(images[1]);
    }
    shots_forget(plan);
}

/* In a picture of half the size the strip is half as high; a picture of the space has none. */
static void the_strip_at_the_foot_is_reduced_with_the_picture_and_only_of_slices(void **state)
{
    (void)state;
    const struct render_options half = { SHOTS_WIDTH / 2, SHOTS_HEIGHT / 2, SURFACE_FULL, true };
    struct grid grid = made_cube_grid(20);
    struct plan *plan = made_plan(&grid, block, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, white);
    struct image *images[2][2];
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < 2; i++) {
            struct scene scene = outlined(plan, SCENE_OUTLINE_METHOD_SURFACE, vec3(0.5, 0.5, 0.5));
            scene.axes.visible = true;
            struct view view = shots_view(kind == 0 ? SCENE_KIND_AXIAL : SCENE_KIND_3D, vec3(0, -12, 0), 10);
            view.foot_px = i == 0 ? 0 : 40;
            images[kind][i] = shots_take(plan, scene, view, &half, NULL);
        }
    const size_t row = 4 * (size_t)SHOTS_WIDTH / 2, n_above = SHOTS_HEIGHT / 2 - 20;
    assert_memory_equal(images[0][1]->rgba, images[0][0]->rgba, row * n_above);
    assert_memory_not_equal(images[0][1]->rgba + row * n_above, images[0][0]->rgba + row * n_above, row);
    assert_memory_equal(images[1][1]->rgba, images[1][0]->rgba, row * SHOTS_HEIGHT / 2);
    for (int i = 0; i < 4; i++)
        image_destroy(images[i / 2][i % 2]);
    shots_forget(plan);
}

/* A moving picture does not wait for a surface: it shows marching squares, which lie half a univel further out than
 * traced outlines. A still builds the surface; the next moving picture shows it. */
static void a_moving_picture_outlines_univels_until_the_surface_is_built(void **state)
{
    (void)state;
    const struct render_options moving = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_COARSE, false },
                                still = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, true };
    struct grid grid = made_cube_grid(49);
    struct plan *plan = made_plan(&grid, sphere, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, sphere);
    const struct view view = shots_view(SCENE_KIND_AXIAL, origin, SPHERE_PX_PER_MM);
    struct image *images[4];
    for (int i = 0; i < 4; i++) {
        struct scene scene =
            outlined(plan, i == 0 ? SCENE_OUTLINE_METHOD_MARCHING_SQUARES : SCENE_OUTLINE_METHOD_SURFACE, origin);
        scene.surface.algorithm =
            SCENE_ALGORITHM_SMOOTH; /* marching cubes give the very lines of marching squares here */
        images[i] = shots_take(plan, scene, view, i == 2 ? &still : &moving, NULL);
    }
    size_t n_bytes = (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4;
    assert_memory_equal(images[1]->rgba, images[0]->rgba, n_bytes);
    assert_memory_not_equal(images[3]->rgba, images[1]->rgba, n_bytes);
    double still_mm, after_mm, least, most;
    measure(images[2], &still_mm, &least, &most);
    measure(images[3], &after_mm, &least, &most);
    assert_close(after_mm, still_mm, 0.01);
    for (int i = 0; i < 4; i++)
        image_destroy(images[i]);
    shots_forget(plan);
}

/* ---- lines that are kept as pixels ------------------------------------------------------------------------------- */

static const struct made_region crossing[] = { { "ball", -1, 0x20ff20 }, { "block", -1, 0xff20ff } };
static double ball_and_block(struct vec3 p)
{
    return block(vec3(p.x - 12, p.y, p.z)) > 0 ? 2 : sphere(p);
}

/* Lines that stay in place are not painted anew: a picture is the same with kept lines and without, whatever was drawn
 * between. The renderer forgets the plan for the other picture. */
static void kept_lines_make_the_same_picture(void **state)
{
    (void)state;
    enum { FIRST, ZOOMED, SHIFTED, WIDER, OTHER_SLICE, ONE_HIDDEN, SMALLER, CHECKED };
    static const int order[] = { FIRST,   FIRST,   FIRST,       ZOOMED,      ZOOMED,     ZOOMED,     SHIFTED,
                                 SHIFTED, SHIFTED, WIDER,       WIDER,       WIDER,      FIRST,      OTHER_SLICE,
                                 FIRST,   FIRST,   OTHER_SLICE, OTHER_SLICE, ONE_HIDDEN, ONE_HIDDEN, SMALLER,
                                 SMALLER, SMALLER, FIRST,       CHECKED,     CHECKED,    CHECKED };
    enum { N = sizeof order / sizeof order[0] };
    struct grid grid = made_cube_grid(49);
    struct plan *plan = made_plan(&grid, ball_and_block, crossing, 2);
    made_plan_add_image(plan, &grid, VOXEL_F32, sphere);
    struct image *kept[N];
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < N; i++) {
            int look = order[i];
            struct scene scene = outlined(plan, SCENE_OUTLINE_METHOD_SURFACE, vec3(0, 0, look == OTHER_SLICE ? 3 : 0));
            scene.outline.width_px = look == WIDER ? 3 : 1.5;
            scene.check.visible = look == CHECKED;
            snprintf(scene.check.region, sizeof scene.check.region, "ball");
            shots_style(&scene, "block")->visible = look != ONE_HIDDEN;
            const struct render_options options = { SHOTS_WIDTH / (look == SMALLER ? 2 : 1),
                                                    SHOTS_HEIGHT / (look == SMALLER ? 2 : 1), SURFACE_FULL, true };
            struct view view = shots_view(SCENE_KIND_AXIAL, vec3(look == SHIFTED ? 0.31 : 0, 0, 0),
                                          look == ZOOMED ? SPHERE_PX_PER_MM * 1.01 : SPHERE_PX_PER_MM);
            if (pass)
                renderer_forget(shots_renderer, plan);
            struct image *image = shots_take(plan, scene, view, &options, NULL);
            if (!pass) {
                kept[i] = image;
                continue;
            }
            assert_memory_equal(kept[i]->rgba, image->rgba, (size_t)image->width_px * (size_t)image->height_px * 4);
            image_destroy(image);
            image_destroy(kept[i]);
        }
    shots_forget(plan);
}

/* Degree bins cannot show a region of two pieces; the pane outlines its univels, as marching squares do. */
static double two_pieces(struct vec3 p)
{
    return fmin(vec3_length(vec3_sub(p, vec3(-9, 0, 0))), vec3_length(vec3_sub(p, vec3(9, 0, 0)))) < 5;
}
static void a_region_that_cannot_have_its_shape_is_outlined_all_the_same(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(41);
    struct plan *plan = made_plan(&grid, two_pieces, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, two_pieces);
    struct image *images[2];
    for (int i = 0; i < 2; i++) {
        struct scene scene =
            outlined(plan, i ? SCENE_OUTLINE_METHOD_SURFACE : SCENE_OUTLINE_METHOD_MARCHING_SQUARES, origin);
        shots_style(&scene, "ball")->representation = SCENE_REPRESENTATION_NURBS;
        scene.nurbs.sampling = SCENE_NURBS_SAMPLING_DEGREE_BINS;
        images[i] = take(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 8));
    }
    assert_memory_equal(images[0]->rgba, images[1]->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    int border = SHOTS_WIDTH / 2 + 36; /* 4.5 mm: between the univels at 4 and 5 mm */
    assert_true(shots_pixel(images[1], border, SHOTS_HEIGHT / 2)[1] > 150);
    image_destroy(images[0]);
    image_destroy(images[1]);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_univel_is_outlined_around_its_voxel_in_the_image),
        cmocka_unit_test(a_spheres_outline_is_within_half_a_univel_of_its_radius),
        cmocka_unit_test(univels_are_outlined_along_their_faces),
        cmocka_unit_test(a_dark_pixel_to_each_side_sets_a_line_off_from_bone),
        cmocka_unit_test(lines_fade_in_the_strip_at_the_foot),
        cmocka_unit_test(the_strip_at_the_foot_is_reduced_with_the_picture_and_only_of_slices),
        cmocka_unit_test(a_region_that_cannot_have_its_shape_is_outlined_all_the_same),
        cmocka_unit_test(a_moving_picture_outlines_univels_until_the_surface_is_built),
        cmocka_unit_test(kept_lines_make_the_same_picture),
    };
    return shots_run("outlines", tests, sizeof tests / sizeof tests[0]);
}
