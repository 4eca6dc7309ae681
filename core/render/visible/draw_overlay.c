/* The lines over a finished picture as draws: which, and in which order. */
#include "core/render/visible/draw_overlay.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/beam_eye_marks.h"
#include "core/render/visible/draw_beams.h"
#include "core/render/visible/draw_isolines.h"
#include "core/render/visible/visible.h"

static const uint32_t grid_rgb = 0xf4f6f8;
static const double grid_width_px = 1.5;
static const uint32_t axes_rgb = 0xd6dce2, axes_on_light_rgb = 0x232a31;
static const double axes_width_px = 1.5;

static bool add_region(struct draw_list *list, const struct draw_scope *scope, size_t region, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene_outline_style *style = &snapshot->scene.outline;
    bool is_checked = visible_is_checked(snapshot, region),
         is_of_surface = visible_has_outlined_surface(snapshot, region);
    if (!is_checked && !style->on_slices)
        return true;
    return draw_list_add(list,
                         &(struct draw){ .pass = DRAW_OVERLAY,
                                         .kind = is_checked ? DRAW_CHECK : DRAW_OUTLINE,
                                         .depth = DRAW_DEPTH_NONE,
                                         .subject = subject_region(region),
                                         .plane = snapshot->pane,
                                         .color_rgb = snapshot->styles[region].color_rgb,
                                         .opacity = 1,
                                         .lines = { .width_px = style->width_px,
                                                    .method = is_of_surface ? OUTLINE_MARCHING_SQUARES
                                                                            : visible_outline_method(snapshot),
                                                    .is_of_surface = is_of_surface,
                                                    .may_be_univels = !scope->is_still,
                                                    .key = is_checked ? visible_checked_key(snapshot, region)
                                                                      : visible_outlined_key(snapshot, region) } },
                         err);
}

static bool add_regions(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct region_set *set = &snapshot->plan->regions;
    struct visible_rank *ranks = mem_array(set->n_regions, sizeof *ranks, UINT64_MAX, err);
    size_t n = 0;
    bool is_good = ranks != NULL;
    for (size_t i = 0; is_good && i < set->n_regions; i++)
        if (visible_is_drawn(snapshot, i))
            ranks[n++] = visible_rank(snapshot, i);
    if (is_good)
        qsort(ranks, n, sizeof *ranks, visible_rank_compare);
    for (size_t i = 0; is_good && i < n; i++)
        is_good = add_region(list, scope, ranks[i].region, err);
    free(ranks);
    return is_good;
}

static bool add_dose_grid(struct draw_list *list, const struct snapshot *snapshot, struct error *err)
{
    return draw_list_add(list,
                         &(struct draw){ .pass = DRAW_OVERLAY,
                                         .kind = snapshot_is_pane(snapshot) ? DRAW_GRID_CUT : DRAW_GRID_BOX,
                                         .depth = DRAW_DEPTH_NONE,
                                         .subject = { SUBJECT_DOSE, (size_t)snapshot->dose, 0 },
                                         .plane = snapshot->pane,
                                         .color_rgb = grid_rgb,
                                         .opacity = 1,
                                         .lines = { .width_px = grid_width_px } },
                         err);
}

static bool add_axes(struct draw_list *list, const struct snapshot *snapshot, struct error *err)
{
    return draw_list_add(list,
                         &(struct draw){ .pass = DRAW_OVERLAY,
                                         .kind = DRAW_AXES,
                                         .depth = DRAW_DEPTH_NONE,
                                         .subject = subject_plan(),
                                         .color_rgb = visible_ground_is_light(snapshot) ? axes_on_light_rgb : axes_rgb,
                                         .opacity = 1,
                                         .lines = { .width_px = axes_width_px } },
                         err);
}

static bool add_beam_eye(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    struct beam_eye_marks marks;
    if (!beam_eye_marks_of(scope->snapshot, scope->camera, &marks))
        return true;
    return draw_list_add(list,
                         &(struct draw){ .pass = DRAW_OVERLAY,
                                         .kind = DRAW_BEAM_EYE,
                                         .depth = DRAW_DEPTH_NONE,
                                         .subject = subject_plan(),
                                         .opacity = 1 },
                         err);
}

bool draw_overlay(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene *scene = &snapshot->scene;
    bool is_pane = snapshot_is_pane(snapshot);
    if (is_pane && (scene->outline.on_slices || scene->check.visible) && !add_regions(list, scope, err))
        return false;
    if (is_pane && (!draw_isolines_on_pane(list, scope, err) || !draw_beams_on_pane(list, scope, err)))
        return false;
    if (!is_pane && scene->axes.visible && !add_axes(list, snapshot, err))
        return false;
    if (scene->dose.grid && snapshot->dose >= 0 && fit_is_used(&snapshot->fits.doses[snapshot->dose]) &&
        !add_dose_grid(list, snapshot, err))
        return false;
    return add_beam_eye(list, scope, err);
}
