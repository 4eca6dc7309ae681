#pragma once
/* Gamma index: agreement of two doses in value and in place, at each voxel of the first. Knows volumes and numbers, no
 * scene. Any thread.
 *
 *   gamma(p) = min over q of sqrt( (D2(q) - D1(p))^2 / dD^2 + |q - p|^2 / dr^2 )
 *
 * with the dose difference dD and the distance dr; a voxel passes with gamma <= 1. D2 is tri-linear between the voxels
 * of the second dose.
 *
 *   source   D. A. Low, W. B. Harms, S. Mutic, J. A. Purdy, A technique for the quantitative evaluation of dose
 *            distributions, Med. Phys. 25 (1998) 656; dose difference as a part of a maximum (global) or of the value
 * at the point (local), and a threshold: M. Miften et al., AAPM TG-218, Med. Phys. 45 (2018) e53. */
#include <stdint.h>

#include "core/volume/volume.h"

struct gamma_options {
    double dose_percent; /* dD, in % of reference, if local of the first dose at the voxel */
    bool is_local;
    double reference;   /* 100 %, in the unit of both doses; > 0 */
    double distance_mm; /* dr; > 0 */
    double threshold;   /* voxels of the first dose under this value are left out */
    double most;        /* the search ends here: greater indices count as this one; > 1 */
};

enum { GAMMA_BINS = 50 };
struct gamma_facts {
    uint64_t n;                /* voxels with an index */
    uint64_t n_passed;         /* index <= 1 */
    uint64_t n_below;          /* left out: under the threshold, or local and not above 0 */
    uint64_t n_without;        /* left out: the second dose has no value at the voxel */
    double mean, max;          /* of the indices; 0 if there is none */
    uint64_t bins[GAMMA_BINS]; /* indices by most / GAMMA_BINS; a bin holds its upper end, the first one 0 too */
};

/* The indices at the voxels of the first dose; NaN where there is none.
 *
 *   first, second  F32, slope 1; NaN: no value; each on a grid of its own, in patient LPS, mm
 *   method   D2 is sampled in the middle of cubes, near before far, with sides of distance_mm / 2 down to
 *            distance_mm / 16; left out are cubes that, by the greatest change of D2 between neighbours, hold no index
 *            that is smaller by more than 0.005 and 1 %. The smallest is then followed along the gradient of D2.
 *   returns  one reference, the caller's, measured; NULL on failure. Equal input gives equal bytes.
 *   errors   ERROR_RANGE options, ERROR_MEMORY
 *   thread   any; runs on all cores */
NODISCARD struct volume *gamma_index(const struct volume *first, const struct volume *second,
                                     const struct gamma_options *options, struct gamma_facts *facts, struct error *err);
