/* Reads figures off curves of dose over depth. */
#include "core/dose/profile.h"

bool profile_peak(const double *values, size_t n, size_t *at)
{
    bool has = false;
    for (size_t i = 0; i < n; i++)
        if (isfinite(values[i]) && (!has || values[i] > values[*at])) {
            *at = i;
            has = true;
        }
    return has;
}

bool profile_advantage_depth(const struct profile_line *line, const double *tumour_values, double normal_high,
                             double *depth_mm)
{
    for (size_t i = line->n; i-- > 0;) {
        if (!isfinite(tumour_values[i]) || tumour_values[i] < normal_high)
            continue;
        if (i + 1 == line->n || !isfinite(tumour_values[i + 1]))
            return false;
        double a = profile_depth(line, i), b = profile_depth(line, i + 1);
        *depth_mm = a + (b - a) * (tumour_values[i] - normal_high) / (tumour_values[i] - tumour_values[i + 1]);
        return true;
    }
    return false;
}
