#pragma once
/* A set of voxels as one bit per voxel, in rows of 64-bit words: the input of surface extraction. Every function gives
 * the same bits for any number of threads. */
#include <stdint.h>

#include "core/region/region.h"

struct mask {
    uint32_t size[3];
    uint32_t words; /* 64-bit words per row of size[0] voxels; bits past the end of a row are 0 */
    struct affine lps_mm_from_ijk;
    uint64_t *bits;                      /* [k][j][words], i fastest */
    uint32_t low_j, end_j, low_k, end_k; /* only rows low_j <= j < end_j of slices low_k <= k < end_k may have bits */
};

/* Creates a mask with uninitialized bits. Sides are 1..VOLUME_MAX_SIDE. Errors: ERROR_LIMIT, ERROR_MEMORY. */
NODISCARD struct mask *mask_create(const uint32_t size[3], const struct affine *lps_mm_from_ijk, struct error *err);
/* Creates a mask without a bit set. Untouched pages take no memory; who sets bits may narrow low and end. Errors: the
 * same. */
NODISCARD struct mask *mask_create_empty(const uint32_t size[3], const struct affine *lps_mm_from_ijk,
                                         struct error *err);
/* Sets the voxels of a layer that have one of the labels (in any order).
 *
 *   errors  ERROR_RANGE n_labels is 0; ERROR_UNSUPPORTED layer is neither U8 nor U16; ERROR_MEMORY
 *   thread  any */
NODISCARD struct mask *mask_from_labels(const struct volume *layer, const uint16_t *labels, size_t n_labels,
                                        int n_threads, struct error *err);
/* Sets the voxels of a region and of all its descendants, on the region's own grid: what its outer surface encloses.
 * Descendants on a layer with another grid are left out (they lie inside anyway). Errors: as mask_from_labels,
 * ERROR_RANGE no such region. */
NODISCARD struct mask *mask_from_region(const struct region_set *set, size_t region, int n_threads, struct error *err);
enum { MASK_MAX_FACTOR = 8 };
/* Reduces each block of factors[0] x factors[1] x factors[2] voxels to one voxel. It is inside if at least half of the
 * block (as far as it is in the grid) is; also where the shape would otherwise fall apart: a sheet thinner than half a
 * block keeps one layer of blocks, a thread its chain, a small piece its block. So nothing closed gets a hole and
 * nothing vanishes. Blocks stay in place: the outer faces are the same, except that a partial block reaches beyond the
 * old one.
 *
 *   factors  each 1 to MASK_MAX_FACTOR
 *   errors   ERROR_RANGE factors; ERROR_MEMORY
 *   thread   any */
NODISCARD struct mask *mask_reduce(const struct mask *mask, const uint32_t factors[3], int n_threads,
                                   struct error *err);
uint64_t mask_count(const struct mask *mask);
void mask_destroy(struct mask *mask);
