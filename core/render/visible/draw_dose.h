#pragma once
/* The dose of a picture: its field and scale, found once for all draws of a list that show it. */
#include "core/render/visible/draw.h"
#include "core/scene/dose_scale.h"

/* The scale of the snapshot's dose; the list's, valid until it is destroyed. NULL: there is nothing to show. Asked for
 * only by draws that show dose, as it may build the field. */
const struct dose_scale *draw_dose_scale(struct draw_list *list, const struct snapshot *snapshot);
/* Like draw_dose_scale, but the field holds only the parts that dose_field_need_... was called for. */
const struct dose_scale *draw_dose_scale_begun(struct draw_list *list, const struct snapshot *snapshot);
void draw_dose_release(struct draw_list *list);
