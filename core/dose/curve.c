/* Interpolates reference curves. */
#include "core/dose/curve.h"

#include <math.h>
#include <stdlib.h>

void dose_curve_finish(struct dose_curve *curve)
{
    for (size_t c = 0; c < curve->n_columns; c++)
        free(curve->values[c]);
    free(curve->depths_mm);
    free(curve->radii_mm);
    *curve = (struct dose_curve){ 0 };
}

/* Finds the last point at or below x, and the fraction of the way to the next point. */
static bool find(const double *points, size_t n, double x, size_t *below, double *t)
{
    if (n == 0 || !(x >= points[0] && x <= points[n - 1]))
        return false;
    size_t low = 0, high = n - 1;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (points[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    *below = x >= points[high] ? high : low;
    *t = *below + 1 < n ? (x - points[*below]) / (points[*below + 1] - points[*below]) : 0;
    return true;
}

bool dose_curve_value(const struct dose_curve *curve, size_t column, double depth_mm, double radius_mm, double *value)
{
    size_t d, r;
    double s, t, sum = 0;
    if (!find(curve->depths_mm, curve->n_depths, depth_mm, &d, &s) ||
        !find(curve->radii_mm, curve->n_radii, radius_mm, &r, &t))
        return false;
    const float *at = &curve->values[column][d * curve->n_radii + r];
    for (size_t corner = 0; corner < 4; corner++) {
        double weight = (corner & 1 ? t : 1 - t) * (corner & 2 ? s : 1 - s);
        if (weight > 0)
            sum += weight * (double)at[(corner & 2 ? curve->n_radii : 0) + (corner & 1)];
    }
    *value = sum;
    return isfinite(sum);
}

bool dose_curve_peak(const struct dose_curve *curve, size_t column, double *depth_mm, double *value)
{
    bool is_found = false;
    for (size_t d = 0; d < curve->n_depths; d++) {
        double here = (double)curve->values[column][d * curve->n_radii];
        if (!isfinite(here) || (is_found && here <= *value))
            continue;
        *depth_mm = curve->depths_mm[d];
        *value = here;
        is_found = true;
    }
    return is_found;
}
