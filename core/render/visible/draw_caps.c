/* Caps as draws: finds the regions that each clip plane cuts, and their outlines in it. */
#include "core/render/visible/draw_caps.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/cap_cache.h"
#include "core/render/visible/draw_clip.h"
#include "core/render/visible/draw_planes.h"
#include "core/render/visible/draw_wash.h"

/* Share of the region's colour in a cap that mixes it with the image. */
static const double region_tint = 0.35;
static const double outline_width_px = 1.3;

/* The regions that can have a part in caps, the lowest rank first. */
static size_t rank_bodies(const struct snapshot *snapshot, struct visible_rank *ranks)
{
    size_t n = 0;
    for (size_t i = 0; i < snapshot->plan->regions.n_regions; i++)
        if (visible_is_drawn(snapshot, i) && snapshot->styles[i].clipped)
            ranks[n++] = visible_rank(snapshot, i);
    qsort(ranks, n, sizeof *ranks, visible_rank_compare);
    return n;
}

/* Adds the regions that the plane cuts to those of the list. */
static bool add_regions(struct draw_list *list, const struct draw_scope *scope, const struct plane *plane,
                        const struct visible_rank *ranks, size_t n, struct error *err)
{
    for (size_t i = 0; i < n; i++) {
        struct shape_want want;
        if (!visible_body(scope->snapshot, ranks[i].region, scope->detail, &want))
            continue;
        const struct cut_lines *lines = cap_cache_lines(scope->caps, scope->snapshot->derived, &want, plane, err);
        if (!lines)
            return false;
        if (lines->n == 0)
            cap_cache_release(lines);
        else
            list->cap_regions[list->n_cap_regions++] =
                (struct draw_cap_region){ ranks[i].region, lines, scope->snapshot->styles[ranks[i].region].color_rgb };
    }
    return true;
}

static bool add_cap(struct draw_list *list, const struct draw_scope *scope, size_t clip,
                    const struct visible_rank *ranks, size_t n, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct plane *plane = &snapshot->clips[clip].plane;
    const struct scene_cap_style *style = &snapshot->scene.clip.cap;
    const struct draw_cap_region *first = list->cap_regions + list->n_cap_regions;
    if (!add_regions(list, scope, plane, ranks, n, err))
        return false;
    struct draw_cap cap = { .regions = first,
                            .n_regions = (size_t)(list->cap_regions + list->n_cap_regions - first),
                            .has_image = style->image && snapshot->image >= 0,
                            .outline_px = style->outlines ? outline_width_px : 0 };
    if (style->regions)
        cap.tint = cap.has_image ? region_tint : 1;
    if (snapshot->image >= 0)
        cap.image = draw_image_shown(list, snapshot, false);
    cap.image.wash = draw_wash_shown(list, snapshot);
    if (cap.n_regions == 0)
        return true;
    struct clip_set others = draw_clip_set(snapshot, true);
    others.left_out |= 1u << clip;
    return draw_list_add(list,
                         &(struct draw){
                             .pass = DRAW_PLANES,
                             .kind = DRAW_CAP,
                             .depth = DRAW_DEPTH_TESTED,
                             .subject = { SUBJECT_IMAGE, snapshot->image >= 0 ? (size_t)snapshot->image : 0, 0 },
                             .clip = others,
                             .plane = *plane,
                             .opacity = 1,
                             .cap = cap },
                         err);
}

bool draw_caps(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    if (!scope->caps || snapshot->n_clips == 0)
        return true;
    size_t n_regions = snapshot->plan->regions.n_regions;
    struct visible_rank *ranks = mem_array(n_regions, sizeof *ranks, UINT64_MAX, err);
    list->cap_regions =
        ranks ? mem_array(snapshot->n_clips * n_regions, sizeof *list->cap_regions, UINT64_MAX, err) : NULL;
    bool is_good = list->cap_regions != NULL;
    size_t n = is_good ? rank_bodies(snapshot, ranks) : 0;
    for (size_t i = 0; is_good && i < snapshot->n_clips; i++)
        if (snapshot->clips[i].is_capped)
            is_good = add_cap(list, scope, i, ranks, n, err);
    free(ranks);
    cap_cache_trim(scope->caps);
    return is_good;
}

void draw_caps_release(struct draw_list *list)
{
    for (size_t i = 0; i < list->n_cap_regions; i++)
        cap_cache_release(list->cap_regions[i].lines);
    free(list->cap_regions);
    list->cap_regions = NULL;
    list->n_cap_regions = 0;
}
