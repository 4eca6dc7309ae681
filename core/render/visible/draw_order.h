#pragma once
/* The order of translucent shapes: isodoses and openings of beams among regions. */
#include "core/render/visible/draw.h"

/* Inserts a translucent shape among the translucent shapes that end the list: by distance, as regions whose order is 0.
 * errors ERROR_MEMORY */
NODISCARD bool draw_insert_translucent(struct draw_list *list, const struct draw_scope *scope, const struct draw *draw,
                                       struct error *err);
