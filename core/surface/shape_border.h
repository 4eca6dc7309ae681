#pragma once
/* The border voxels of a mask, numbered in voxel sequence, with the direction each one faces. */
#include "core/region/mask.h"

struct shape_border {
    const struct mask *mask; /* borrowed */
    struct mask *border;     /* voxels with a 6-neighbour outside */
    uint32_t *first;         /* [k][j][words] number of the first border voxel in each word */
    uint16_t *ijk;           /* [n][3] */
    float *normals;          /* [n][3] LPS unit vectors away from the inside; 0 0 0 where all sides are alike */
    size_t n;
};

/* Errors: ERROR_LIMIT more than max_voxels, ERROR_MEMORY. */
NODISCARD struct shape_border *shape_border_create(const struct mask *mask, size_t max_voxels, int n_threads,
                                                   struct error *err);
void shape_border_destroy(struct shape_border *border);
/* Number of the border voxel at an index; SIZE_MAX if there is none or the index is beyond the grid. */
size_t shape_border_number(const struct shape_border *border, int64_t i, int64_t j, int64_t k);
/* Inside bits of the 27 voxels at and around an index: bit 9 (dz + 1) + 3 (dy + 1) + dx + 1. */
uint32_t shape_border_around(const struct mask *mask, uint32_t i, uint32_t j, uint32_t k);
