/* Otsu's threshold: a histogram of samples, and the largest variance between two classes. */
#include "core/volume/otsu.h"

#include <math.h>

enum { BINS = 256 };
static const double most_samples = 2e6;

/* Every how many voxels along each axis one is looked at. */
static uint32_t stride_of(const struct volume *volume)
{
    const uint32_t *size = volume->grid.size;
    return (uint32_t)fmax(1, ceil(cbrt((double)size[0] * size[1] * size[2] / most_samples)));
}

double otsu_threshold(const struct volume *volume)
{
    const uint32_t *size = volume->grid.size, stride = stride_of(volume);
    double counts[BINS] = { 0 }, n_all = 0, sum_all = 0, range = volume->high - volume->low;
    if (!(range > 0))
        return NAN;
    for (uint32_t k = 0; k < size[2]; k += stride)
        for (uint32_t j = 0; j < size[1]; j += stride)
            for (uint32_t i = 0; i < size[0]; i += stride) {
                double bin = floor((volume_value(volume, i, j, k) - volume->low) / range * BINS);
                if (isfinite(bin))
                    counts[(int)fmin(fmax(bin, 0), BINS - 1)]++;
            }
    for (int bin = 0; bin < BINS; bin++) {
        n_all += counts[bin];
        sum_all += counts[bin] * bin;
    }
    double n = 0, sum = 0, most = -1;
    int first = 0, last = 0;
    for (int bin = 0; bin < BINS - 1; bin++) {
        n += counts[bin];
        sum += counts[bin] * bin;
        if (n == 0 || n == n_all)
            continue;
        double apart = sum / n - (sum_all - sum) / (n_all - n), between = n * (n_all - n) * apart * apart;
        if (between > most * (1 + 1e-12)) {
            most = between;
            first = bin;
        }
        if (between >= most * (1 - 1e-12))
            last = bin;
    }
    return most > 0 ? volume->low + ((first + last) / 2.0 + 1) * range / BINS : NAN;
}

struct box3 otsu_box_lps_mm(const struct volume *volume, double least)
{
    const uint32_t *size = volume->grid.size, stride = stride_of(volume);
    struct box3 ijk = box3_empty(), box = box3_empty();
    for (uint32_t k = 0; k < size[2]; k += stride)
        for (uint32_t j = 0; j < size[1]; j += stride)
            for (uint32_t i = 0; i < size[0]; i += stride)
                if (volume_value(volume, i, j, k) >= least)
                    box3_add(&ijk, vec3(i, j, k));
    if (box3_is_empty(&ijk))
        return box;
    double more = stride - 0.5;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 p = vec3(corner & 1 ? fmin(ijk.high.x + more, size[0] - 0.5) : fmax(ijk.low.x - more, -0.5),
                             corner & 2 ? fmin(ijk.high.y + more, size[1] - 0.5) : fmax(ijk.low.y - more, -0.5),
                             corner & 4 ? fmin(ijk.high.z + more, size[2] - 0.5) : fmax(ijk.low.z - more, -0.5));
        box3_add(&box, affine_point(&volume->grid.lps_mm_from_ijk, p));
    }
    return box;
}
