/* The lines over a finished picture as draws: which, and in which order. */
#include "core/render/visible/draw_overlay.h"

#include <stdlib.h>

#include "core/base/mem.h"

static const uint32_t grid_rgb = 0xf4f6f8;
static const double grid_width_px = 1.5;

/* A region, and what its place in the order depends on. */
struct ranked {
    size_t region;
    int order, depth;
    uint64_t n_voxels;
};

/* On top, last: the higher order, the inner, the smaller. */
static int compare_ranks(const void *left, const void *right)
{
    const struct ranked *a = left, *b = right;
    if (a->order != b->order)
        return a->order < b->order ? -1 : 1;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels > b->n_voxels ? -1 : 1;
    return a->region < b->region ? -1 : 1;
}

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
    struct ranked *ranks = mem_array(set->n_regions, sizeof *ranks, UINT64_MAX, err);
    size_t n = 0;
    bool is_good = ranks != NULL;
    for (size_t i = 0; is_good && i < set->n_regions; i++)
        if (visible_is_drawn(snapshot, i))
            ranks[n++] =
                (struct ranked){ i, (int)snapshot->styles[i].order, region_depth(set, i), set->regions[i].n_voxels };
    if (is_good)
        qsort(ranks, n, sizeof *ranks, compare_ranks);
    for (size_t i = 0; is_good && i < n; i++)
        is_good = add_region(list, scope, ranks[i].region, err);
    free(ranks);
    return is_good;
}

bool draw_overlay(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene *scene = &snapshot->scene;
    bool is_pane = snapshot_is_pane(snapshot);
    if (is_pane && (scene->outline.on_slices || scene->check.visible) && !add_regions(list, scope, err))
        return false;
    if (!scene->dose.grid || snapshot->dose < 0)
        return true;
    return draw_list_add(list,
                         &(struct draw){ .pass = DRAW_OVERLAY,
                                         .kind = is_pane ? DRAW_GRID_CUT : DRAW_GRID_BOX,
                                         .depth = DRAW_DEPTH_NONE,
                                         .subject = { SUBJECT_DOSE, (size_t)snapshot->dose, 0 },
                                         .plane = snapshot->pane,
                                         .color_rgb = grid_rgb,
                                         .opacity = 1,
                                         .lines = { .width_px = grid_width_px } },
                         err);
}
