#pragma once
/* The histogram of an image's finite values, as a result of the store. */
#include "core/derive/derive.h"

enum { IMAGE_HISTOGRAM_LEVELS = 65536, IMAGE_HISTOGRAM_MAX_BINS = 4096, IMAGE_HISTOGRAM_N_PERCENTILES = 5 };
extern const double image_histogram_percents[IMAGE_HISTOGRAM_N_PERCENTILES]; /* 0.1, 1, 50, 99, 99.9 */

struct image_histogram {
    struct derive_result base;
    double low, high;       /* smallest and largest finite value, in the image's unit; 0 and 0 without one */
    uint64_t n, n_left_out; /* voxels with a finite value, and the others */
    /* The smallest value that the given percentage of finite values do not exceed: exact for whole numbers, for real
     * ones within (high - low) / 2^28. NAN without a finite value. */
    double percentiles[IMAGE_HISTOGRAM_N_PERCENTILES];
    /* Voxels by ascending level; the value of a level is first + step * level. For 8 and 16 bits a level for each
     * stored value; for floats equal parts of low to high, whose middle that value is. */
    uint64_t levels[IMAGE_HISTOGRAM_LEVELS];
    double first, step;
};

/* index: of the plan's images. Unref with derive_result_unref. errors ERROR_MEMORY. thread any; uses all cores */
NODISCARD struct image_histogram *image_histogram_get(struct derive *derive, size_t index, struct error *err);
/* Sums the levels into 1..IMAGE_HISTOGRAM_MAX_BINS equal bins from low to high, high included. Of floats a level that
 * two bins share counts where its middle is. */
void image_histogram_counts(const struct image_histogram *histogram, size_t n_bins, uint64_t *counts);
