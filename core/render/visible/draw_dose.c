/* The dose of a picture: its field and scale. */
#include "core/render/visible/draw_dose.h"

#include <stdlib.h>

#include "core/base/mem.h"

const struct dose_scale *draw_dose_scale_begun(struct draw_list *list, const struct snapshot *snapshot)
{
    if (!snapshot->has_dose_choice)
        return NULL;
    if (!list->dose) {
        list->dose = mem_new(sizeof *list->dose);
        (void)dose_scale_begin(snapshot, list->dose);
    }
    return list->dose->field ? list->dose : NULL;
}

const struct dose_scale *draw_dose_scale(struct draw_list *list, const struct snapshot *snapshot)
{
    const struct dose_scale *scale = draw_dose_scale_begun(list, snapshot);
    if (scale)
        dose_field_need_all(scale->field);
    return scale;
}

void draw_dose_release(struct draw_list *list)
{
    if (list->dose)
        dose_scale_finish(list->dose);
    free(list->dose);
    list->dose = NULL;
}
