#pragma once
/* Inside core/derive: photon-isoeffective doses from the physical fields of their components. An isoeffective dose is
 * not linear in its components: between voxels the components are interpolated, then mapped. Its rows, which pictures
 * and histograms interpolate, are therefore filled on a finer grid, so that what is read between them differs little
 * from that. Other recoils count as fast neutrons. */
#include "core/derive/dose_field.h"

struct isoeffective_rows; /* the components of each row */

typedef struct dose_field *dose_field_getter(struct derive *derive, const struct dose_choice *choice,
                                             struct error *err);
/* get: dose_field_get, for the fields of components.
 * errors  ERROR_RANGE the dose's unit is neither Gy nor cGy; ERROR_UNSUPPORTED the components have several grids; those
 *         of dose_field_get of the components */
NODISCARD struct isoeffective_rows *isoeffective_rows_create(struct derive *derive, const struct dose_choice *choice,
                                                             dose_field_getter *get, struct error *err);
void isoeffective_rows_destroy(struct isoeffective_rows *rows);

/* The grid that the rows are to be filled on: each voxel of the components' grid in factors[0] x factors[1] x
 * factors[2], odd numbers, so that its centre is one of theirs and the outer faces are the same.
 *
 *   factors  the smallest with which, at the middle of each edge between two voxels, the dose between the finer voxels
 *            differs by at most ISOEFFECTIVE_ERROR / 3 of itself, or of 1 % of the maximum where it is lower: the error
 *            of a linear interpolation falls with the square of the step, and those of the three axes add up
 *   limit    most voxels in all rows; beyond it the axes with the least error stay coarser
 *   error    what is left of the error by this estimate, as a part of the dose */
#define ISOEFFECTIVE_ERROR 0.001
NODISCARD bool isoeffective_rows_grid(const struct isoeffective_rows *rows, uint64_t limit, struct grid *grid,
                                      uint32_t factors[3], double *error, struct error *err);
/* Fills one row on that grid. errors ERROR_MEMORY */
NODISCARD bool isoeffective_rows_fill(const struct isoeffective_rows *rows, size_t row, const uint32_t factors[3],
                                      struct volume *volume, struct error *err);
/* The dose at a point with the weights of a row: components as volume_sample, then mapped. False: there is none. */
bool isoeffective_rows_value(const struct isoeffective_rows *rows, size_t row, struct vec3 point_lps_mm, double *value);
/* The doses that are mapped at a point: boron, nitrogen, fast with other recoils, gamma. False: there are none. */
bool isoeffective_rows_components(const struct isoeffective_rows *rows, size_t row, struct vec3 point_lps_mm,
                                  double gy[4]);
double isoeffective_rows_unit_gy(const struct isoeffective_rows *rows); /* one unit of the dose */
