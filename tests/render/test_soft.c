/* The software rasteriser's own promises: the same picture as OpenGL's, the same bytes on any processor and with any
 * number of threads, no cracks, exact clipping at the near plane. */
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const struct vec3 up = { 0, 0, 1 };
enum { SIDE = 96 };

/* A head like the demo plan's: nested ellipsoids with different middles, and a tumour inside its target. */
static double ellipsoid(struct vec3 p, double x, double y, double z, double rx, double ry, double rz)
{
    double a = (p.x - x) / rx, b = (p.y - y) / ry, c = (p.z - z) / rz;
    return a * a + b * b + c * c;
}
static double head_label(struct vec3 p)
{
    return ellipsoid(p, 12, -6, 10, 6, 6, 6) < 1      ? 5
           : ellipsoid(p, 12, -6, 10, 12, 12, 12) < 1 ? 4
           : ellipsoid(p, 0, 0, 4, 30, 36, 28) < 1    ? 3
           : ellipsoid(p, 0, 0, 2, 35, 41, 34) < 1    ? 2
           : ellipsoid(p, 0, 0, 0, 38, 45, 40) < 1    ? 1
                                                      : 0;
}
static double head_value(struct vec3 p)
{
    static const double values[] = { -1000, 20, 900, 40, 60, 140 };
    return values[(int)head_label(p)] + 30 * sin(p.x * 0.9) * sin(p.y * 0.7) * cos(p.z * 0.8);
}
static double float_value(struct vec3 p)
{
    return vec3_length(p) < 8 ? NAN : head_value(p);
}
static const struct made_region head[] = { { "scalp", -1, 0xd8a890 },
                                           { "cranium", 0, 0xe8dcc0 },
                                           { "brain", 1, 0xc890a0 },
                                           { "target", 2, 0xe0b040 },
                                           { "tumour", 3, 0x50c060 } };

/* Oblique voxels, so that no edge or slice falls on a row of the picture. */
static struct plan *make_head(enum voxel_type type)
{
    const uint32_t size[3] = { SIDE, SIDE, SIDE };
    double c = cos(0.3), s = sin(0.3);
    struct grid grid =
        made_grid(SIDE, SIDE, SIDE, made_affine(vec3(c, s, 0), vec3(-s, c, 0), vec3(0, 0, -1), size, origin));
    struct plan *plan = made_plan(&grid, head_label, head, 5);
    made_plan_add_image(plan, &grid, type, type == VOXEL_F32 ? float_value : head_value);
    return plan;
}

struct shot {
    const char *name;
    enum scene_kind kind;
    bool is_still, is_flat, is_nearest, is_colored, is_plain, has_slices, is_inside, is_parallel;
    enum scene_representation representation;
};

static struct image *take(struct renderer *renderer, struct plan *plan, const struct shot *shot, int width, int height)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    struct camera camera;
    struct render_timing timing = { 0 };
    struct render_options options = { width, height, SURFACE_FULL, shot->is_still };
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.representation = shot->representation;
    scene.surface.normals = shot->is_flat ? SCENE_NORMALS_FACE : SCENE_NORMALS_VERTEX;
    scene.surface.translucency = shot->is_plain ? SCENE_TRANSLUCENCY_PLAIN : SCENE_TRANSLUCENCY_RIM;
    scene.image.interpolation = shot->is_nearest ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
    scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = shot->has_slices;
    if (shot->is_colored) {
        scene.image.color_map = SCENE_COLOR_MAP_HOT_IRON;
        (void)snprintf(scene.image.blend.id, sizeof scene.image.blend.id, "%s", plan->images[0].id);
        scene.image.blend.opacity = 0.4;
    }
    scene.outline.on_slices = false; /* painted over the finished picture, by render.c */
    view.kind = shot->kind;
    view.size_px[0] = width;
    view.size_px[1] = height;
    if (shot->kind == SCENE_KIND_3D) {
        view.camera.has_target_mm = view.camera.has_position_mm = view.camera.has_up = true;
        view.camera.target_mm = vec3(1, -2, 3);
        view.camera.position_mm = shot->is_inside ? vec3(-9, -22, 8) : vec3(70, -130, 45);
        view.camera.up = up;
        view.camera.projection = shot->is_parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
    }
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    struct image *image = render_snapshot(renderer, snapshot, &options, &camera, &timing, &err);
    assert_string_equal(err.text, "");
    assert_non_null(image);
    snapshot_unref(snapshot);
    return image;
}

