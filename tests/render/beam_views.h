#pragma once
/* Plans with one beam and views along it, for render tests. */
#include "tests/render/shots.h"

static inline struct vec3 along(struct vec3 from, struct vec3 direction, double mm)
{
    return vec3_add(from, vec3_scale(direction, mm));
}

/* Sets the plan's beam, from a length before the target to it. */
static inline void set_beam(struct plan *plan, struct vec3 target, struct vec3 direction, double length_mm)
{
    plan->n_beams = 1;
    plan->beams[0] = (struct beam){
        .id = "b", .entry_lps_mm = along(target, direction, -length_mm), .target_lps_mm = target, .aperture_mm = 100
    };
}

/* Without crosshair; parallel, so many mm across the smaller side. */
static inline struct view view_of(enum scene_kind kind, int width_px, int height_px, double height_mm)
{
    struct view view = view_default;
    view.kind = kind;
    view.size_px[0] = width_px;
    view.size_px[1] = height_px;
    view.camera.projection = SCENE_PROJECTION_PARALLEL;
    view.camera.has_height_mm = true;
    view.camera.height_mm = height_mm;
    view.beam.crosshair = false;
    return view;
}

static inline struct view ring_of(struct view view, double ring_mm)
{
    view.beam.has_aperture_mm = true;
    view.beam.aperture_mm = ring_mm;
    return view;
}

/* Without the terraces of univels, whose corners a silhouette shows. */
static inline struct scene smooth_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    scene.surface.algorithm = SCENE_ALGORITHM_SMOOTH;
    return scene;
}
