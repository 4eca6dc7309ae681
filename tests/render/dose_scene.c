/* A plan with an image, nested regions and a dose, and the comparison of back ends. */
#include "tests/render/dose_scene.h"

const struct vec3 dose_scene_target_mm = { 4.2, -3.1, 2.3 }, dose_scene_peak_mm = { -2.7, -31.3, 6.1 };

double dose_scene_dose(struct vec3 p)
{
    return 60 - vec3_length(vec3_sub(p, dose_scene_peak_mm));
}

static double dose_with_hole(struct vec3 p)
{
    return p.x + p.y < -20 ? NAN : dose_scene_dose(p);
}

double dose_scene_label(struct vec3 p)
{
    return vec3_length(vec3_sub(p, dose_scene_target_mm)) < 18   ? 2
           : vec3_length(vec3(p.x / 40, p.y / 34, p.z / 38)) < 1 ? 1
                                                                 : 0;
}

static double boron_dose(struct vec3 p)
{
    return 0.5 + 0.4 * sin(0.09 * p.x + 0.05 * p.z) * cos(0.07 * p.y);
}

static double image_value(struct vec3 p)
{
    return 100 + 60 * sin(0.3 * p.x) * cos(0.2 * p.y) + p.z;
}

struct plan *dose_scene_plan(bool has_hole)
{
    static const struct made_region regions[] = { { "body", -1, 0x8090a0 }, { "target", 0, 0xff4040 } };
    const uint32_t label_size[3] = { 66, 60, 64 }, image_size[3] = { 81, 70, 40 }, dose_size[3] = { 29, 33, 24 };
    struct grid labels =
        made_grid(66, 60, 64,
                  made_affine(vec3(1.3, 0, 0), vec3(0, 1.3, 0), vec3(0, 0, 1.3), label_size, vec3(0.31, -0.22, 0.17)));
    struct grid image = made_grid(81, 70, 40,
                                  made_affine(vec3(1.2, 0.1, 0), vec3(-0.1, 1.2, 0.1), vec3(0.1, 0, 2.3), image_size,
                                              vec3(0.4, 0.3, 0.2)));
    struct grid doses = made_grid(29, 33, 24,
                                  made_affine(vec3(0.3, 2.9, 0), vec3(2.7, -0.3, 0.2), vec3(0, 0.1, -3.1), dose_size,
                                              vec3(-1.3, 0.6, 0.7)));
    struct plan *plan = made_plan(&labels, dose_scene_label, regions, 2);
    made_plan_add_image(plan, &image, VOXEL_I16, image_value);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "dose");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[dose->n_components++] = (struct dose_component){
        .quantity = DOSE_TOTAL, .values = made_volume(&doses, VOXEL_F32, has_hole ? dose_with_hole : dose_scene_dose)
    };
    dose->components[dose->n_components++] = (struct dose_component){
        .quantity = DOSE_BORON, .is_per_ppm = true, .values = made_volume(&doses, VOXEL_F32, boron_dose)
    };
    plan->bounds_lps_mm = grid_bounds_lps_mm(&image);
    return plan;
}

struct scene dose_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.visible = false;
    scene.dose.quantity = SCENE_DOSE_QUANTITY_TOTAL;
    scene.image.window = (struct scene_window){ .center = 100, .width = 260, .gamma = 1 };
    return scene;
}

static bool is_drawn(const uint8_t *pixel)
{
    return memcmp(pixel, shots_background, 3) != 0;
}

static double psnr_db(const struct image *a, const struct image *b, size_t *n)
{
    double squares = 0;
    *n = 0;
    for (int y = 0; y < a->height_px; y++)
        for (int x = 0; x < a->width_px; x++) {
            const uint8_t *p = shots_pixel(a, x, y), *q = shots_pixel(b, x, y);
            *n += is_drawn(p) || is_drawn(q);
            for (int c = 0; c < 3; c++)
                squares += (p[c] - q[c]) * (p[c] - q[c]);
        }
    return 10 * log10(255.0 * 255 * 3 * (double)*n / fmax(squares, 1));
}

void dose_scene_expect_agreement(struct scene (*make)(const struct plan *plan, const void *look), const void *look,
                                 struct view view, bool is_still, size_t least_drawn)
{
    struct error err = { 0 };
    const struct render_facts *facts = renderer_facts(shots_renderer);
    if (facts->back_end == RENDER_SOFT)
        skip();
    struct renderer *tested = shots_renderer, *soft = renderer_create(RENDER_SOFT, &err);
    assert_string_equal(err.text, "");
    struct plan *plan = dose_scene_plan(true);
    const struct render_options options = { view.size_px[0], view.size_px[1], SURFACE_FULL, is_still };
    struct image *theirs = shots_take(plan, make(plan, look), view, &options, NULL);
    renderer_forget(tested, plan);
    shots_renderer = soft;
    struct image *ours = shots_take(plan, make(plan, look), view, &options, NULL);
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
