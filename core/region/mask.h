#pragma once
/* One bit per voxel, in rows of 64-bit words: what extraction works on. Deterministic for any number of threads. */
#include <stdint.h>

#include "core/region/region.h"

struct mask {
    uint32_t size[3];
    uint32_t words; /* 64-bit words in a row of size[0] voxels; bits past the end are 0 */
    struct affine lps_mm_from_ijk;
    uint64_t *bits;                      /* [k][j][words] */
    uint32_t low_j, end_j, low_k, end_k; /* no bit is set in rows and slices before low and from end on */
};

/* Bits are left to be written; sides 1..VOLUME_MAX_SIDE. errors ERROR_LIMIT, ERROR_MEMORY */
NODISCARD struct mask *mask_create(const uint32_t size[3], const struct affine *lps_mm_from_ijk, struct error *err);
/* No bit is set; memory is only taken where one will be, so whoever sets some may tell the reach. errors as above */
NODISCARD struct mask *mask_create_empty(const uint32_t size[3], const struct affine *lps_mm_from_ijk,
                                         struct error *err);
/* Voxels of a layer that carry one of the labels (sorted or not). errors ERROR_RANGE n_labels 0, ERROR_UNSUPPORTED the
 * layer is neither U8 nor U16, ERROR_MEMORY */
NODISCARD struct mask *mask_from_labels(const struct volume *layer, const uint16_t *labels, size_t n_labels,
                                        int n_threads, struct error *err);
/* A region with everything inside it (its descendants), on the region's own grid: what its outer surface encloses.
 * A descendant on a layer with another grid is left out (it lies inside anyway). errors as above, ERROR_RANGE no such
 * region */
NODISCARD struct mask *mask_from_region(const struct region_set *set, size_t region, int n_threads, struct error *err);
enum { MASK_MAX_FACTOR = 8 };
/* Every block of factors[0] x factors[1] x factors[2] voxels becomes one voxel, inside when at least half of the block
 * that exists is, and also where the shape would otherwise come apart: a sheet thinner than half a block keeps its one
 * layer of blocks, a thread its chain, a small piece its block, so that nothing closed gets a hole and nothing
 * vanishes. Geometry follows: every block stays where it is, so the outer faces are the same but for a partial block,
 * which reaches beyond the old one. factors each 1 to MASK_MAX_FACTOR. errors ERROR_RANGE factors, ERROR_MEMORY */
NODISCARD struct mask *mask_reduce(const struct mask *mask, const uint32_t factors[3], int n_threads,
                                   struct error *err);
uint64_t mask_count(const struct mask *mask);
void mask_destroy(struct mask *mask);
