#pragma once
/* Links the outlines of neighbouring slices that a tube is stacked from. Knows nothing of splines. Any thread. */
#include "core/region/outline.h"

/* Links pieces, and holes, outline by outline: each continues in the outline of its kind with which it shares most
 * pixels, provided that outline shares most with it too. So where a piece divides, the largest part continues and the
 * others begin anew.
 *
 *   set      outlines between pixels (outline_walk), all slices across axis
 *   returns  next[line]: the line of the next slice that continues it, or UINT32_MAX; the caller frees it
 *   errors   ERROR_MEMORY */
NODISCARD uint32_t *nurbs_pieces_link(const struct outline_set *set, int axis, struct error *err);

/* Twice the area in pixels that a line encloses; negative around holes. */
double nurbs_pieces_twice_area(const struct outline_set *set, uint32_t line, int axis);
