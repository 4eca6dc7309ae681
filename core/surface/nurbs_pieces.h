#pragma once
/* Which outline of a slice goes on in which of the next: what a tube is stacked from. Knows nothing of splines. */
#include "core/region/outline.h"

/* Pieces of a region, and holes in them, by outline: each goes on in the outline of its kind whose pixels it shares
 * most of, when that one says the same of it. So where a piece divides, the largest part goes on and the others begin
 * anew.
 *
 *   set      outlines between pixels (outline_walk), all slices across axis
 *   returns  next[line], the line of the next slice that it goes on in, or UINT32_MAX; free()
 *   errors   ERROR_MEMORY */
NODISCARD uint32_t *nurbs_pieces_link(const struct outline_set *set, int axis, struct error *err);

/* Twice the area in pixels that a line encloses; negative around holes. */
double nurbs_pieces_twice_area(const struct outline_set *set, uint32_t line, int axis);
