#pragma once
/* The lines over a finished picture as draws: on slice panes outlines and the check of a segmentation, on all pictures
 * the grids of a dose, in those along a beam its crosshair and ring. */
#include "core/render/visible/draw.h"

/* Appends the draws of the overlay, the topmost last. errors ERROR_MEMORY */
NODISCARD bool draw_overlay(struct draw_list *list, const struct draw_scope *scope, struct error *err);
