#pragma once
/* Dose-volume histograms: how much of a set of univels has which dose. The dose at a univel is that at its centre,
 * trilinear in the dose's own grid. A univel without a value (outside the dose's grid, or beside a voxel without one)
 * is counted apart, never as zero. Knows no regions, weights or scene. */
#include "core/volume/volume.h"

/* ---- histogram -------------------------------------------------------------------------------------------------- */

/* Bins are those of the upper bits of a positive float, DVH_OCTAVE_BINS between a value and its double: a bin is at
 * most 1/2048 as wide as the values in it, whatever the unit and however large a stray maximum elsewhere in the grid
 * is. Sum, least and greatest value are exact. */
enum { DVH_OCTAVE_BINS = 2048 };
struct dvh {
    double univel_cm3;
    double n;              /* univels with a value; a sum of parts where univels were sampled in several points */
    double n_missing;      /* univels without one, in the same way */
    double sum, low, high; /* of the values; low and high are 0 without a value */
    uint32_t first, n_bins;
    double *bins; /* univels in bins first to first + n_bins - 1; NULL: none */
};
void dvh_finish(struct dvh *dvh);
/* Adds univels of the same size, disjoint from those counted already. A zeroed dvh takes the other's univel_cm3.
 * errors ERROR_MEMORY: dvh is then unchanged */
NODISCARD bool dvh_add(struct dvh *dvh, const struct dvh *other, struct error *err);

/* Lower edge of a bin. Values inside a bin count as spread evenly; in the first one from low, in the last one to
 * high. */
double dvh_edge(uint32_t bin);
/* Univels with at least this value. */
double dvh_univels_from(const struct dvh *dvh, double value);
/* D_n: the largest value v such that at least n_univels univels are >= v; low for more than all, high for 0; NAN
 * without a value. */
double dvh_value_of_hottest(const struct dvh *dvh, double n_univels);
/* Counts into n equal bins from `from` on, in univels: the differential curve. Values beyond them are left out. */
void dvh_counts(const struct dvh *dvh, double from, double width, size_t n, double *counts);

/* ---- sweep ------------------------------------------------------------------------------------------------------ */

enum { DVH_MAX_PER_SIDE = 5 };
struct dvh_label {
    uint16_t label;
    int per_side; /* 1..DVH_MAX_PER_SIDE: a univel with a 6-neighbour of another label, or on the outside of the grid,
                     is sampled in per_side^3 points, spread evenly; any other in its centre */
};
struct dvh_sweep {
    const struct volume *labels;      /* U8 or U16 */
    const struct volume *const *rows; /* [n_rows] F32, slope 1, offset 0, all on one grid; NaN: no value */
    size_t n_rows;
    const struct volume *row_of; /* U8 on the labels' grid: which of the rows a univel's dose is in; n_rows and above:
                                    it has none. NULL: rows[0] */
    int n_threads;               /* 0: all cores; the counts are the same for any number, sums to rounding */
    bool is_general;             /* true: also parallel grids take the way of oblique ones; for tests */
};

/* Counts the univels of each of several labels, all in one pass. Grids whose axes are parallel, in any order and
 * direction, are read row by row; others point by point. Coordinates within 1e-5 of a dose voxel's centre are taken as
 * the centre, so that the same grid written twice meets its own values.
 *
 *   labels   n distinct ones
 *   dvhs     [n], overwritten; for dvh_finish. Zeroed on failure
 *   errors   ERROR_RANGE types, scales or grids other than said above; ERROR_LIMIT more than 2^32 - 1 samples;
 *            ERROR_MEMORY
 *   thread   any; the volumes are shared and frozen */
NODISCARD bool dvh_sweep(const struct dvh_sweep *sweep, const struct dvh_label *labels, size_t n, struct dvh *dvhs,
                         struct error *err);
