#pragma once
/* Where planes cut closed shapes, kept from picture to picture: moving the camera or another plane cuts nothing again.
 * On the render thread. */
#include "core/derive/shapes.h"
#include "core/render/visible/cut.h"

struct cap_cache;

struct cap_cache *cap_cache_create(void);
/* No lines are in use. */
void cap_cache_destroy(struct cap_cache *cache);
/* Drops what is kept of a plan; NULL: of all. Its lines are not in use. */
void cap_cache_forget(struct cap_cache *cache, const struct plan *plan);

/* The closed outlines in which a plane cuts the triangles of a want; none if its shape cannot be made
 * (derive_is_refusal). In use until cap_cache_release. NULL on failure. errors those of derive_shape, ERROR_MEMORY */
NODISCARD const struct cut_lines *cap_cache_lines(struct cap_cache *cache, struct derive *derived,
                                                  const struct shape_want *want, const struct plane *plane,
                                                  struct error *err);
void cap_cache_release(const struct cut_lines *lines);
/* Drops the least recently used lines beyond the limits, except those in use. */
void cap_cache_trim(struct cap_cache *cache);
