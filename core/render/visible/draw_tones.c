/* Tables of tones: greys to the power 1 / gamma, then colours. */
#include "core/render/visible/draw_tones.h"

#include "core/base/mem.h"
#include "core/render/visible/color_map.h"

void draw_tones_fill(const uint32_t *colors, double gamma, uint32_t tones[DRAW_TONES])
{
    for (int i = 0; i < DRAW_TONES; i++) {
        uint32_t level = (uint32_t)lround(255 * pow((double)i / (DRAW_TONES - 1), 1 / gamma));
        tones[i] = colors ? colors[level] : level | level << 8 | level << 16 | 0xff000000u;
    }
}

static bool add(uint32_t **tones, const struct scene_window *window, enum scene_color_map map, struct error *err)
{
    if (window->gamma == 1)
        return true;
    *tones = mem_array(DRAW_TONES, sizeof **tones, UINT64_MAX, err);
    if (!*tones)
        return false;
    draw_tones_fill(color_map_table(map), window->gamma, *tones);
    return true;
}

bool draw_tones(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene_image_style *style = &snapshot->scene.image;
    if (snapshot->image >= 0 && !add(&list->tones[0], &style->window, style->color_map, err))
        return false;
    if (snapshot->blend < 0)
        return true;
    struct scene_image_look look = snapshot_look_of(snapshot, (size_t)snapshot->blend);
    return add(&list->tones[1], &look.window, look.color_map, err);
}
