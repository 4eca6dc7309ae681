#pragma once
/* Makes the masks of many regions in one sweep over the labels: each label is read once, however many regions need
 * it. */
#include "core/region/mask.h"

struct mask_wish {
    size_t region;
    bool is_own; /* true: mask_from_region_own; false: mask_from_region */
};

/* Makes masks[i] for wishes[i], with the same bits as the function that wishes[i] names. A mask takes memory only where
 * bits are set.
 *
 *   masks      [n]; each is the caller's. Untouched on failure
 *   n_threads  0: all cores; the result is the same for any number
 *   errors     ERROR_RANGE no such region; ERROR_UNSUPPORTED a layer is neither U8 nor U16; ERROR_LIMIT; ERROR_MEMORY
 *   thread     any */
NODISCARD bool mask_sweep(const struct region_set *set, const struct mask_wish *wishes, size_t n, int n_threads,
                          struct mask **masks, struct error *err);
