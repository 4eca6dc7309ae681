#pragma once
/* Inside core/derive: bricks of a dose's grid, in which a field is combined, and the tissues that read each of them. */
#include "core/derive/dose_field.h"

/* Voxels along each axis of a brick. Lines along i are long, as memory is read fastest so. */
enum { DOSE_BRICK_I = 32, DOSE_BRICK_J = 8, DOSE_BRICK_K = 8 };
static inline uint32_t dose_brick_side(int axis)
{
    return axis == 0 ? DOSE_BRICK_I : axis == 1 ? DOSE_BRICK_J : DOSE_BRICK_K;
}
static inline uint32_t dose_n_bricks(const struct grid *grid, int axis)
{
    return (grid->size[axis] + dose_brick_side(axis) - 1) / dose_brick_side(axis);
}

/* Points that are read, in index space: a box, or a plane within it. */
struct dose_part {
    double low_ijk[3], high_ijk[3];
    bool is_plane;
    double normal[3], position; /* normal . ijk == position */
};
/* The bricks with a voxel that has a part in a value at a point of a box in index space: first and last along each
 * axis. False: none. */
bool dose_bricks_around(const struct grid *grid, const double low_ijk[3], const double high_ijk[3], uint32_t first[3],
                        uint32_t last[3]);
/* True if a brick may have a voxel with a part in a value on the plane. */
bool dose_brick_meets(const struct dose_part *plane, uint32_t x, uint32_t y, uint32_t z);

/* Which rows of weights a univel reads in each brick, as a result of the store. */
struct dose_bricks {
    struct derive_result base;
    uint32_t n[3];
    _Atomic uint32_t *rows; /* [n_k][n_j][n_i], bit r: row r */
};
/* errors ERROR_MEMORY. thread any; reads all univels, on all cores */
NODISCARD struct dose_bricks *dose_bricks_get(struct derive *derive, const struct dose_choice *choice,
                                              const struct grid *grid, const struct tissue_rows *tissue,
                                              struct error *err);
