#pragma once
/* A reference curve: doses and fluences over depth along a beam and distance from its axis, computed in some phantom.
 * It lies nowhere in the patient; pictures and sums of dose must never take it for one. */
#include "core/dose/dose.h"

enum { CURVE_MAX_POINTS = 1000 }; /* depths, and radii */

struct dose_curve {
    char id[64];
    char name[128];
    char unit[16], per[64]; /* as struct dose */
    enum dose_quantity quantities[DOSE_N_QUANTITIES];
    bool is_per_ppm[DOSE_N_QUANTITIES];
    float *values[DOSE_N_QUANTITIES]; /* [depth][radius]; not-a-number where there is none */
    size_t n_columns;
    double *depths_mm, *radii_mm; /* rising */
    size_t n_depths, n_radii;
    struct vec3 center_lps_mm; /* of the coordinate system of the run that made it */
};
void dose_curve_finish(struct dose_curve *curve); /* and empties it */

/* Bi-linear between the points; false outside them and where one of them is none. */
bool dose_curve_value(const struct dose_curve *curve, size_t column, double depth_mm, double radius_mm, double *value);
/* The largest value on the axis and its depth; false when there is none. */
bool dose_curve_peak(const struct dose_curve *curve, size_t column, double *depth_mm, double *value);
