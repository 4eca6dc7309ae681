#pragma once
/* Inside core/derive: masks of the regions whose shapes are built side by side, from few sweeps over the labels
 * (mask_sweep). A sweep makes the masks of as many wishes as its limit of memory allows, when the first of them is
 * asked for: by then their shapes may have been built by others. */
#include "core/plan/plan.h"
#include "core/region/mask_sweep.h"

#define REGION_MASKS_BYTES ((uint64_t)256 << 20) /* of masks that one sweep makes */

struct region_masks;

/* Lists the masks to make. wishes: roughly in the order of region_masks_take. most_bytes: limit on the masks of one
 * sweep, which makes at least one mask. The plan is borrowed. */
struct region_masks *region_masks_create(const struct plan *plan, const struct mask_wish *wishes, size_t n,
                                         uint64_t most_bytes);
/* Returns the mask of a wish, which the caller owns; a second call makes it again. Any thread: the first thread sweeps,
 * on all cores, and others that need the same sweep wait. errors as mask_sweep */
NODISCARD struct mask *region_masks_take(struct region_masks *masks, size_t wish, struct error *err);
void region_masks_destroy(struct region_masks *masks);
