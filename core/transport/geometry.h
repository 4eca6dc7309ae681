#pragma once
/* Materials in space, and the cells of a tally, in one frame: axes of the voxels, cm, origin in a corner of a box
 * around the matter. Built once a run, then constant: any thread. */
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "core/volume/volume.h"

enum {
    GEOMETRY_MIXED = 255,
    GEOMETRY_MAX_CELLS = 500000,
};
#define GEOMETRY_BLOCK_CM 0.5
#define GEOMETRY_PAD_CM 2.0 /* of air around the matter: cells at its surface lie within */

struct cell_row {
    uint32_t begin, n; /* cells that follow each other */
};

struct geometry {
    uint32_t n[3];
    const uint8_t *voxels;     /* material by voxel, 0 air; borrowed */
    float per_cm[3], shift[3]; /* voxel index = position * per_cm + shift */
    float size_cm[3];          /* of the box */
    int32_t n_blocks[3];
    uint8_t *blocks; /* material of a block, or GEOMETRY_MIXED */
    uint8_t *clear;  /* widths of a block that are air all round it */

    struct grid cells; /* of the tally, in patient coordinates */
    float cells_per_cm[3], cells_shift[3];
    int32_t n_cells[3];
    bool are_cells_blocks; /* each cell is a block, and of the same index */
    float *matter;         /* share of a cell that is not air */
    struct cell_row *rows; /* with all cells that hold matter */
    size_t n_rows;

    struct vec3 axis_lps[3], corner_lps_mm; /* of the box */
};

/* Takes nothing over; voxels stay the caller's.
 *
 *   voxels   [k][j][i] as grid, materials from 1 to n_materials, 0 air
 *   cells    a grid with the axes of the voxels' grid, either way along each; NULL: cells of cell_mm over the matter
 *   cancel   NULL: not wanted
 *   errors   ERROR_RANGE axes that are not at right angles, or not those of the voxels; no matter at all; ERROR_LIMIT
 *            more than GEOMETRY_MAX_CELLS cells; ERROR_MEMORY; ERROR_CANCELLED, within a slice of voxels */
NODISCARD bool geometry_init(struct geometry *geometry, const struct grid *grid, const uint8_t *voxels,
                             const struct grid *cells, double cell_mm, const atomic_bool *cancel, struct error *err);
void geometry_finish(struct geometry *geometry);

/* True if a cell lies wholly in the box: particles are followed in all of it. */
bool geometry_holds_cell(const struct geometry *geometry, size_t cell);

/* A patient point in the box's frame, and a direction. */
void geometry_place(const struct geometry *geometry, struct vec3 point_lps_mm, double position_cm[3]);
void geometry_direct(const struct geometry *geometry, struct vec3 direction_lps, double direction[3]);

/* Block at a position; -1 outside the box. */
static inline ptrdiff_t geometry_block(const struct geometry *geometry, const float position[3])
{
    const float per_cm = (float)(1 / GEOMETRY_BLOCK_CM);
    if (!(position[0] >= 0 && position[1] >= 0 && position[2] >= 0))
        return -1;
    int32_t i = (int32_t)(position[0] * per_cm), j = (int32_t)(position[1] * per_cm),
            k = (int32_t)(position[2] * per_cm);
    if (i >= geometry->n_blocks[0] || j >= geometry->n_blocks[1] || k >= geometry->n_blocks[2])
        return -1;
    return ((ptrdiff_t)k * geometry->n_blocks[1] + j) * geometry->n_blocks[0] + i;
}

/* Material at a position in a block; -1 outside the box. */
static inline int geometry_material_in(const struct geometry *geometry, ptrdiff_t block, const float position[3])
{
    if (block < 0)
        return -1;
    uint8_t material = geometry->blocks[block];
    if (material != GEOMETRY_MIXED)
        return material;
    float index[3];
    for (int axis = 0; axis < 3; axis++) {
        index[axis] = position[axis] * geometry->per_cm[axis] + geometry->shift[axis];
        if (!(index[axis] >= 0 && index[axis] < (float)geometry->n[axis]))
            return 0;
    }
    return geometry->voxels[((size_t)(uint32_t)index[2] * geometry->n[1] + (uint32_t)index[1]) * geometry->n[0] +
                            (uint32_t)index[0]];
}

/* Cell of the tally at a position; -1 outside. */
static inline ptrdiff_t geometry_cell(const struct geometry *geometry, const float position[3])
{
    int32_t index[3];
    for (int axis = 0; axis < 3; axis++) {
        float at = position[axis] * geometry->cells_per_cm[axis] + geometry->cells_shift[axis];
        if (!(at >= 0 && at < (float)geometry->n_cells[axis]))
            return -1;
        index[axis] = (int32_t)at;
    }
    return ((ptrdiff_t)index[2] * geometry->n_cells[1] + index[1]) * geometry->n_cells[0] + index[0];
}
