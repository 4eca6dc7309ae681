/* Pictures of a volume by OpenGL and by our own rasteriser: both follow the rule of core/render/visible/draw.h, so that
 * what they differ by is rounding. */
#include "tests/render/shots.h"

enum { WIDTH = 200, HEIGHT = 150 };
static const struct vec3 origin = { 0, 0, 0 }, up = { 0, 0, 1 }, aslant = { 0.5, -1, 0.4 };

/* A head of a kind: skin, bone, brain with a harder ball in it, in HU, all with soft borders. */
static double shell(struct vec3 p, double radius_mm)
{
    return 1 / (1 + exp((vec3_length(vec3(p.x / 0.8, p.y, p.z / 0.9)) - radius_mm) * 1.5));
}
static double head_hu(struct vec3 p)
{
    double ball = 1 / (1 + exp((vec3_length(vec3_sub(p, vec3(8, -6, 10))) - 7) * 2));
    return -1000 + 1040 * shell(p, 40) + 900 * shell(p, 36) - 910 * shell(p, 31) + 300 * ball + 20 * sin(p.x * 0.7);
}

/* A ball around the head's front, and a plate behind it. */
static double labels(struct vec3 p)
{
    return vec3_length(vec3_sub(p, vec3(10, -30, 5))) < 14   ? 1
           : fabs(p.y - 20) < 3 && fabs(p.x) < 45 && p.z < 0 ? 2
                                                             : 0;
}
static const struct made_region regions[] = { { "ball", -1, 0xff4040 }, { "plate", -1, 0x4060ff } };

static struct plan *head_plan(enum voxel_type type)
{
    const uint32_t size[3] = { 61, 72, 40 };
    struct affine map = made_affine(vec3(1.5, 0.1, 0), vec3(-0.1, 1.4, 0.15), vec3(0.2, 0, 2.6), size, origin);
    struct grid grid = made_grid(size[0], size[1], size[2], map), label_grid = made_cube_grid(100);
    struct plan *plan = made_plan(&label_grid, labels, regions, 2);
    made_plan_add_image(plan, &grid, type, head_hu);
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    return plan;
}

static const struct scene_transfer_point bone[] = { { 150, 0xc08a6a, 0 },
                                                    { 350, 0xe6d3b2, 0.2 },
                                                    { 900, 0xffffff, 0.9 } };
static const struct scene_transfer_point soft_tissue[] = {
    { -300, 0xc98f6f, 0 }, { -100, 0xe3b294, 0.1 }, { 80, 0xd07a66, 0.02 }, { 300, 0xf5ead6, 0.3 }
};

struct look {
    enum scene_volume_method method;
    bool is_bone, is_shaded, is_nearest, is_perspective, is_clipped, has_regions, is_still;
    double gamma;                    /* 0: 1 */
    struct scene_light_style lights; /* of intensity 0: the usual ones */
};

static struct scene scene_of(const struct plan *plan, const struct look *look)
{
    struct scene scene = shots_scene(plan);
    struct scene_volume_style *volume = &scene.image.volume;
    const struct scene_transfer_point *points = look->is_bone ? bone : soft_tissue;
    size_t n = look->is_bone ? sizeof bone / sizeof bone[0] : sizeof soft_tissue / sizeof soft_tissue[0];
    free(volume->points);
    volume->points = mem_new(n * sizeof *points);
    memcpy(volume->points, points, n * sizeof *points);
    volume->n_points = n;
    volume->visible = true;
    volume->method = look->method;
    volume->shaded = look->is_shaded;
    volume->interpolation = look->is_nearest ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
    if (look->method != SCENE_VOLUME_METHOD_RAY)
        volume->cull_below = look->method == SCENE_VOLUME_METHOD_SLICES ? -200 : -900;
    scene.image.window =
        (struct scene_window){ .center = 100, .width = 1500, .gamma = look->gamma > 0 ? look->gamma : 1 };
    if (look->lights.intensity > 0)
        scene.lights = look->lights;
    if (look->is_clipped) {
        scene.clip.axial_high = (struct scene_clip_axis){ true, 9, true };
        scene.clip.sagittal_high = (struct scene_clip_axis){ true, 14, false };
    }
    for (int i = 0; i < 2; i++) {
        scene.regions[i].value.visible = look->has_regions;
        scene.regions[i].value.clipped = false;
    }
    shots_style(&scene, "ball")->opacity = 0.5;
    return scene;
}

static struct image *take(struct plan *plan, const struct look *look)
{
    struct view view = shots_view_from(origin, aslant, up, 1.4);
    view.size_px[0] = WIDTH;
    view.size_px[1] = HEIGHT;
    view.camera.height_mm = HEIGHT / 1.4;
    if (look->is_perspective) {
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.position_mm = vec3_scale(aslant, 180);
    }
    const struct render_options options = { WIDTH, HEIGHT, SURFACE_FULL, look->is_still };
    return shots_take(plan, scene_of(plan, look), view, &options, NULL);
}

