/* Images and label layers on planes as draws. */
#include "core/render/visible/draw_planes.h"

#include <math.h>
#include <string.h>

#include "core/base/mem.h"

enum { PALETTE_BYTES = 4 * VISIBLE_N_LABELS };

static bool add_image(struct draw_list *list, const struct snapshot *snapshot, const struct plane *plane,
                      struct error *err)
{
    const struct scene_image_style *style = &snapshot->scene.image;
    bool is_in_space = !snapshot_is_pane(snapshot);
    double low = style->window.center - style->window.width / 2, width = style->window.width;
    return draw_list_add(list,
                         &(struct draw){
                             .pass = DRAW_PLANES,
                             .kind = DRAW_IMAGE,
                             .depth = is_in_space ? DRAW_DEPTH_TESTED : DRAW_DEPTH_NONE,
                             .subject = { SUBJECT_IMAGE, (size_t)snapshot->image, 0 },
                             .plane = *plane,
                             .opacity = 1,
                             .image = { .low = low,
                                        .width = width,
                                        .cull = is_in_space ? (style->cull_below - low) / width : -INFINITY,
                                        .is_low_white = snapshot_is_low_white(snapshot),
                                        .is_linear = style->interpolation != SCENE_INTERPOLATION_NEAREST },
                         },
                         err);
}

/* Label to colour: of the region itself or, when that is hidden, of the innermost visible one around it; alpha 0 where
 * there is nothing to see. Returns how many labels have a colour. */
static size_t fill_palette(const struct snapshot *snapshot, size_t layer, uint8_t *palette)
{
    const struct region_set *set = &snapshot->plan->regions;
    size_t n = 0;
    memset(palette, 0, PALETTE_BYTES);
    for (size_t i = 0; i < set->n_regions; i++) {
        int shown = (int)i;
        while (shown >= 0 && !visible_is_shown(snapshot, (size_t)shown))
            shown = set->regions[shown].parent;
        if (set->regions[i].layer != layer || shown < 0)
            continue;
        uint32_t rgb = snapshot->styles[shown].color_rgb;
        uint8_t *color = palette + 4 * (size_t)set->regions[i].label;
        color[0] = (uint8_t)(rgb >> 16);
        color[1] = (uint8_t)(rgb >> 8);
        color[2] = (uint8_t)rgb;
        color[3] = 255;
        n++;
    }
    return n;
}

static int outermost_depth(const struct region_set *set, size_t layer)
{
    int depth = INT32_MAX;
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].layer == layer && region_depth(set, i) < depth)
            depth = region_depth(set, i);
    return depth;
}

/* From the lowest to the uppermost: layers that hold outer regions lie under those that hold inner ones. */
static void order_layers(const struct region_set *set, size_t layers[REGION_MAX_LAYERS])
{
    int depths[REGION_MAX_LAYERS];
    for (size_t layer = 0; layer < set->n_layers; layer++) { /* insertion sort, stable */
        int depth = outermost_depth(set, layer);
        size_t at = layer;
        for (; at > 0 && depths[at - 1] > depth; at--) {
            depths[at] = depths[at - 1];
            layers[at] = layers[at - 1];
        }
        depths[at] = depth;
        layers[at] = layer;
    }
}

static bool add_labels(struct draw_list *list, const struct snapshot *snapshot, struct error *err)
{
    const struct region_set *set = &snapshot->plan->regions;
    size_t layers[REGION_MAX_LAYERS];
    order_layers(set, layers);
    list->palettes = mem_array(set->n_layers, PALETTE_BYTES, UINT64_MAX, err);
    if (!list->palettes)
        return false;
    for (size_t i = 0; i < set->n_layers; i++) {
        uint8_t *palette = list->palettes + i * PALETTE_BYTES;
        if (fill_palette(snapshot, layers[i], palette) == 0)
            continue;
        if (set->layers[layers[i]]->type == VOXEL_F32)
            return error_set(err, ERROR_UNSUPPORTED, "label layer %zu: a label layer of real numbers", layers[i]);
        if (!draw_list_add(list,
                           &(struct draw){ .pass = DRAW_PLANES,
                                           .kind = DRAW_LABELS,
                                           .depth = DRAW_DEPTH_NONE,
                                           .subject = { SUBJECT_LABEL_LAYER, layers[i], 0 },
                                           .plane = snapshot->pane,
                                           .opacity = 1,
                                           .palette = palette },
                           err))
            return false;
    }
    return true;
}

bool draw_planes(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    bool has_image = snapshot->image >= 0, is_good = true;
    if (snapshot_is_pane(snapshot))
        return has_image ? add_image(list, snapshot, &snapshot->pane, err) : add_labels(list, snapshot, err);
    for (size_t i = 0; is_good && has_image && i < snapshot->n_slices; i++)
        is_good = add_image(list, snapshot, &snapshot->slices[i], err);
    return is_good;
}
