#pragma once
/* The image as a volume in space, as a draw. */
#include "core/render/visible/draw.h"

/* Appends the volume if the scene shows one that can be seen, before the translucent regions, and makes the list's
 * order exact. errors ERROR_MEMORY */
NODISCARD bool draw_volume(struct draw_list *list, const struct draw_scope *scope, struct error *err);

/* Fills a table of DRAW_VOLUME_TABLE colours and absorptions per mm at values from low to low + width. points: n >= 1,
 * ascending; linear in value between them, colour and opacity of 1 mm; constant beyond. Of a step at one value, that
 * value has the second point. */
void draw_volume_table(const struct scene_transfer_point *points, size_t n, double low, double width,
                       float table[DRAW_VOLUME_TABLE][4]);
