/* Makes a plan with a beam, and measures in pictures of it. */
#include "tests/render/beam_scene.h"

static const struct made_region boxes[] = { { "body", -1, BEAM_SCENE_BODY }, { "plate", -1, BEAM_SCENE_PLATE } };

static double label(struct vec3 p)
{
    if (fabs(p.x) > 30 || fabs(p.z) > 30)
        return 0;
    return p.y > -35 && p.y < -25 && p.x > 0 ? 2 : p.y > 10 && p.y < 30 ? 1 : 0;
}

struct plan *beam_plan(struct vec3 entry, struct vec3 target, double aperture_mm)
{
    struct grid grid = made_cube_grid(80);
    struct plan *plan = made_plan(&grid, label, boxes, 2);
    struct beam *beam = &plan->beams[plan->n_beams++];
    snprintf(beam->id, sizeof beam->id, "field");
    beam->entry_lps_mm = entry;
    beam->target_lps_mm = target;
    beam->aperture_mm = aperture_mm;
    return plan;
}

struct plan *beam_plan_sideways(double aperture_mm)
{
    return beam_plan(vec3(-60, 0, 10), vec3(0, 0, 10), aperture_mm);
}

struct scene beam_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.visible = false;
    scene.beam.looks = mem_new(sizeof *scene.beam.looks);
    scene.beam.n_looks = 1;
    scene.beam.looks[0] = (struct scene_beam_look_entry){ "field", scene_beam_look_default };
    scene.beam.looks[0].value.visible = true;
    scene.beam.looks[0].value.color_rgb = BEAM_SCENE_RGB;
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    return scene;
}

int column_of(double x_mm)
{
    return (int)floor(MIDDLE_X + x_mm * PX_PER_MM);
}

int row_of(double z_mm)
{
    return (int)floor(MIDDLE_Y - z_mm * PX_PER_MM);
}

bool has_color(const uint8_t *pixel, uint32_t rgb)
{
    return abs(pixel[0] - (int)(rgb >> 16)) <= 2 && abs(pixel[1] - (int)(rgb >> 8 & 255)) <= 2 &&
           abs(pixel[2] - (int)(rgb & 255)) <= 2;
}

bool is_background(const uint8_t *pixel)
{
    return has_color(pixel,
                     (uint32_t)shots_background[0] << 16 | (uint32_t)shots_background[1] << 8 | shots_background[2]);
}

bool extent_of_column(const struct image *image, int x, int *first, int *last)
{
    *first = *last = -1;
    for (int y = 0; y < image->height_px; y++)
        if (!is_background(shots_pixel(image, x, y))) {
            *first = *first < 0 ? y : *first;
            *last = y;
        }
    return *first >= 0;
}

bool extent_of_row(const struct image *image, int y, int *first, int *last)
{
    *first = *last = -1;
    for (int x = 0; x < image->width_px; x++)
        if (!is_background(shots_pixel(image, x, y))) {
            *first = *first < 0 ? x : *first;
            *last = x;
        }
    return *first >= 0;
}
