#pragma once
/* The coverage of a region by the dose as draws: univels within limits, marked on the planes of a picture. */
#include "core/render/visible/draw.h"

/* Appends marks over each image and cap in space and over a slice pane, which are in the list already. None if the
 * scene shows no coverage or there is nothing to mark. errors ERROR_MEMORY */
NODISCARD bool draw_coverage(struct draw_list *list, const struct draw_scope *scope, struct error *err);
void draw_coverage_release(struct draw_list *list);
