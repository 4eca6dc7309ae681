/* Lines, points and open or faceted triangles: position, size and shading. The shapes are made by hand and replace
 * those of the plan. */
#include "core/derive/region_shape.h"
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const struct vec3 from_front = { 0, -1, 0 }, up = { 0, 0, 1 };
static const struct made_region two[] = { { "shown", -1, 0xf08020 }, { "plate", -1, 0x2040ff } };
static const double orange[3] = { 0xf0 / 255.0, 0x80 / 255.0, 0x20 / 255.0 };

/* A plate in front of the middle, on the right half of the picture; and one voxel, whose region's shape is made by
 * hand.
 */
static double label(struct vec3 p)
{
    if (p.x > 0 && fabs(p.z) < 25 && p.y > -20 && p.y < -15)
        return 2;
    return vec3_length(p) < 0.9 ? 1 : 0;
}

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(60);
    return made_plan(&grid, label, two, 2);
}

/* Consumes shape. */
static void put(struct plan *plan, enum region_representation representation, struct shape *shape)
{
    const struct shape_key key = { .representation = representation, .nurbs_order = 4, .nurbs_bins = 36 };
    const struct region_shape_recipe recipe = region_shape_recipe(subject_region(0), &key, 1);
    struct shape_facts facts = { .reduction = 1 };
    shape->references = 1;
    region_shape_offer(derived_of(plan), &recipe, shape, &facts);
    shape_unref(shape);
}

static float *copy_floats(const float *from, size_t n)
{
    float *to = mem_new(n * sizeof *to);
    memcpy(to, from, n * sizeof *to);
    return to;
}

static void measure(struct shape *shape, const float *positions, size_t n)
{
    shape->bounds_lps_mm = box3_empty();
    for (size_t i = 0; i < n; i++)
        box3_add(&shape->bounds_lps_mm,
                 vec3((double)positions[3 * i], (double)positions[3 * i + 1], (double)positions[3 * i + 2]));
}

static struct shape *make_lines(const float *positions, size_t n)
{
    struct shape *shape = mem_new(sizeof *shape);
    shape->kind = SHAPE_LINES;
    shape->lines = mem_new(sizeof *shape->lines);
    shape->lines->positions_lps_mm = copy_floats(positions, 3 * n);
    shape->lines->indices = mem_new(n * sizeof(uint32_t));
    for (uint32_t i = 0; i < n; i++)
        shape->lines->indices[i] = i;
    shape->lines->n_vertices = n;
    shape->lines->n_segments = n / 2;
    measure(shape, positions, n);
    return shape;
}

static struct shape *make_points(const float *positions, const float *normals, const uint8_t *shade, size_t n)
{
    struct shape *shape = mem_new(sizeof *shape);
    shape->kind = SHAPE_POINTS;
    shape->points = mem_new(sizeof *shape->points);
    shape->points->positions_lps_mm = copy_floats(positions, 3 * n);
    shape->points->normals = copy_floats(normals, 3 * n);
    shape->points->shade = mem_new(n);
    memcpy(shape->points->shade, shade, n);
    for (int i = 0; i < 3; i++)
        shape->points->edge_lps_mm[i] = vec3(i == 0 ? 4 : 0, i == 1 ? 3 : 0, i == 2 ? 2 : 0);
    shape->points->n_points = n;
    measure(shape, positions, n);
    return shape;
}

static struct scene scene_as(const struct plan *plan, enum scene_representation representation)
{
    struct scene scene = shots_scene(plan);
    shots_style(&scene, "shown")->representation = representation;
    return scene;
}

/* The number of pixels that differ from the background, and the box around them. */
static size_t drawn(const struct image *image, double *x_px, double *y_px)
{
    size_t n = 0;
    *x_px = *y_px = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++)
            if (memcmp(shots_pixel(image, x, y), shots_background, 3) != 0) {
                n++;
                *x_px += x + 0.5;
                *y_px += y + 0.5;
            }
    *x_px /= n ? (double)n : 1;
    *y_px /= n ? (double)n : 1;
    return n;
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

