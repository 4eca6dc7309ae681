/* Draws the pictures of the render tests, and measures in them. */
#include "tests/render/shots.h"

struct renderer *shots_renderer;
const uint8_t shots_background[3] = { 0x08, 0x09, 0x0b };

/* Mesa's software driver behind EGL. */
static bool is_osmesa_too(const struct renderer *renderer)
{
    const struct render_facts *facts = renderer_facts(renderer);
    return facts->is_software && facts->back_end != RENDER_OSMESA && facts->back_end != RENDER_SOFT;
}

static int run_from(int first, bool is_driver_once, const char *name, const struct CMUnitTest *tests, size_t n_tests)
{
    int n_failed = 0;
    for (int back_end = first; back_end < RENDER_N_BACK_ENDS; back_end++) {
        struct error err = { 0 };
        shots_renderer = renderer_create((enum render_back_end)back_end, &err);
        if (!shots_renderer) {
            printf("not here: %s\n", err.text);
            continue;
        }
        if (is_driver_once && is_osmesa_too(shots_renderer)) {
            renderer_destroy(shots_renderer);
            continue;
        }
        char group[128];
        snprintf(group, sizeof group, "%s, %s", name, render_back_end_word((enum render_back_end)back_end));
        printf("%s: %s\n", group, renderer_facts(shots_renderer)->renderer);
        n_failed += _cmocka_run_group_tests(group, tests, n_tests, NULL, NULL);
        renderer_destroy(shots_renderer);
        shots_renderer = NULL;
    }
    return n_failed ? 1 : 0;
}

int shots_run(const char *name, const struct CMUnitTest *tests, size_t n_tests)
{
    return run_from(SHOTS_SANITIZED ? RENDER_SOFT : RENDER_EGL_DEVICE, false, name, tests, n_tests);
}

int shots_run_drivers(const char *name, const struct CMUnitTest *tests, size_t n_tests)
{
    return run_from(SHOTS_SANITIZED ? RENDER_SOFT : RENDER_EGL_DEVICE, true, name, tests, n_tests);
}

int shots_run_soft(const char *name, const struct CMUnitTest *tests, size_t n_tests)
{
    return run_from(RENDER_SOFT, false, name, tests, n_tests);
}

struct scene shots_scene(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.opacity = 1;
    scene.surface.algorithm = SCENE_ALGORITHM_MARCHING_CUBES; /* boxes have flat faces exactly where their voxels end */
    scene.image.slices.axial.visible = false;
    scene.image.cull_below = scene_image_style_default.cull_below; /* air too */
    return scene;
}

struct scene_region_style *shots_style(struct scene *scene, const char *id)
{
    for (size_t i = 0; i < scene->n_regions; i++)
        if (strcmp(scene->regions[i].id, id) == 0)
            return &scene->regions[i].value;
    fail_msg("no region %s", id);
    return NULL;
}

struct view shots_view(enum scene_kind kind, struct vec3 target_lps_mm, double pixels_per_mm)
{
    struct view view = view_default;
    view.kind = kind;
    view.size_px[0] = SHOTS_WIDTH;
    view.size_px[1] = SHOTS_HEIGHT;
    view.camera.projection = SCENE_PROJECTION_PARALLEL;
    view.camera.has_target_mm = true;
    view.camera.target_mm = target_lps_mm;
    view.camera.has_height_mm = true;
    view.camera.height_mm = SHOTS_HEIGHT / pixels_per_mm;
    return view;
}

struct view shots_view_from(struct vec3 target_lps_mm, struct vec3 from, struct vec3 up, double pixels_per_mm)
{
    struct view view = shots_view(SCENE_KIND_3D, target_lps_mm, pixels_per_mm);
    view.camera.has_position_mm = view.camera.has_up = true;
    view.camera.position_mm = vec3_add(target_lps_mm, vec3_scale(vec3_normalize(from), 500));
    view.camera.up = up;
    return view;
}

struct image *shots_take(struct plan *plan, struct scene scene, struct view view, const struct render_options *options,
                         struct render_timing *timing)
{
    struct error err = { 0 };
    struct camera camera;
    struct render_timing own_timing;
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    struct image *image =
        render_snapshot(shots_renderer, snapshot, options, &camera, timing ? timing : &own_timing, &err);
    assert_string_equal(err.text, "");
    assert_non_null(image);
    snapshot_unref(snapshot);
    return image;
}

struct image *shots_plain(struct plan *plan, struct scene scene, struct view view)
{
    struct render_options options = { view.size_px[0], view.size_px[1], SURFACE_FULL, false };
    return shots_take(plan, scene, view, &options, NULL);
}

void shots_forget(struct plan *plan)
{
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

const uint8_t *shots_pixel(const struct image *image, int x, int y)
{
    assert_in_range(x, 0, image->width_px - 1);
    assert_in_range(y, 0, image->height_px - 1);
    return &image->rgba[4 * ((size_t)y * (size_t)image->width_px + (size_t)x)];
}

void shots_expect_color(const uint8_t *pixel, const double color[3])
{
    for (int c = 0; c < 3; c++)
        assert_close(pixel[c], 255 * color[c], 2);
}

size_t shots_centroid(const struct image *image, int channel, double *x_px, double *y_px)
{
    size_t n = 0;
    double sum_x = 0, sum_y = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++) {
            const uint8_t *p = shots_pixel(image, x, y);
            if (p[channel] < p[(channel + 1) % 3] + 40 || p[channel] < p[(channel + 2) % 3] + 40)
                continue;
            n++;
            sum_x += x + 0.5;
            sum_y += y + 0.5;
        }
    *x_px = n ? sum_x / (double)n : -1;
    *y_px = n ? sum_y / (double)n : -1;
    return n;
}

double shots_facing_light(double color, bool is_opaque)
{
    return fmin(1, color * ((is_opaque ? 0.3 : 0.5) + 0.58 * 0.704 + 0.18 * 0.663) + 0.07 * pow(0.704, 16));
}