static const struct shot shots[] = {
    { .name = "moving", .kind = SCENE_KIND_3D, .has_slices = true },
    { .name = "still", .kind = SCENE_KIND_3D, .is_still = true, .has_slices = true },
    { .name = "flat and plain",
      .kind = SCENE_KIND_3D,
      .is_flat = true,
      .is_plain = true,
      .is_nearest = true,
      .has_slices = true },
    { .name = "parallel", .kind = SCENE_KIND_3D, .is_parallel = true, .has_slices = true },
    { .name = "from inside", .kind = SCENE_KIND_3D, .is_inside = true, .has_slices = true },
    { .name = "from inside, flat still", .kind = SCENE_KIND_3D, .is_inside = true, .is_flat = true, .is_still = true },
    { .name = "solid points, still",
      .kind = SCENE_KIND_3D,
      .is_still = true,
      .representation = SCENE_REPRESENTATION_SOLID },
    { .name = "solid points from inside",
      .kind = SCENE_KIND_3D,
      .is_inside = true,
      .has_slices = true,
      .representation = SCENE_REPRESENTATION_SOLID },
    { .name = "points", .kind = SCENE_KIND_3D, .representation = SCENE_REPRESENTATION_POINTS },
    { .name = "outlines, still",
      .kind = SCENE_KIND_3D,
      .is_still = true,
      .has_slices = true,
      .representation = SCENE_REPRESENTATION_OUTLINE },
    { .name = "fans", .kind = SCENE_KIND_3D, .is_parallel = true, .representation = SCENE_REPRESENTATION_FAN },
    { .name = "axial pane", .kind = SCENE_KIND_AXIAL },
    { .name = "axial pane, blended", .kind = SCENE_KIND_AXIAL, .is_colored = true },
    { .name = "slices, blended", .kind = SCENE_KIND_3D, .has_slices = true, .is_nearest = true, .is_colored = true },
    { .name = "coronal pane, nearest", .kind = SCENE_KIND_CORONAL, .is_nearest = true },
    { .name = "sagittal pane, still", .kind = SCENE_KIND_SAGITTAL, .is_still = true },
};
enum { N_SHOTS = sizeof shots / sizeof shots[0], WIDTH = 404, HEIGHT = 301 };

/* ---- the same as OpenGL ----------------------------------------------------------------------------------------- */

/* The back ends round vertices to different fractions of a sample, so pixels at edges may differ: those that differ by
 * more than 8 levels are counted; the others must agree within rounding. */
static void expect_like(const struct image *a, const struct image *b, const char *name)
{
    size_t n = (size_t)a->width_px * (size_t)a->height_px, n_far = 0;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        int most = 0, all = 0;
        for (size_t c = 0; c < 3; c++) {
            int d = abs(a->rgba[4 * i + c] - b->rgba[4 * i + c]);
            most = d > most ? d : most;
            all += d;
        }
        if (most > 8)
            n_far++;
        else
            sum += all / 3.0;
    }
    double mean = sum / (double)(n - n_far), far = (double)n_far / (double)n;
    printf("  %s: %.3f grey levels apart, %.3f %% of the pixels by more than 8\n", name, mean, 100 * far);
    assert_true(mean <
                0.3); /* a rounding to whole levels leaves a quarter of one on average, and later blends weaken it */
    assert_true(far < 0.004);
}

static struct renderer *open_gl(void)
{
    static const enum render_back_end order[] = { RENDER_EGL_DEVICE, RENDER_EGL_SURFACELESS, RENDER_OSMESA };
    for (size_t i = 0; !SHOTS_SANITIZED && i < sizeof order / sizeof order[0]; i++) {
        struct error err = { 0 };
        struct renderer *gl = renderer_create(order[i], &err);
        if (gl)
            return gl;
    }
    return NULL;
}

