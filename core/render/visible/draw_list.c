/* Makes the draw list of a snapshot's picture. */
#include "core/render/visible/draw_list.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/draw_beams.h"
#include "core/render/visible/draw_caps.h"
#include "core/render/visible/draw_coverage.h"
#include "core/render/visible/draw_dose.h"
#include "core/render/visible/draw_isodoses.h"
#include "core/render/visible/draw_isolines.h"
#include "core/render/visible/draw_overlay.h"
#include "core/render/visible/draw_planes.h"
#include "core/render/visible/draw_regions.h"
#include "core/render/visible/draw_tones.h"
#include "core/render/visible/draw_tracks.h"
#include "core/render/visible/draw_volume.h"
#include "core/render/visible/draw_wash.h"
#include "core/scene/beams_drawn.h"
#include "core/scene/isodoses.h"

static bool draw_opaque_regions(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    return snapshot_is_pane(scope->snapshot) || draw_regions(list, scope, true, err);
}

static bool draw_translucent_regions(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    return snapshot_is_pane(scope->snapshot) || draw_regions(list, scope, false, err);
}

/* The functions that fill the list, in the order of drawing; before them the tables that draws name. */
typedef bool fill(struct draw_list *list, const struct draw_scope *scope, struct error *err);
static fill *const fills[] = {
    draw_tones,
    draw_opaque_regions,
    draw_opaque_isodoses,
    draw_opaque_beams,
    draw_planes,
    draw_caps,
    draw_coverage,
    draw_isolines_in_space,
    draw_tracks,
    draw_volume,
    draw_translucent_regions,
    draw_translucent_isodoses,
    draw_translucent_beams,
    draw_overlay,
};

/* True: a volume is drawn by a method other than ray. Its samples have no depth of their own, and may hide the surfaces
 * that would be darker. */
static bool has_projected_volume(const struct draw_list *list)
{
    for (size_t i = 0; i < list->n_in_image; i++)
        if (list->draws[i].kind == DRAW_VOLUME && list->draws[i].volume.method != SCENE_VOLUME_METHOD_RAY)
            return true;
    return false;
}

struct draw_list *draw_list_create(const struct draw_scope *scope, const struct render_options *options,
                                   struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    struct draw_list *list = mem_new(sizeof *list);
    list->samples = visible_samples(snapshot, scope->camera, options->width_px, options->is_still);
    list->is_order_exact = snapshot->scene.surface.translucent_order == SCENE_TRANSLUCENT_ORDER_EXACT;
    list->reads_dose_in_parts = scope->reads_dose_in_parts;
    list->n_layers_planned = visible_n_translucent(snapshot) + isodoses_n_translucent(snapshot) +
                             beams_n_translucent(snapshot->plan, &snapshot->scene, &snapshot->fits);
    draw_cache_begin(scope->cache, &list->use);
    for (size_t i = 0; i < sizeof fills / sizeof fills[0]; i++)
        if (!fills[i](list, scope, err)) {
            draw_list_destroy(list);
            return NULL;
        }
    if (list->dose && !dose_scale_is_whole(list->dose, err)) {
        draw_list_destroy(list);
        return NULL;
    }
    if (options->is_still && snapshot->scene.still.ambient_occlusion && !snapshot_is_pane(snapshot) &&
        !has_projected_volume(list)) {
        list->depth =
            mem_array((size_t)options->width_px * (size_t)options->height_px, sizeof *list->depth, UINT64_MAX, err);
        if (!list->depth) {
            draw_list_destroy(list);
            return NULL;
        }
    }
    return list;
}

void draw_list_destroy(struct draw_list *list)
{
    if (!list)
        return;
    draw_cache_end(&list->use);
    draw_beams_release(list);
    draw_caps_release(list);
    draw_isolines_release(list);
    draw_wash_release(list);
    draw_coverage_release(list);
    draw_dose_release(list);
    free(list->draws);
    free(list->palettes);
    free(list->depth);
    free(list->tones[0]);
    free(list->tones[1]);
    free(list->transfer);
    free(list);
}
