/* The place of translucent shapes that are not regions in the draw list. */
#include "core/render/visible/draw_order.h"

#include <string.h>

#include "core/render/visible/draw_regions.h"

/* Where a translucent shape stands among the translucent regions: the farthest first. */
static size_t place_of(const struct draw_list *list, const struct draw_scope *scope, const struct draw *draw)
{
    double distance_mm = draw_nearest_mm(scope->camera, &draw->shape.drawable->bounds_lps_mm);
    size_t at = list->n;
    while (at > 0 && list->draws[at - 1].kind == DRAW_SHAPE && list->draws[at - 1].pass == DRAW_TRANSLUCENT) {
        const struct draw *before = &list->draws[at - 1];
        double order =
            before->subject.kind == SUBJECT_REGION ? (double)scope->snapshot->styles[before->subject.index].order : 0;
        double before_mm = draw_nearest_mm(scope->camera, &before->shape.drawable->bounds_lps_mm);
        if (order < 0 || (!(order > 0) && before_mm >= distance_mm))
            break;
        at--;
    }
    return at;
}

bool draw_insert_translucent(struct draw_list *list, const struct draw_scope *scope, const struct draw *draw,
                             struct error *err)
{
    size_t at = place_of(list, scope, draw);
    if (!draw_list_add(list, draw, err))
        return false;
    memmove(&list->draws[at + 1], &list->draws[at], (list->n - 1 - at) * sizeof *draw);
    list->draws[at] = *draw;
    return true;
}