static void a_line_is_as_wide_as_the_scene_says_in_its_regions_colour(void **state)
{
    (void)state;
    static const float ends[6] = { -20, 0, 10, -10, 0, 10 };
    for (int scale = 1; scale <= 2; scale++) { /* half as many pixels, half as wide */
        struct plan *plan = make_plan();
        put(plan, REPRESENTATION_OUTLINE, make_lines(ends, 2));
        struct scene scene = scene_as(plan, SCENE_REPRESENTATION_OUTLINE);
        shots_style(&scene, "plate")->visible = false;
        scene.outline.width_px = 6;
        struct render_options options = { SHOTS_WIDTH / scale, SHOTS_HEIGHT / scale, SURFACE_FULL, false };
        struct image *image = shots_take(plan, scene, shots_view_from(origin, from_front, up, 6), &options, NULL);
        double x, y, n = (double)drawn(image, &x, &y);
        assert_close(n, (60 + 6) * 6.0 / (scale * scale),
                     7.0); /* 10 mm, and half a width more at each end; a column of pixels */
        assert_close(x, (200 - 15 * 6.0) / scale, 0.5);
        assert_close(y, (150 - 10 * 6.0) / scale, 0.5);
        const uint8_t *pixel = shots_pixel(image, (int)x, (int)y);
        for (int c = 0; c < 3; c++)
            assert_close(pixel[c], 255 * orange[c], 1); /* nearest part of its box: its own colour */
        image_destroy(image);
        shots_forget(plan);
    }
}

static void lines_behind_something_are_hidden_and_far_ones_are_darker(void **state)
{
    (void)state;
    static const float ends[18] = { -20, 20,  10,  20,  20,  10,  /* far, behind the plate on the right */
                                    -20, -25, -10, 20,  -25, -10, /* near, before it */
                                    -20, 20,  -20, -10, 20,  -20 };
    struct plan *plan = make_plan();
    put(plan, REPRESENTATION_OUTLINE, make_lines(ends, 6));
    struct scene scene = scene_as(plan, SCENE_REPRESENTATION_OUTLINE);
    scene.outline.width_px = 3;
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from_front, up, 6));
    int far_left = shots_pixel(image, 200 - 60, 150 - 60)[0], near_left = shots_pixel(image, 200 - 60, 150 + 60)[0];
    const uint8_t *far_right = shots_pixel(image, 200 + 60, 150 - 60),
                  *near_right = shots_pixel(image, 200 + 60, 150 + 60);
    assert_close(near_left, 0xf0, 1);
    assert_close(far_left, 0xf0 * 0.4, 2);
    assert_true(far_right[2] > far_right[0]); /* the plate */
    assert_close(near_right[0], 0xf0, 1);
    image_destroy(image);
    shots_forget(plan);
}

static void a_line_through_the_eyes_plane_is_cut_there(void **state)
{
    (void)state;
    static const float ends[6] = { -5, -200, -8, -5, 60, 10 }; /* begins behind the eye */
    struct plan *plan = make_plan();
    put(plan, REPRESENTATION_OUTLINE, make_lines(ends, 2));
    struct scene scene = scene_as(plan, SCENE_REPRESENTATION_OUTLINE);
    shots_style(&scene, "plate")->visible = false;
    scene.outline.width_px = 3;
    struct view view = shots_view_from(origin, from_front, up, 6);
    view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    view.camera.has_height_mm = false;
    view.camera.fov_deg = 60;
    view.camera.position_mm = vec3(0, -40, 0);
    struct image *image = shots_plain(plan, scene, view);
    double pixels_per_tangent = SHOTS_HEIGHT / 2.0 / tan(MATH_PI * 30 / 180);
    for (double y = -26; y < 30;
         y += 8) { /* along it, by the projection; within the plan, beyond which is the near plane */
        double t = (y + 200) / 260, z = -8 + 18 * t, px = 200 + pixels_per_tangent * -5 / (y + 40),
               py = 150 - pixels_per_tangent * z / (y + 40);
        if (px < 2 || py < 2 || px > SHOTS_WIDTH - 3 || py > SHOTS_HEIGHT - 3)
            continue;
        assert_memory_not_equal(shots_pixel(image, (int)px, (int)py), shots_background, 3);
    }
    image_destroy(image);
    shots_forget(plan);
}

