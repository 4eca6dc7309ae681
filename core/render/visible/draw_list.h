#pragma once
/* Makes the draw list of a snapshot's picture: the one place that decides what is drawn and in which order. */
#include "core/render/visible/back_end.h"
#include "core/render/visible/draw.h"

/* The list for a picture of the scope's snapshot. Asks the cache, and through it the back end, for every shape, so the
 * render thread calls it. What the scope names outlives the list.
 *   errors ERROR_MEMORY, ERROR_UNSUPPORTED, those of draw_cache_shape */
NODISCARD struct draw_list *draw_list_create(const struct draw_scope *scope, const struct render_options *options,
                                             struct error *err);
void draw_list_destroy(struct draw_list *list);
