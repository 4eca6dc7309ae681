#pragma once
/* Executes the overlay of a draw list over a finished picture, alike for every back end: outlines of regions, the check
 * of a segmentation, grids of a dose, beams. Lines have smooth edges, in moving pictures too. */
#include "core/render/visible/check.h"
#include "core/render/visible/draw.h"

/* Keeps the lines of recent pictures. */
struct overlay;

struct overlay *overlay_create(void);
void overlay_destroy(struct overlay *overlay);
void overlay_forget(struct overlay *overlay, const struct plan *plan);

/* Paints the list's draws of DRAW_OVERLAY over the image. errors ERROR_MEMORY, those of derive_shape and outline_slice
 */
NODISCARD bool overlay_draw(struct overlay *overlay, const struct draw_scope *scope, const struct draw_list *list,
                            struct image *image, struct check_counts *check, struct error *err);
