/* Adds the isodose lines of a snapshot to its draw list. */
#include "core/render/visible/draw_isolines.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/isoline_cache.h"

/* Adds a level's lines at a place; the compared dose is dashed. */
static bool add_lines(struct draw_list *list, const struct draw_scope *scope, const struct isoline_place *place,
                      const struct draw *like, const struct isoline_level *level, struct error *err)
{
    const struct cut_lines *lines = isoline_cache_lines(scope->isolines, place, level->value, err);
    if (!lines)
        return false;
    if (lines->n == 0) {
        isoline_cache_release(lines);
        return true;
    }
    struct draw draw = *like;
    draw.kind = DRAW_ISOLINES;
    draw.plane = place->plane;
    draw.color_rgb = level->color_rgb;
    draw.opacity = 1;
    draw.isolines.lines = lines;
    draw.isolines.width_px = scope->snapshot->scene.dose.lines.width_px;
    if (draw_list_add(list, &draw, err))
        return true;
    isoline_cache_release(lines);
    return false;
}

/* Adds all lines at a place: those of the compared dose under those of the dose shown. */
static bool add_all(struct draw_list *list, const struct draw_scope *scope, const struct isoline_scene *lines,
                    struct isoline_place *place, const struct draw *like, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    place->plan = snapshot->plan;
    place->is_coarse = !scope->is_still;
    place->is_by_slice = snapshot->scene.dose.interpolation == SCENE_DOSE_INTERPOLATION_SLICE;
    for (int dose = 1; dose >= 0; dose--) {
        place->dose = &lines->doses[dose];
        place->is_dashed = dose == 1;
        for (size_t i = 0; lines->is_drawn[dose] && i < lines->n_levels; i++)
            if (!add_lines(list, scope, place, like, &lines->levels[i], err))
                return false;
    }
    return true;
}

/* False when memory ran out: lines would be missing. */
static bool is_whole(const struct isoline_scene *lines, struct error *err)
{
    if (lines->failure.code)
        *err = lines->failure;
    return !lines->failure.code;
}

bool draw_isolines_on_pane(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    struct isoline_scene lines;
    if (!scope->isolines)
        return true;
    if (!isoline_scene_init(&lines, snapshot) || lines.failure.code) {
        isoline_scene_finish(&lines);
        return is_whole(&lines, err);
    }
    struct isoline_place place = { .plane = snapshot->pane,
                                   .window = isoline_window_of_pane(&snapshot->pane, scope->camera),
                                   .mm_per_px = 1 / scope->camera->pixels_per_mm };
    const struct draw like = { .pass = DRAW_OVERLAY, .depth = DRAW_DEPTH_NONE };
    bool is_good = add_all(list, scope, &lines, &place, &like, err);
    isoline_scene_finish(&lines);
    isoline_cache_trim(scope->isolines);
    return is_good;
}

/* The size of a pixel of the full-size picture where the camera looks to. The eye of a view along a beam may come as
 * near to its target as it likes, and pass it: there, half way to the end of what is seen. */
static double target_mm_per_px(const struct draw_scope *scope)
{
    const struct camera *camera = scope->camera;
    const struct view *view = &scope->snapshot->view;
    if (snapshot_beam(scope->snapshot) && !camera->is_parallel)
        return camera->far_mm * tan(view->camera.fov_deg / 2 * MATH_PI / 180) /
               fmin(view->size_px[0], view->size_px[1]);
    struct vec3 low = mat4_project(&camera->clip_from_lps_mm, camera->target_lps_mm),
                high = mat4_project(&camera->clip_from_lps_mm, vec3_add(camera->target_lps_mm, camera->up));
    double px_per_mm = fabs(high.y - low.y) * scope->snapshot->view.size_px[1] / 2;
    return px_per_mm > 0 ? 1 / px_per_mm : 1;
}

static bool add_on_cap(struct draw_list *list, const struct draw_scope *scope, const struct isoline_scene *lines,
                       struct isoline_place *place, const struct draw *cap, struct error *err)
{
    const struct cut_lines **outlines = mem_array(cap->cap.n_regions, sizeof *outlines, UINT64_MAX, err);
    for (size_t i = 0; outlines && i < cap->cap.n_regions; i++)
        outlines[i] = cap->cap.regions[i].lines;
    place->outlines = outlines;
    place->n_outlines = cap->cap.n_regions;
    bool is_good = outlines && add_all(list, scope, lines, place, cap, err);
    free(outlines);
    place->outlines = NULL;
    return is_good;
}

bool draw_isolines_in_space(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    struct isoline_scene lines;
    if (!scope->isolines || snapshot_is_pane(scope->snapshot))
        return true;
    bool has_lines = isoline_scene_init(&lines, scope->snapshot), is_good = is_whole(&lines, err);
    struct isoline_place place = { .window = isoline_window_of_plane(), .mm_per_px = target_mm_per_px(scope) };
    size_t n = has_lines ? list->n : 0;
    for (size_t i = 0; is_good && i < n; i++) {
        struct draw draw = list->draws[i]; /* the list grows */
        place.plane = draw.plane;
        if (draw.kind == DRAW_CAP)
            is_good = add_on_cap(list, scope, &lines, &place, &draw, err);
        else if (draw.kind == DRAW_IMAGE)
            is_good = add_all(list, scope, &lines, &place, &draw, err);
    }
    isoline_scene_finish(&lines);
    isoline_cache_trim(scope->isolines);
    return is_good;
}

void draw_isolines_release(struct draw_list *list)
{
    for (size_t i = 0; i < list->n; i++)
        if (list->draws[i].kind == DRAW_ISOLINES)
            isoline_cache_release(list->draws[i].isolines.lines);
}
