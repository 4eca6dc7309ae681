#pragma once
/* SERA's own sample head: univels 256 x 256 x 48 of 1.01562 x 1.01562 x 5.49991 mm; 2 scalp, 3 brain, 4 tumor. */
#include "core/region/mask.h"
#include "core/region/region.h"

/* NULL, with a message on standard output, if the data is missing. */
struct volume *sera_head_read(void);
/* Regions 0 scalp, 1 brain, 2 tumor, nested as in its body_containment.info; takes layer. */
struct region_set *sera_head_regions(struct volume *layer);
/* A region's own univels, or also those of the regions inside it; fails the test if it fails. */
struct mask *sera_head_mask(const struct region_set *set, size_t region, bool is_own);
void sera_head_destroy(struct region_set *set);
