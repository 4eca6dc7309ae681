/* Images and label layers on planes as draws. */
#include "core/render/visible/draw_planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/color_map.h"
#include "core/render/visible/draw_clip.h"
#include "core/render/visible/draw_wash.h"

enum { PALETTE_BYTES = 4 * VISIBLE_N_LABELS };

static void set_window(const struct scene_window *window, double *low, double *width)
{
    *low = window->center - window->width / 2;
    *width = window->width;
}

static struct draw_blend blend_shown(const struct draw_list *list, const struct snapshot *snapshot)
{
    struct draw_blend blend = { .gamma = 1 };
    if (snapshot->blend < 0)
        return blend;
    blend.image = (size_t)snapshot->blend;
    blend.part = snapshot->scene.image.blend.opacity;
    struct scene_image_look look = snapshot_look_of(snapshot, blend.image);
    set_window(&look.window, &blend.low, &blend.width);
    blend.is_low_white = snapshot->plan->images[blend.image].is_inverted;
    blend.colors = color_map_table(look.color_map);
    blend.gamma = look.window.gamma;
    blend.tones = list->tones[1];
    return blend;
}

struct draw_image draw_image_shown(const struct draw_list *list, const struct snapshot *snapshot, bool is_culled)
{
    const struct scene_image_style *style = &snapshot->scene.image;
    struct draw_image image = { .cull = -INFINITY,
                                .is_low_white = snapshot_is_low_white(snapshot),
                                .is_linear = style->interpolation != SCENE_INTERPOLATION_NEAREST,
                                .colors = color_map_table(style->color_map),
                                .gamma = style->window.gamma,
                                .tones = list->tones[0],
                                .blend = blend_shown(list, snapshot) };
    set_window(&style->window, &image.low, &image.width);
    if (is_culled)
        image.cull = (style->cull_below - image.low) / image.width;
    return image;
}

static bool add_image(struct draw_list *list, const struct snapshot *snapshot, const struct plane *plane,
                      struct error *err)
{
    bool is_in_space = !snapshot_is_pane(snapshot);
    struct clip_set clip = draw_clip_set(snapshot, snapshot->scene.image.clipped);
    if (draw_clip_cuts(&clip) && !draw_clip_slice(&clip, plane, &snapshot->plan->images[snapshot->image].volume->grid))
        return true;
    struct draw_image image = draw_image_shown(list, snapshot, is_in_space);
    image.wash = draw_wash_shown(list, snapshot);
    return draw_list_add(list,
                         &(struct draw){
                             .pass = DRAW_PLANES,
                             .kind = DRAW_IMAGE,
                             .depth = is_in_space ? DRAW_DEPTH_TESTED : DRAW_DEPTH_NONE,
                             .subject = { SUBJECT_IMAGE, (size_t)snapshot->image, 0 },
                             .clip = clip,
                             .plane = *plane,
                             .opacity = 1,
                             .image = image,
                         },
                         err);
}

/* The univels with a region's own label, and the region whose colour they have. */
struct fill {
    struct visible_rank rank; /* of that region: the uppermost visible one of the label's region and its ancestors */
    size_t layer;
    uint16_t label;
    struct box3 box_lps_mm; /* around the univels */
};

static int compare_fills(const void *left, const void *right)
{
    const struct fill *a = left, *b = right;
    int order = visible_rank_compare(&a->rank, &b->rank);
    if (order != 0)
        return order;
    if (a->layer != b->layer)
        return a->layer < b->layer ? -1 : 1;
    return a->label < b->label ? -1 : a->label > b->label;
}

static struct box3 box_of(const struct region_set *set, size_t region)
{
    const struct region *r = &set->regions[region];
    struct box3 box = box3_empty();
    for (int corner = 0; corner < 8; corner++)
        box3_add(&box, affine_point(&set->layers[r->layer]->grid.lps_mm_from_ijk,
                                    vec3(corner & 1 ? r->high_ijk[0] + 0.5 : r->low_ijk[0] - 0.5,
                                         corner & 2 ? r->high_ijk[1] + 0.5 : r->low_ijk[1] - 0.5,
                                         corner & 4 ? r->high_ijk[2] + 0.5 : r->low_ijk[2] - 0.5)));
    return box;
}

static bool meets_plane(const struct box3 *box, const struct plane *plane)
{
    const double slack_mm = 1e-6; /* a plane along a face shows the univels of either side */
    struct plane_reach reach = plane_reach(plane, box);
    return reach.low_mm <= slack_mm && reach.high_mm >= -slack_mm;
}

/* Lists the fills of the labels that the pane can show, the lowest first. Returns how many. */
static size_t list_fills(const struct snapshot *snapshot, struct fill *fills)
{
    const struct region_set *set = &snapshot->plan->regions;
    size_t n = 0;
    for (size_t i = 0; i < set->n_regions; i++) {
        struct fill fill = { .layer = set->regions[i].layer, .label = set->regions[i].label };
        bool is_shown = false;
        for (int at = (int)i; set->regions[i].n_voxels > 0 && at >= 0; at = set->regions[at].parent) {
            if (!visible_is_shown(snapshot, (size_t)at))
                continue;
            struct visible_rank rank = visible_rank(snapshot, (size_t)at);
            if (!is_shown || visible_rank_compare(&rank, &fill.rank) > 0)
                fill.rank = rank;
            is_shown = true;
        }
        if (!is_shown)
            continue;
        fill.box_lps_mm = box_of(set, i);
        if (meets_plane(&fill.box_lps_mm, &snapshot->pane))
            fills[n++] = fill;
    }
    qsort(fills, n, sizeof *fills, compare_fills);
    return n;
}

