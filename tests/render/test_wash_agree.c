/* Pictures of dose by OpenGL and by our own rasteriser: both follow core/render/visible/draw_wash.h and the textures of
 * core/render/visible/draw.h, so that what they differ by is rounding. */
#include "core/scene/dose_choice.h"
#include "tests/render/dose_scene.h"

enum what { PANE, SLICES, OBLIQUE, CAP, SURFACE, IMAGE_ON_SURFACE, VOLUME };

struct look {
    enum what what;
    bool is_smooth, is_per_slice, is_weighted, is_perspective, is_nearest, has_colors, is_clipped, is_still;
    enum scene_representation representation;
    double opacity; /* of the regions */
    enum scene_volume_method method;
};

/* Sets a level every 8 Gy of the total, every 3 of the weighted dose. */
static void set_levels(struct scene *scene, bool is_weighted)
{
    static const uint32_t colors[] = { 0x2040ff, 0x20c0e0, 0x30d040, 0xf0e020, 0xff8010, 0xff2020 };
    free(scene->dose.levels);
    scene->dose.n_levels = sizeof colors / sizeof colors[0];
    scene->dose.levels = mem_new(sizeof colors / sizeof colors[0] * sizeof *scene->dose.levels);
    for (size_t i = 0; i < scene->dose.n_levels; i++) {
        snprintf(scene->dose.levels[i].id, sizeof scene->dose.levels[i].id, "l%zu", i);
        scene->dose.levels[i].value = scene_dose_level_default;
        scene->dose.levels[i].value.visible = scene->dose.levels[i].value.wash = true;
        scene->dose.levels[i].value.unit = SCENE_DOSE_UNIT_DOSE;
        scene->dose.levels[i].value.value = is_weighted ? 2 + 5 * (double)i : 8 + 8 * (double)i;
        scene->dose.levels[i].value.color_rgb = colors[i];
    }
}

static void set_dose(struct scene *scene, const struct look *look)
{
    set_levels(scene, look->is_weighted);
    scene->dose.quantity = look->is_weighted ? SCENE_DOSE_QUANTITY_WEIGHTED : SCENE_DOSE_QUANTITY_TOTAL;
    scene->dose.blood_ppm = 20;
    scene->dose.interpolation = look->is_per_slice ? SCENE_DOSE_INTERPOLATION_SLICE : SCENE_DOSE_INTERPOLATION_LINEAR;
    free(scene->dose.weights);
    scene->dose.n_weights = 2;
    scene->dose.weights = mem_new(2 * sizeof *scene->dose.weights);
    for (int i = 0; i < 2; i++) {
        snprintf(scene->dose.weights[i].id, sizeof scene->dose.weights[i].id, i ? "target" : "body");
        scene->dose.weights[i].value = scene_tissue_weights_default;
        scene->dose.weights[i].value.boron_ratio = i ? 3 : 1;
        scene->dose.weights[i].value.cbe = 1;
    }
    scene->dose.wash = (struct scene_dose_wash){
        .visible = true, .opacity = 0.6, .style = look->is_smooth ? SCENE_WASH_STYLE_SMOOTH : SCENE_WASH_STYLE_BANDS
    };
}

static void set_regions(struct scene *scene, const struct look *look)
{
    for (size_t i = 0; i < scene->n_regions; i++) {
        struct scene_region_style *style = &scene->regions[i].value;
        style->visible = look->what >= CAP && (look->what < VOLUME || look->opacity > 0);
        style->opacity = look->opacity;
        style->texture = look->what == SURFACE            ? SCENE_TEXTURE_DOSE
                         : look->what == IMAGE_ON_SURFACE ? SCENE_TEXTURE_IMAGE
                                                          : SCENE_TEXTURE_NONE;
        style->representation = look->representation;
    }
}

/* Values 40 to 160: what is above 90 is there. */
static void set_volume(struct scene *scene, const struct look *look)
{
    static const struct scene_transfer_point points[] = { { 80, 0x806040, 0 }, { 120, 0xf0e0d0, 0.3 } };
    struct scene_volume_style *volume = &scene->image.volume;
    free(volume->points);
    volume->points = mem_new(sizeof points);
    memcpy(volume->points, points, sizeof points);
    volume->n_points = 2;
    volume->visible = true;
    volume->method = look->method;
    volume->shaded = look->is_smooth;
    volume->cull_below = 90;
    volume->interpolation = look->is_nearest ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
    scene->dose.wash.volume = !look->is_clipped || look->method == SCENE_VOLUME_METHOD_SLICES;
    scene->clip.sagittal_high.cap = look->is_clipped;
}

