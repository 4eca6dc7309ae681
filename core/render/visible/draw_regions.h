#pragma once
/* The regions of a scene as draws: their shapes in space, those that can be seen, in the order of drawing. */
#include "core/render/visible/draw.h"

/* Appends the opaque shapes (is_opaque) or the translucent ones. Opaque: by the styles' order from the last one on, the
 * nearest first; translucent: by the styles' order, the farthest first. Left out is what lies outside the picture and
 * what an opaque closed surface encloses. errors ERROR_MEMORY, those of draw_cache_shape */
NODISCARD bool draw_regions(struct draw_list *list, const struct draw_scope *scope, bool is_opaque, struct error *err);
/* The distance from the eye to the nearest point of a box; parallel: along the line of sight. */
double draw_nearest_mm(const struct camera *camera, const struct box3 *box);
