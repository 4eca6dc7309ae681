#pragma once
/* The masks of many regions from one sweep over the labels: each label is read once, however many regions hold it. */
#include "core/region/mask.h"

struct mask_wish {
    size_t region;
    bool is_own; /* mask_from_region_own; else mask_from_region */
};

/*   masks    [n], gets for each wish the bits that it has one by one, on memory that is taken where anything is set;
 * each is the caller's. Untouched on failure. Equal for any n_threads (0: all cores) errors   ERROR_RANGE no such
 * region, ERROR_UNSUPPORTED a layer is neither U8 nor U16, ERROR_LIMIT, ERROR_MEMORY thread   any */
NODISCARD bool mask_sweep(const struct region_set *set, const struct mask_wish *wishes, size_t n, int n_threads,
                          struct mask **masks, struct error *err);