static bool is_drawn(const uint8_t *pixel)
{
    return memcmp(pixel, shots_background, 3) != 0;
}

/* Peak signal-to-noise ratio over the pixels in which one of the two shows something, dB; n: number of these. */
static double psnr_db(const struct image *a, const struct image *b, size_t *n)
{
    double squares = 0;
    *n = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const uint8_t *p = shots_pixel(a, x, y), *q = shots_pixel(b, x, y);
            *n += is_drawn(p) || is_drawn(q);
            for (int c = 0; c < 3; c++)
                squares += (p[c] - q[c]) * (p[c] - q[c]);
        }
    return 10 * log10(255.0 * 255 * 3 * (double)*n / fmax(squares, 1));
}

static void expect_agreement(const struct look *look, enum voxel_type type, size_t least_drawn)
{
    struct error err = { 0 };
    const struct render_facts *facts = renderer_facts(shots_renderer);
    if (facts->back_end == RENDER_SOFT || (facts->is_software && facts->back_end != RENDER_OSMESA))
        skip(); /* Mesa's software driver is the same behind EGL and OSMesa */
    struct renderer *tested = shots_renderer, *soft = renderer_create(RENDER_SOFT, &err);
    assert_string_equal(err.text, "");
    struct plan *plan = head_plan(type);
    struct image *theirs = take(plan, look);
    renderer_forget(tested, plan);
    shots_renderer = soft;
    struct image *ours = take(plan, look);
    shots_forget(plan);
    shots_renderer = tested;
    size_t n_drawn;
    double db = psnr_db(ours, theirs, &n_drawn);
    if (db < 40)
        fail_msg("%.1f dB over %zu pixels", db, n_drawn);
    assert_true(n_drawn >= least_drawn);
    image_destroy(ours);
    image_destroy(theirs);
    renderer_destroy(soft);
}

static void rays_agree(void **state)
{
    (void)state;
    const struct look looks[] = {
        { .is_bone = true, .is_shaded = true },
        { .is_shaded = true, .is_perspective = true },
        { .is_perspective = true, .is_nearest = true },
        { .is_bone = true, .is_shaded = true, .is_still = true, .is_nearest = true },
    };
    for (size_t i = 0; i < sizeof looks / sizeof looks[0]; i++)
        expect_agreement(&looks[i], (enum voxel_type)(i == 0 ? VOXEL_F32 : VOXEL_I16), 5000);
}

static void cuts_through_a_volume_agree(void **state)
{
    (void)state;
    expect_agreement(&(struct look){ .is_shaded = true, .is_clipped = true, .is_perspective = true }, VOXEL_I16, 4000);
    expect_agreement(&(struct look){ .is_bone = true, .is_clipped = true, .is_still = true }, VOXEL_I16, 4000);
}

static void layers_and_opaque_surfaces_in_a_volume_agree(void **state)
{
    (void)state;
    expect_agreement(&(struct look){ .is_shaded = true, .has_regions = true, .is_perspective = true }, VOXEL_I16, 5000);
    expect_agreement(&(struct look){ .has_regions = true, .is_clipped = true }, VOXEL_I16, 4000);
}

static void slices_and_projections_agree(void **state)
{
    (void)state;
    for (int method = SCENE_VOLUME_METHOD_SLICES; method <= SCENE_VOLUME_METHOD_AVERAGE; method++)
        for (int has_regions = 0; has_regions < 2; has_regions++)
            expect_agreement(&(struct look){ .method = (enum scene_volume_method)method,
                                             .has_regions = has_regions,
                                             .is_nearest = has_regions,
                                             .is_perspective = method == SCENE_VOLUME_METHOD_SLICES },
                             VOXEL_I16, 5000);
}

static void other_lights_and_greys_agree(void **state)
{
    (void)state;
    const struct scene_light_style low = { SCENE_LIGHT_FRAME_VIEWER, -70, -10, 1.6, 0.1 },
                                   left = { SCENE_LIGHT_FRAME_PATIENT, 90, 20, 0.8, 0.4 };
    expect_agreement(&(struct look){ .is_shaded = true, .lights = low, .has_regions = true }, VOXEL_I16, 5000);
    expect_agreement(&(struct look){ .is_bone = true, .is_shaded = true, .lights = left, .is_perspective = true },
                     VOXEL_I16, 5000);
    expect_agreement(&(struct look){ .method = SCENE_VOLUME_METHOD_AVERAGE, .gamma = 1.8 }, VOXEL_I16, 5000);
    expect_agreement(&(struct look){ .is_shaded = true, .is_clipped = true, .gamma = 0.6 }, VOXEL_I16, 4000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_agree),
        cmocka_unit_test(cuts_through_a_volume_agree),
        cmocka_unit_test(layers_and_opaque_surfaces_in_a_volume_agree),
        cmocka_unit_test(slices_and_projections_agree),
        cmocka_unit_test(other_lights_and_greys_agree),
    };
    return shots_run("volume_agree", tests, sizeof tests / sizeof tests[0]);
}
