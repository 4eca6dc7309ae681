#pragma once
/* Inside core/plan: masks of the regions whose shapes are built side by side, from one sweep over the labels
 * (mask_sweep). Made when the first is asked for, as the shapes may turn out to be there already. */
#include "core/plan/plan.h"
#include "core/region/mask_sweep.h"

#define PLAN_MASKS_BYTES ((uint64_t)256 << 20) /* what a plan has of them at once */

struct plan_masks;

/* wishes: in the order in which they will be asked for, more or less. At most so many bytes of masks are made at once,
 * but always one. The plan is borrowed. */
struct plan_masks *plan_masks_create(const struct plan *plan, const struct mask_wish *wishes, size_t n,
                                     uint64_t most_bytes);
/* The mask of a wish; the caller's, also when it is asked for again. Any thread: the first makes it, and those of
 * further wishes, on all cores; others wait. errors as mask_sweep */
NODISCARD struct mask *plan_masks_take(struct plan_masks *masks, size_t wish, struct error *err);
void plan_masks_destroy(struct plan_masks *masks);
