#pragma once
/* Shared by the tests of volumes: plans with an image alone, scenes that show it as a volume, and the pictures. */
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const struct vec3 up = { 0, 0, 1 };
static const struct vec3 from_front = { 0, -1, 0 };
enum { MIDDLE_X = SHOTS_WIDTH / 2, MIDDLE_Y = SHOTS_HEIGHT / 2 };

static inline double no_label(struct vec3 p)
{
    (void)p;
    return 0;
}
static inline double one(struct vec3 p)
{
    (void)p;
    return 1;
}
static inline double nan_on_the_left(struct vec3 p)
{
    return p.x > 0 ? NAN : 1;
}

static inline struct plan *image_plan(const struct grid *grid, enum voxel_type type, double (*value)(struct vec3 p))
{
    struct plan *plan = made_plan(grid, no_label, NULL, 0);
    made_plan_add_image(plan, grid, type, value);
    return plan;
}

/* A scene of the volume alone, not lit, with these points of the transfer function. */
static inline struct scene volume_scene(const struct plan *plan, const struct scene_transfer_point *points, size_t n)
{
    struct scene scene = shots_scene(plan);
    struct scene_volume_style *style = &scene.image.volume;
    scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    free(style->points);
    style->points = mem_new((n ? n : 1) * sizeof *points);
    if (n)
        memcpy(style->points, points, n * sizeof *points);
    style->n_points = n;
    style->visible = true;
    style->shaded = false;
    return scene;
}

/* Everything has the same colour and absorption. */
static inline struct scene even_scene(const struct plan *plan, uint32_t rgb, double opacity_of_1_mm)
{
    return volume_scene(plan, &(struct scene_transfer_point){ 0, rgb, opacity_of_1_mm }, 1);
}

/* The colour of `over` with this part of what is behind it, per channel 0..255. */
static inline double mixed(double over, double passing, double behind)
{
    return (1 - passing) * over + passing * behind;
}

/* Mesa's software driver is the same behind EGL and OSMesa, and slow: it is tested once. */
static inline void need_another_driver(void)
{
    const struct render_facts *facts = renderer_facts(shots_renderer);
    if (facts->is_software && facts->back_end != RENDER_OSMESA && facts->back_end != RENDER_SOFT)
        skip();
}

static inline struct image *moving(struct plan *plan, struct scene scene, struct view view)
{
    need_another_driver();
    return shots_plain(plan, scene, view);
}
static inline struct image *still(struct plan *plan, struct scene scene, struct view view)
{
    need_another_driver();
    struct render_options options = { view.size_px[0], view.size_px[1], SURFACE_FULL, true };
    return shots_take(plan, scene, view, &options, NULL);
}

/* Two plates: red at y -5 to 5, blue before it on the left of the picture and behind it on the right. */
static inline double plates(struct vec3 p)
{
    if (fabs(p.z) > 25 || fabs(p.x) > 30)
        return 0;
    if (p.y > -5 && p.y < 5)
        return 1;
    return (p.x < 0 && p.y > -20 && p.y < -12) || (p.x > 0 && p.y > 12 && p.y < 20) ? 2 : 0;
}
static const struct made_region red_and_blue[] = { { "red", -1, 0xff2020 }, { "blue", -1, 0x2020ff } };

static inline struct plan *plates_plan(void)
{
    struct grid grid = made_cube_grid(70);
    struct plan *plan = made_plan(&grid, plates, red_and_blue, 2);
    made_plan_add_image(plan, &grid, VOXEL_U8, one);
    return plan;
}
