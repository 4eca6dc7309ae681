#pragma once
/* A reference curve: doses and fluences over depth along a beam and distance from its axis, computed in some phantom.
 * It has no position in the patient; pictures and sums of dose must never use it. Any thread. */
#include "core/dose/dose.h"

enum { CURVE_MAX_POINTS = 1000 }; /* limit for depths, and for radii */

struct dose_curve {
    char id[64];
    char name[128];
    char unit[16], per[64]; /* as in struct dose */
    enum dose_quantity quantities[DOSE_N_QUANTITIES];
    bool is_per_ppm[DOSE_N_QUANTITIES];
    float *values[DOSE_N_QUANTITIES]; /* [depth][radius]; NaN where there is no value */
    size_t n_columns;
    double *depths_mm, *radii_mm; /* ascending */
    size_t n_depths, n_radii;
    struct vec3 center_lps_mm; /* in the coordinate system of the run that made it */
};
void dose_curve_finish(struct dose_curve *curve); /* frees what it owns and zeroes it */

/* Bilinear interpolation. Returns false outside the points, or if one of the four has no value. */
bool dose_curve_value(const struct dose_curve *curve, size_t column, double depth_mm, double radius_mm, double *value);
/* Largest value on the axis and its depth; false if there is none. */
bool dose_curve_peak(const struct dose_curve *curve, size_t column, double *depth_mm, double *value);