/* ---- points ----------------------------------------------------------------------------------------------------- */

static void points_are_squares_of_the_size_the_scene_says(void **state)
{
    (void)state;
    static const float positions[3] = { -10, 0, 5 },
                       normals[2][3] = { { 0, -1, 0 }, { 0, 0, 0 } }; /* none: as if it faced the viewer */
    struct plan *plan = make_plan();
    put(plan, REPRESENTATION_POINTS, make_points(positions, normals[0], (uint8_t[]){ 128 }, 1));
    struct plan *without = make_plan();
    put(without, REPRESENTATION_POINTS, make_points(positions, normals[1], (uint8_t[]){ 128 }, 1));
    for (int size = 1; size <= 7; size += 3)
        for (int scale = 1; scale <= 2; scale++) {
            struct scene scene = scene_as(plan, SCENE_REPRESENTATION_POINTS);
            shots_style(&scene, "plate")->visible = false;
            scene.points.size_px = size;
            struct render_options options = { SHOTS_WIDTH / scale, SHOTS_HEIGHT / scale, SURFACE_FULL, false };
            struct image *image = shots_take(size > 4 ? without : plan, scene,
                                             shots_view_from(origin, from_front, up, 6.02), &options, NULL);
            double x, y, side = fmax(1, (double)size / scale);
            size_t n = drawn(image, &x, &y);
            assert_true((double)n >= floor(side) * floor(side) && (double)n <= ceil(side) * ceil(side));
            assert_close(x, (200 - 60.2) / scale, 0.6);
            assert_close(y, (150 - 30.1) / scale, 0.6);
            for (int c = 0; c < 3; c++) /* lit as a surface that faces the viewer */
                assert_close(shots_pixel(image, (int)x, (int)y)[c], 255 * shots_facing_light(orange[c], true), 2);
            image_destroy(image);
        }
    shots_forget(plan);
    shots_forget(without);
}

static void solid_points_cover_their_voxel_in_the_light_worked_out_before(void **state)
{
    (void)state;
    static const float positions[3] = { -10, 0, 5 }, normal[3] = { 0, -1, 0 };
    struct plan *plan = make_plan();
    put(plan, REPRESENTATION_SOLID, make_points(positions, normal, (uint8_t[]){ 100 }, 1));
    static const struct {
        struct vec3 from, up;
        double width_mm, height_mm; /* a voxel of 4 x 3 x 2 mm seen from there */
    } sides[] = { { { 0, -1, 0 }, { 0, 0, 1 }, 4, 2 },
                  { { 1, 0, 0 }, { 0, 0, 1 }, 3, 2 },
                  { { 0, 0, -1 }, { 0, -1, 0 }, 4, 3 } };
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        for (int is_live = 0; is_live < 2; is_live++) {
            struct scene scene = scene_as(plan, SCENE_REPRESENTATION_SOLID);
            shots_style(&scene, "plate")->visible = false;
            scene.points.solid = is_live ? SCENE_SOLID_LIGHTING_LIVE : SCENE_SOLID_LIGHTING_BAKED;
            struct image *image =
                shots_plain(plan, scene, shots_view_from(vec3(-10, 0, 5), sides[i].from, sides[i].up, 10));
            double x, y;
            size_t n = drawn(image, &x, &y);
            assert_close((double)n, sides[i].width_mm * sides[i].height_mm * 100, 0.13 * 800); /* a pixel around it */
            const uint8_t *pixel = shots_pixel(image, 200, 150);
            for (int c = 0; c < 3 && (!is_live || i == 0); c++)
                assert_close(pixel[c], 255 * (is_live ? shots_facing_light(orange[c], true) : orange[c] * 100 / 255),
                             2);
            image_destroy(image);
        }
    shots_forget(plan);
}

