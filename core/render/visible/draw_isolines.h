#pragma once
/* Isodose lines as draws: over slice panes, and on slices, oblique planes and caps in space. */
#include "core/render/visible/draw.h"

/* On a slice pane, for the overlay. errors ERROR_MEMORY */
NODISCARD bool draw_isolines_on_pane(struct draw_list *list, const struct draw_scope *scope, struct error *err);
/* In space, hidden by what is nearer: on the images and caps of the list, so after these. errors ERROR_MEMORY */
NODISCARD bool draw_isolines_in_space(struct draw_list *list, const struct draw_scope *scope, struct error *err);
/* Lets go of the lines of a list. */
void draw_isolines_release(struct draw_list *list);
