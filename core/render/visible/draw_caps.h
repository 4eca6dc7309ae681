#pragma once
/* Caps as draws: what each clip plane cuts through, closed with the image. */
#include "core/render/visible/draw.h"

/* Appends a cap for each clip plane that has one and cuts a visible region that is a closed body: surface, univels and
 * nurbs by the very triangles that are drawn, solid points by the region's surface. None without scope->caps.
 * errors those of derive_shape, ERROR_MEMORY */
NODISCARD bool draw_caps(struct draw_list *list, const struct draw_scope *scope, struct error *err);
/* Ends the use of the lines that the list's caps borrowed. */
void draw_caps_release(struct draw_list *list);