static void pictures_are_the_same_as_with_opengl(void **state)
{
    (void)state;
    struct renderer *gl = open_gl();
    if (!gl)
        skip();
    static const enum voxel_type types[] = { VOXEL_I16, VOXEL_F32 };
    for (int type = 0; type < 2; type++) {
        struct renderer *soft = renderer_create(RENDER_SOFT, NULL);
        struct plan *plan = make_head(types[type]);
        for (size_t i = 0; i < N_SHOTS; i++) {
            struct image *a = take(soft, plan, &shots[i], WIDTH, HEIGHT), *b = take(gl, plan, &shots[i], WIDTH, HEIGHT);
            expect_like(a, b, shots[i].name);
            image_destroy(a);
            image_destroy(b);
        }
        renderer_forget(gl, plan);
        renderer_destroy(soft);
        plan_and_derived_destroy(plan);
    }
    renderer_destroy(gl);
}

/* ---- the same bytes --------------------------------------------------------------------------------------------- */

static void threads_and_processors_make_no_difference(void **state)
{
    (void)state;
    static const struct {
        int n_threads;
        bool is_portable;
    } ways[] = { { 1, false }, { 2, false }, { 5, false }, { 1, true }, { 3, true } };
    struct plan *plan = make_head(VOXEL_I16);
    for (size_t i = 0; i < N_SHOTS; i++) {
        struct image *first = NULL;
        for (size_t way = 0; way < sizeof ways / sizeof ways[0]; way++) {
            struct renderer *soft = renderer_create(RENDER_SOFT, NULL);
            renderer_tune(soft, ways[way].n_threads, ways[way].is_portable);
            struct image *image = take(soft, plan, &shots[i], WIDTH, HEIGHT);
            if (first) {
                assert_memory_equal(first->rgba, image->rgba, (size_t)WIDTH * HEIGHT * 4);
                image_destroy(image);
            } else
                first = image;
            renderer_destroy(soft);
        }
        image_destroy(first);
    }
    plan_and_derived_destroy(plan);
}

static void pictures_of_other_sizes_leave_nothing_behind(void **state)
{
    (void)state;
    static const int sizes[][2] = { { 64, 48 }, { IMAGE_MAX_SIDE_PX, 17 }, { 1, 1 }, { 9, 200 }, { 500, 333 } };
    struct plan *plan = make_head(VOXEL_U8);
    struct renderer *used = renderer_create(RENDER_SOFT, NULL);
    for (int round = 0; round < 2; round++)
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            struct renderer *fresh = renderer_create(RENDER_SOFT, NULL);
            struct image *a = take(used, plan, &shots[i], sizes[i][0], sizes[i][1]);
            struct image *b = take(fresh, plan, &shots[i], sizes[i][0], sizes[i][1]);
            assert_memory_equal(a->rgba, b->rgba, (size_t)sizes[i][0] * (size_t)sizes[i][1] * 4);
            image_destroy(a);
            image_destroy(b);
            renderer_destroy(fresh);
        }
    renderer_destroy(used);
    plan_and_derived_destroy(plan);
}

/* ---- coverage --------------------------------------------------------------------------------------------------- */

static double ball_label(struct vec3 p)
{
    return vec3_length(p) <= 30 ? 1 : 0;
}
static const struct made_region ball[] = { { "ball", -1, 0xffffff } };

/* A ball of a few thousand triangles, from so close that they are large to so far that most of them hold no sample: no
 * sample inside its disc is left out. */
