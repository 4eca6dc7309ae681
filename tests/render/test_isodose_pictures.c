/* Isodose surfaces in pictures: a level of a cone of dose is a disc of known size, and both back ends draw alike. */
#include "tests/render/dose_scene.h"

/* Levels of 30 Gy and more have the radius 60 - level mm around the peak; their front lies beyond the dose's grid. */
static void show_levels(struct scene *scene, const double *gy, const double *opacity, size_t n)
{
    scene->dose.surfaces.visible = true;
    for (size_t i = 0; i < scene->dose.n_levels; i++) {
        struct scene_dose_level *level = &scene->dose.levels[i].value;
        level->surface = i < n;
        level->unit = SCENE_DOSE_UNIT_DOSE;
        level->value = i < n ? gy[i] : 1000;
        level->opacity = i < n ? opacity[i] : 1;
        level->color_rgb = (i < 4 ? 0x40ff40u >> 8 * i : 0) | 0x404040u;
    }
}

static void a_level_covers_a_disc_of_its_radius(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct scene scene = dose_scene(plan);
    const double px_per_mm = 4, radius_mm = 22;
    show_levels(&scene, (const double[]){ 60 - radius_mm }, (const double[]){ 1 }, 1);
    struct image *image =
        shots_plain(plan, scene, shots_view_from(dose_scene_peak_mm, vec3(0, -1, 0), vec3(0, 0, 1), px_per_mm));
    size_t n_inside = 0, n_outside = 0, n_wrong = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double from_mm = hypot(x + 0.5 - SHOTS_WIDTH / 2.0, y + 0.5 - SHOTS_HEIGHT / 2.0) / px_per_mm;
            bool is_drawn = memcmp(shots_pixel(image, x, y), shots_background, 3) != 0;
            /* linear between voxels of 3 mm: up to 3^2 / (8 r) = 0.05 mm too small, chords as much; a pixel is 0.25 */
            if (fabs(from_mm - radius_mm) < 0.5)
                continue;
            n_inside += from_mm < radius_mm;
            n_outside += from_mm > radius_mm;
            n_wrong += is_drawn != (from_mm < radius_mm);
        }
    assert_true(n_inside > 20000 && n_outside > 20000);
    assert_int_equal(n_wrong, 0);
    image_destroy(image);
    shots_forget(plan);
}

static struct scene translucent_scene(const struct plan *plan, const void *is_cut)
{
    struct scene scene = dose_scene(plan);
    show_levels(&scene, (const double[]){ 45, 30, 15 }, (const double[]){ 1, 0.5, 0.3 }, 3);
    for (size_t i = 0; i < scene.n_regions; i++) {
        scene.regions[i].value.visible = true;
        scene.regions[i].value.opacity = 0.4;
    }
    if (*(const bool *)is_cut)
        scene.clip.sagittal_high = (struct scene_clip_axis){ true, 4, false };
    return scene;
}

static void both_back_ends_draw_alike(void **state)
{
    (void)state;
    for (int is_cut = 0; is_cut < 2; is_cut++)
        dose_scene_expect_agreement(translucent_scene, &(bool){ is_cut },
                                    shots_view_from(vec3(1, 2, 1.1), vec3(0.5, -1, 0.9), vec3(0, 0, 1), 3), true, 9000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_level_covers_a_disc_of_its_radius),
        cmocka_unit_test(both_back_ends_draw_alike),
    };
    return shots_run("isodose pictures", tests, sizeof tests / sizeof tests[0]);
}