static struct scene scene_of(const struct plan *plan, const void *context)
{
    const struct look *look = context;
    struct scene scene = dose_scene(plan);
    set_dose(&scene, look);
    set_regions(&scene, look);
    scene.image.interpolation = look->is_nearest ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
    if (look->has_colors)
        scene.image.color_map = SCENE_COLOR_MAP_HOT_IRON;
    scene.image.slices.axial = (struct scene_slice){ look->what == SLICES, 1.1 };
    scene.image.slices.sagittal = (struct scene_slice){ look->what == SLICES, 2.2 };
    if (look->what == OBLIQUE) {
        scene.image.obliques = mem_new(sizeof *scene.image.obliques);
        scene.image.n_obliques = 1;
        snprintf(scene.image.obliques[0].id, sizeof scene.image.obliques[0].id, "o");
        scene.image.obliques[0].value =
            (struct scene_oblique){ .visible = true, .origin_mm = { 1, 2, 3 }, .normal = { 0.3, -0.8, 0.6 } };
    }
    if (look->what == CAP || look->is_clipped)
        scene.clip.axial_high = (struct scene_clip_axis){ true, 4.4, true };
    if (look->is_clipped)
        scene.clip.sagittal_high = (struct scene_clip_axis){ true, 14, look->what == CAP };
    if (look->what == VOLUME)
        set_volume(&scene, look);
    scene.clip.cap.regions = look->what == CAP && look->has_colors;
    return scene;
}

static void expect(const struct look *look)
{
    struct view view = shots_view_from(vec3(1, 2, 1.1), vec3(0.5, -1, 0.9), vec3(0, 0, 1), 3);
    if (look->what == PANE)
        view = shots_view(SCENE_KIND_CORONAL, vec3(1, 2, 1.1), 3.1);
    if (look->is_perspective) {
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.position_mm = vec3(70, -115, 110);
    }
    dose_scene_expect_agreement(scene_of, look, view, look->is_still, 9000);
}

static void slice_panes_agree(void **state)
{
    (void)state;
    for (int i = 0; i < 16; i++)
        expect(&(struct look){ .what = PANE,
                               .is_smooth = i & 1,
                               .is_weighted = i & 2,
                               .is_per_slice = i & 4,
                               .has_colors = i & 8,
                               .is_nearest = i % 3 == 0,
                               .is_still = i % 5 == 0 });
}

static void planes_in_space_agree(void **state)
{
    (void)state;
    for (int i = 0; i < 16; i++)
        expect(&(struct look){ .what = i & 1 ? SLICES : OBLIQUE,
                               .is_weighted = i & 2,
                               .is_smooth = i & 4,
                               .is_perspective = i & 8,
                               .is_clipped = i % 3 == 0,
                               .is_per_slice = i % 5 == 0,
                               .is_still = i % 7 == 0 });
}

static void caps_agree(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++)
        expect(&(struct look){ .what = CAP,
                               .opacity = 1,
                               .is_weighted = i & 1,
                               .has_colors = i & 2,
                               .is_perspective = i & 4,
                               .is_clipped = i % 3 == 0,
                               .is_smooth = i % 2 == 0 });
}

static void surfaces_agree(void **state)
{
    (void)state;
    static const enum scene_representation representations[] = { SCENE_REPRESENTATION_SURFACE,
                                                                 SCENE_REPRESENTATION_UNIVELS };
    for (int i = 0; i < 16; i++)
        expect(&(struct look){ .what = i & 1 ? IMAGE_ON_SURFACE : SURFACE,
                               .representation = representations[i >> 1 & 1],
                               .opacity = i & 4 ? 0.5 : 1,
                               .is_weighted = i & 8,
                               .has_colors = i % 3 == 0,
                               .is_perspective = i % 3 == 1,
                               .is_clipped = i % 4 == 3,
                               .is_smooth = i % 5 == 0,
                               .is_nearest = i % 5 == 1,
                               .is_still = i % 7 == 0 });
}

static void volumes_agree(void **state)
{
    (void)state;
    for (int i = 0; i < 16; i++)
        expect(&(struct look){ .what = VOLUME,
                               .method = i & 1 ? SCENE_VOLUME_METHOD_SLICES : SCENE_VOLUME_METHOD_RAY,
                               .is_smooth = i & 2,
                               .is_clipped = i & 4,
                               .is_weighted = i & 8,
                               .is_perspective = i % 3 == 0,
                               .opacity = i % 5 == 0 ? 0.5 : 0,
                               .is_per_slice = i % 7 == 0 });
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slice_panes_agree), cmocka_unit_test(planes_in_space_agree), cmocka_unit_test(caps_agree),
        cmocka_unit_test(surfaces_agree),    cmocka_unit_test(volumes_agree),
    };
    return shots_run_drivers("wash, back ends", tests, sizeof tests / sizeof tests[0]);
}