static void closed_surfaces_have_no_cracks(void **state)
{
    (void)state;
    static const double distances_mm[] = { 45, 100, 400, 3000 };
    struct grid grid = made_cube_grid(70);
    struct plan *plan = made_plan(&grid, ball_label, ball, 1);
    for (size_t i = 0; i < sizeof distances_mm / sizeof distances_mm[0]; i++) {
        struct view view = shots_view_from(origin, vec3(0.31, -1, 0.17), up, 1);
        double d = distances_mm[i];
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.has_height_mm = false;
        view.camera.fov_deg = 60;
        view.camera.position_mm = vec3_scale(vec3_normalize(vec3(0.31, -1, 0.17)), d);
        struct image *image = shots_plain(plan, shots_scene(plan), view);
        /* a ball of radius 29, half a voxel's diagonal inside the surface, covers a disc of this radius */
        double radius_px = SHOTS_HEIGHT / 2.0 / tan(MATH_PI * 30 / 180) * tan(asin(29 / d));
        size_t n_inside = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++)
                if (hypot(x + 0.5 - SHOTS_WIDTH / 2.0, y + 0.5 - SHOTS_HEIGHT / 2.0) < radius_px) {
                    n_inside++;
                    assert_memory_not_equal(shots_pixel(image, x, y), shots_background, 3);
                }
        assert_true(n_inside > 4);
        image_destroy(image);
    }
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

static double cube_label(struct vec3 p)
{
    return fabs(p.x) < 20 && fabs(p.y) < 20 && fabs(p.z) < 20 ? 1 : 0;
}

/* The whole picture is one face of a cube, so near that a voxel's triangles are larger than the picture: triangles that
 * reach beyond the rasteriser's range are clipped without a gap. */
static void a_face_close_to_the_eye_fills_the_picture(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(60);
    struct plan *plan = made_plan(&grid, cube_label, ball, 1);
    struct view view = shots_view_from(vec3(0.3, 0, 0.2), vec3(0, -1, 0), up, 2000); /* 2000 pixels a millimetre */
    struct image *image = shots_plain(plan, shots_scene(plan), view);
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++)
            assert_memory_equal(shots_pixel(image, x, y), shots_pixel(image, 0, 0), 4);
    assert_memory_not_equal(shots_pixel(image, 0, 0), shots_background, 3);
    image_destroy(image);
    view = shots_view_from(vec3(0.3, 0, 0.2), vec3(0, -1, 0), up, 20000); /* beyond the clipper's borders */
    image = shots_plain(plan, shots_scene(plan), view);
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++)
            assert_memory_equal(shots_pixel(image, x, y), shots_pixel(image, 0, 0), 4);
    assert_memory_not_equal(shots_pixel(image, 0, 0), shots_background, 3);
    image_destroy(image);
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

static void pictures_beyond_the_limit_are_refused(void **state)
{
    (void)state;
    static const int sizes[][2] = { { 0, 10 }, { 10, -1 }, { IMAGE_MAX_SIDE_PX + 1, 10 }, { INT32_MAX, INT32_MAX } };
    struct plan *plan = make_head(VOXEL_I16);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct scene scene;
        struct view view = view_default;
        struct error err = { 0 };
        char field[128];
        struct camera camera;
        struct render_timing timing;
        scene_for_plan(plan, &scene);
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        assert_null(render_snapshot(shots_renderer, snapshot,
                                    &(struct render_options){ sizes[i][0], sizes[i][1], SURFACE_FULL, true }, &camera,
                                    &timing, &err));
        assert_int_equal(err.code, ERROR_RANGE);
        snapshot_unref(snapshot);
    }
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_same_as_with_opengl),
        cmocka_unit_test(threads_and_processors_make_no_difference),
        cmocka_unit_test(pictures_of_other_sizes_leave_nothing_behind),
        cmocka_unit_test(closed_surfaces_have_no_cracks),
        cmocka_unit_test(a_face_close_to_the_eye_fills_the_picture),
        cmocka_unit_test(pictures_beyond_the_limit_are_refused),
    };
    struct error err = { 0 };
    shots_renderer = renderer_create(RENDER_SOFT, &err);
    printf("%s\n", renderer_facts(shots_renderer)->renderer);
    int n_failed = cmocka_run_group_tests(tests, NULL, NULL);
    renderer_destroy(shots_renderer);
    return n_failed ? 1 : 0;
}
