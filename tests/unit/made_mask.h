#pragma once
/* Masks for tests of surfaces: empty or random, with access by voxel; and empty volumes. */
#include "core/region/mask.h"
#include "core/surface/surface.h"

extern const struct affine unit_map;

struct volume *layer_make(uint32_t nx, uint32_t ny, uint32_t nz, enum voxel_type type,
                          const struct affine *map); /* all zeros */

struct mask *mask_make(uint32_t nx, uint32_t ny, uint32_t nz, const struct affine *map);
void mask_put(struct mask *mask, uint32_t i, uint32_t j, uint32_t k);
bool mask_has(const struct mask *mask, int64_t i, int64_t j, int64_t k); /* beyond the grid: false */
uint32_t next_random(uint64_t *state); /* splitmix64: the same sequence on every machine */
/* A block of 2 x 2 x 2 voxels; bit i + 2 j + 4 k of `inside` is voxel (i, j, k). */
struct mask *mask_of_corners(int inside, const struct affine *map);
/* percent of the voxels at random, and the middle one */
struct mask *random_mask(uint32_t nx, uint32_t ny, uint32_t nz, uint32_t percent, uint64_t seed,
                         const struct affine *map);
struct mesh *made_surface(enum surface_algorithm algorithm, const struct mask *mask, int n_threads,
                          bool close_at_border);
void assert_same_bytes(const struct mesh *a, const struct mesh *b);
/* Euler number of the surface that cuts every crossed grid edge once, connects no two inside corners across a face, and
 * is closed at the border. Found without a case table. */
long euler_of_surface(const struct mask *mask);
