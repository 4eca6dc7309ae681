#pragma once
/* Fluences that change little within a centimetre, those of photons and of fast neutrons, in the matter of cells twice
 * as wide as blocks; smoothed, and read between them. Knows no histories. Built once a run, then constant. */
#include "core/transport/geometry.h"
#include "core/transport/phase_space.h"

#define SMOOTH_CELL_CM (2 * GEOMETRY_BLOCK_CM)
#define SMOOTH_MAX_CM 1.6 /* of a Gaussian */

/* Wider cells along each axis. */
static inline int32_t smooth_n(const struct geometry *geometry, int axis)
{
    return (geometry->n_blocks[axis] + 1) / 2;
}
static inline size_t smooth_n_cells(const struct geometry *geometry)
{
    return (size_t)smooth_n(geometry, 0) * (size_t)smooth_n(geometry, 1) * (size_t)smooth_n(geometry, 2);
}

/* The wider cell of a position in the box. */
static inline size_t smooth_cell(const struct geometry *geometry, const float position[3])
{
    const float per_cm = (float)(1 / SMOOTH_CELL_CM);
    return ((size_t)(uint32_t)(position[2] * per_cm) * (size_t)smooth_n(geometry, 1) +
            (size_t)(uint32_t)(position[1] * per_cm)) *
               (size_t)smooth_n(geometry, 0) +
           (size_t)(uint32_t)(position[0] * per_cm);
}

enum { SMOOTH_BAND = 7, SMOOTH_WIDTH = 2 * SMOOTH_BAND + 1 };

/* Numbers of each lane in a wider cell. */
typedef float smooth_lanes[PHASE_SPACE_LANES];
/* Weights of the cells about a cell along an axis, for its value. */
typedef float smooth_band[SMOOTH_WIDTH];

struct smooth_cells {
    int32_t n[3];
    size_t step[3], n_cells, n_held;
    uint32_t *held;   /* those that hold matter, in order */
    float *volume;    /* of a wider cell's matter, cm3; 0: none */
    float *middle[3]; /* of that matter along an axis, in cells from the cell's middle */
};
/* errors  ERROR_MEMORY */
NODISCARD bool smooth_cells_init(struct smooth_cells *cells, const struct geometry *geometry, struct error *err);
void smooth_cells_finish(struct smooth_cells *cells);

struct smoothing {
    smooth_band *bands[3]; /* by index in held */
};
/* Along each axis in turn a line is fitted to the cells about a cell, near ones and those with much matter counting
 * more; what that takes from a field is given back twice (J. W. Tukey's twicing, 1977, once more). So a field stays as
 * it is if it is a line, up to the surface, or curves less than the fit's width: a Gaussian of 3 cm loses less than 1
 * %.
 *
 *   sigma_cm  of the weights by distance, at most SMOOTH_MAX_CM
 *   errors    ERROR_MEMORY */
NODISCARD bool smoothing_init(struct smoothing *smoothing, const struct smooth_cells *cells, double sigma_cm,
                              struct error *err);
void smoothing_finish(struct smoothing *smoothing);

/* values  by wider cell: sums over its matter in, means at its middle out
 * room    as many; needs no values */
void smooth_field(const struct smooth_cells *cells, const struct smoothing *smoothing, smooth_lanes *values,
                  smooth_lanes *room);
/* Mean of a block by the parabola along each axis that has the wider cells' means, or by a line at the surface. */
void smooth_at(const struct smooth_cells *cells, smooth_lanes *values, const int32_t block[3],
               float at[PHASE_SPACE_LANES]);
