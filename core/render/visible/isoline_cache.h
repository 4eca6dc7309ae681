#pragma once
/* Isodose lines as segments in space, kept from picture to picture: while a pane is panned, and while the camera of a
 * view into space moves, no dose is sampled and no line is traced again. On the render thread. */
#include "core/render/visible/cut.h"
#include "core/render/visible/isoline_scene.h"

struct isoline_cache;

struct isoline_cache *isoline_cache_create(void);
/* No lines are in use. */
void isoline_cache_destroy(struct isoline_cache *cache);
/* Drops what is kept of a plan; NULL: of all. Its lines are not in use. */
void isoline_cache_forget(struct isoline_cache *cache, const struct plan *plan);

/* Where lines are wanted. */
struct isoline_place {
    const struct plan *plan;
    const struct isoline_dose *dose;
    struct plane plane;
    struct isoline_window window; /* at least here */
    double mm_per_px;             /* of the picture */
    bool is_coarse;               /* samples are twice as far from each other: for moving pictures */
    bool is_by_slice;
    bool is_dashed;
    /* Only inside of one of these closed outlines, by the even-odd rule; NULL: everywhere. */
    const struct cut_lines *const *outlines;
    size_t n_outlines;
};

/* The lines of a value, to a tenth of a pixel. In use until isoline_cache_release; NULL on failure. errors ERROR_MEMORY
 */
NODISCARD const struct cut_lines *isoline_cache_lines(struct isoline_cache *cache, const struct isoline_place *place,
                                                      double level, struct error *err);
void isoline_cache_release(const struct cut_lines *lines);
/* Drops the least recently used lines beyond the limits, except those in use. */
void isoline_cache_trim(struct isoline_cache *cache);