static bool boxes_meet(const struct box3 *a, const struct box3 *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y && b->low.y <= a->high.y &&
           a->low.z <= b->high.z && b->low.z <= a->high.z;
}

/* True if a label of another layer that may overlap the fill's is in the sheet. */
static bool is_in_the_way(const struct fill *fills, const size_t *sheet_of, size_t fill, size_t sheet)
{
    for (size_t i = 0; i < fill; i++)
        if (sheet_of[i] == sheet && fills[i].layer != fills[fill].layer &&
            boxes_meet(&fills[i].box_lps_mm, &fills[fill].box_lps_mm))
            return true;
    return false;
}

/* Spreads the fills over as few sheets as it finds: a sheet has labels of one layer and is drawn at once, over the
 * sheets before it. A fill lies over all lower ones of other layers that may overlap it. Returns the number of sheets.
 */
static size_t spread_fills(const struct fill *fills, size_t n, size_t *sheet_of, size_t *layer_of_sheet)
{
    size_t n_sheets = 0;
    for (size_t i = 0; i < n; i++) {
        sheet_of[i] = n_sheets;
        for (size_t sheet = n_sheets; sheet-- > 0;) {
            if (layer_of_sheet[sheet] == fills[i].layer)
                sheet_of[i] = sheet;
            else if (is_in_the_way(fills, sheet_of, i, sheet))
                break;
        }
        if (sheet_of[i] == n_sheets)
            layer_of_sheet[n_sheets++] = fills[i].layer;
    }
    return n_sheets;
}

/* The colours of the sheet's labels; alpha 0: not drawn. */
static void fill_palette(const struct snapshot *snapshot, const struct fill *fills, size_t n, const size_t *sheet_of,
                         size_t sheet, uint8_t *palette)
{
    memset(palette, 0, PALETTE_BYTES);
    for (size_t i = 0; i < n; i++) {
        if (sheet_of[i] != sheet)
            continue;
        uint32_t rgb = snapshot->styles[fills[i].rank.region].color_rgb;
        uint8_t *color = palette + 4 * (size_t)fills[i].label;
        color[0] = (uint8_t)(rgb >> 16);
        color[1] = (uint8_t)(rgb >> 8);
        color[2] = (uint8_t)rgb;
        color[3] = 255;
    }
}

static bool add_sheet(struct draw_list *list, const struct snapshot *snapshot, size_t layer, const uint8_t *palette,
                      struct error *err)
{
    if (snapshot->plan->regions.layers[layer]->type == VOXEL_F32)
        return error_set(err, ERROR_UNSUPPORTED, "label layer %zu: a label layer of real numbers", layer);
    return draw_list_add(list,
                         &(struct draw){ .pass = DRAW_PLANES,
                                         .kind = DRAW_LABELS,
                                         .depth = DRAW_DEPTH_NONE,
                                         .subject = { SUBJECT_LABEL_LAYER, layer, 0 },
                                         .plane = snapshot->pane,
                                         .opacity = 1,
                                         .palette = palette },
                         err);
}

static bool add_labels(struct draw_list *list, const struct snapshot *snapshot, struct error *err)
{
    size_t n_regions = snapshot->plan->regions.n_regions, sheet_of[REGION_MAX], layer_of_sheet[REGION_MAX];
    struct fill *fills = mem_array(n_regions, sizeof *fills, UINT64_MAX, err);
    if (!fills)
        return false;
    size_t n = list_fills(snapshot, fills), n_sheets = spread_fills(fills, n, sheet_of, layer_of_sheet);
    list->palettes = mem_array(n_sheets, PALETTE_BYTES, UINT64_MAX, err);
    bool is_good = list->palettes != NULL;
    for (size_t sheet = 0; is_good && sheet < n_sheets; sheet++) {
        uint8_t *palette = list->palettes + sheet * PALETTE_BYTES;
        fill_palette(snapshot, fills, n, sheet_of, sheet, palette);
        is_good = add_sheet(list, snapshot, layer_of_sheet[sheet], palette, err);
    }
    free(fills);
    return is_good;
}

bool draw_planes(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    bool has_image = snapshot->image >= 0, is_good = true;
    if (snapshot_is_pane(snapshot) && !has_image)
        return add_labels(list, snapshot, err) && draw_wash_on_pane(list, scope, err);
    if (snapshot_is_pane(snapshot))
        return add_image(list, snapshot, &snapshot->pane, err);
    for (size_t i = 0; is_good && has_image && i < snapshot->n_slices; i++)
        is_good = add_image(list, snapshot, &snapshot->slices[i], err);
    return is_good;
}