/* ---- triangles -------------------------------------------------------------------------------------------------- */

/* One triangle with wrong vertex normals, which faceted shading must not use. */
static struct shape *make_triangle(bool is_faceted)
{
    static const float positions[9] = { -25, 0, -20, -5, 0, -20, -15, 0, 20 },
                       normals[9] = { 1, 0, 0, 1, 0, 0, 1, 0, 0 };
    struct error err = { 0 };
    struct shape *shape = mem_new(sizeof *shape);
    shape->kind = SHAPE_TRIANGLES;
    shape->is_faceted = is_faceted;
    shape->mesh = mesh_create(3, 1, &err);
    memcpy(shape->mesh->positions_lps_mm, positions, sizeof positions);
    shape->mesh->normals = copy_floats(normals, 9);
    for (uint32_t i = 0; i < 3; i++)
        shape->mesh->indices[i] = i;
    mesh_measure_bounds(shape->mesh);
    shape->bounds_lps_mm = shape->mesh->bounds_lps_mm;
    return shape;
}

static void open_surfaces_are_seen_from_both_sides_and_closed_ones_from_outside(void **state)
{
    (void)state;
    static const struct {
        enum region_representation representation;
        enum scene_representation asked;
        bool is_faceted, is_two_sided;
    } kinds[] = { { REPRESENTATION_FAN, SCENE_REPRESENTATION_FAN, true, true },
                  { REPRESENTATION_NURBS, SCENE_REPRESENTATION_NURBS, false, true },
                  { REPRESENTATION_UNIVELS, SCENE_REPRESENTATION_UNIVELS, true, false } };
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        struct plan *plan = make_plan();
        put(plan, kinds[k].representation, make_triangle(kinds[k].is_faceted));
        for (int side = 0; side < 2; side++) {
            struct scene scene = scene_as(plan, kinds[k].asked);
            shots_style(&scene, "plate")->visible = false;
            scene.surface.normals = SCENE_NORMALS_FACE; /* univels are rounded off a little else */
            struct image *image = shots_plain(plan, scene, shots_view_from(origin, vec3(0, side ? 1 : -1, 0), up, 6));
            const uint8_t *pixel = shots_pixel(image, side ? 200 + 90 : 200 - 90, 150 + 20); /* its front faces y < 0 */
            if (side && !kinds[k].is_two_sided)
                assert_memory_equal(pixel, shots_background, 3);
            else if (kinds[k].is_faceted)
                for (int c = 0; c < 3; c++)
                    assert_close(pixel[c], 255 * shots_facing_light(orange[c], true), 2);
            else
                assert_memory_not_equal(pixel, shots_background, 3);
            image_destroy(image);
        }
        shots_forget(plan);
    }
}

/* ---- translucent, and the same everywhere ----------------------------------------------------------------------- */

static void translucent_points_and_lines_show_what_lies_behind(void **state)
{
    (void)state;
    static const float ends[6] = { -20, 0, 0, 20, 0, 0 }, middle[3] = { 0, -25, 0 }, normal[3] = { 0, -1, 0 };
    for (int is_line = 0; is_line < 2; is_line++) {
        struct plan *plan = make_plan();
        put(plan, REPRESENTATION_OUTLINE, make_lines(ends, 2));
        put(plan, REPRESENTATION_POINTS, make_points(middle, normal, (uint8_t[]){ 255 }, 1));
        struct scene scene = scene_as(plan, is_line ? SCENE_REPRESENTATION_OUTLINE : SCENE_REPRESENTATION_POINTS);
        shots_style(&scene, "shown")->opacity = 0.5;
        scene.outline.width_px = scene.points.size_px = 8;
        struct image *image = shots_plain(plan, scene, shots_view_from(vec3(-0.5, 0, 0), from_front, up, 6));
        int at = is_line ? 200 - 60 : 200;
        for (int c = 0; c < 3; c++) {
            double over = is_line ? orange[c] : shots_facing_light(orange[c], false);
            assert_close(shots_pixel(image, at, 150)[c], 255 * 0.5 * over + 0.5 * shots_background[c], 2);
        }
        image_destroy(image);
        shots_forget(plan);
    }
}

static uint32_t next_random(uint32_t *state)
{
    return *state = *state * 1664525u + 1013904223u;
}

/* A thousand lines and points across the eye's plane, the borders of the picture and each other. */
static void every_back_end_draws_the_same(void **state)
{
    (void)state;
    enum { N = 1000 };
    float positions[3 * N], normals[3 * N];
    uint8_t shade[N];
    uint32_t random = 7;
    for (size_t i = 0; i < 3 * N; i++) {
        positions[i] = (float)(next_random(&random) >> 8) / (float)(1 << 24) * 60 - 30;
        normals[i] = i % 3 == 1 ? -1 : 0;
    }
    for (size_t i = 0; i < N; i++)
        shade[i] = (uint8_t)(next_random(&random) >> 24);
    struct error err = { 0 };
    struct renderer *soft = renderer_create(RENDER_SOFT, &err), *tested = shots_renderer;
    for (int kind = 0; kind < 3; kind++)
        for (int way = 0; way < 4; way++) {
            static const enum scene_representation asked[] = { SCENE_REPRESENTATION_OUTLINE,
                                                               SCENE_REPRESENTATION_POINTS,
                                                               SCENE_REPRESENTATION_SOLID };
            struct image *images[2];
            struct plan *plan = make_plan();
            put(plan, REPRESENTATION_OUTLINE, make_lines(positions, N));
            put(plan, REPRESENTATION_POINTS, make_points(positions, normals, shade, N));
            put(plan, REPRESENTATION_SOLID, make_points(positions, normals, shade, N));
            for (int i = 0; i < 2; i++) {
                struct scene scene = scene_as(plan, asked[kind]);
                shots_style(&scene, "shown")->opacity = way & 1 ? 0.6 : 1;
                scene.points.size_px = 3;
                struct view view = shots_view_from(origin, vec3(0.3, -1, 0.2), up, 6);
                view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
                view.camera.has_height_mm = false;
                view.camera.position_mm = way & 2 ? vec3(4, -10, 3) : vec3(40, -100, 30);
                struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, way == 1 };
                shots_renderer = i ? soft : tested;
                images[i] = shots_take(plan, scene, view, &options, NULL);
            }
            shots_renderer = tested;
            size_t n = (size_t)SHOTS_WIDTH * SHOTS_HEIGHT, n_far = 0;
            for (size_t i = 0; i < n; i++)
                for (size_t c = 0; c < 3; c++)
                    if (abs(images[0]->rgba[4 * i + c] - images[1]->rgba[4 * i + c]) > 8) {
                        n_far++;
                        break;
                    }
            if (n_far > n / 100)
                printf("  kind %d, way %d: %zu pixels differ\n", kind, way, n_far);
            assert_true(
                n_far <=
                n / 100); /* back ends round vertices differently, so some edge pixels of a thousand shapes differ */
            image_destroy(images[0]);
            image_destroy(images[1]);
            renderer_forget(soft, plan);
            shots_forget(plan);
        }
    renderer_destroy(soft);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_is_as_wide_as_the_scene_says_in_its_regions_colour),
        cmocka_unit_test(lines_behind_something_are_hidden_and_far_ones_are_darker),
        cmocka_unit_test(a_line_through_the_eyes_plane_is_cut_there),
        cmocka_unit_test(points_are_squares_of_the_size_the_scene_says),
        cmocka_unit_test(solid_points_cover_their_voxel_in_the_light_worked_out_before),
        cmocka_unit_test(open_surfaces_are_seen_from_both_sides_and_closed_ones_from_outside),
        cmocka_unit_test(translucent_points_and_lines_show_what_lies_behind),
        cmocka_unit_test(every_back_end_draws_the_same),
    };
    return shots_run("shapes", tests, sizeof tests / sizeof tests[0]);
}
