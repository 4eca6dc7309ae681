/* The inner loops of dvh_sweep in plain C, and their choice. */
#include "core/dose/dvh_kernels.h"

#include <math.h>
#include <string.h>

static void resample(const float *row, const struct dvh_axis *axis, uint32_t from, uint32_t to, float *out)
{
    for (uint32_t i = from; i < to; i++) {
        const float *pair = row + axis->at[i];
        float t = axis->between[i];
        out[i] = t == 0 ? pair[0] : pair[0] + t * (pair[1] - pair[0]);
    }
}

static void make_keys(const float *values, uint32_t n, int32_t base, int32_t last, int32_t *keys)
{
    for (uint32_t i = 0; i < n; i++) {
        int32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        int32_t key = (bits >> DVH_KEY_SHIFT) - base;
        key = key < 0 ? 0 : key;
        key = key > last ? last : key;
        keys[i] = isnan(values[i]) ? last + 1 : key;
    }
}

static void measure(const float *values, uint32_t n, struct dvh_sums *sums)
{
    for (uint32_t i = 0; i < n; i++) {
        float value = values[i];
        uint32_t lane = i % DVH_LANES;
        if (isnan(value))
            continue;
        sums->parts[lane] += (double)value;
        sums->low[lane] = value < sums->low[lane] ? value : sums->low[lane];
        sums->high[lane] = value > sums->high[lane] ? value : sums->high[lane];
    }
}

const struct dvh_kernels dvh_kernels_portable = { resample, make_keys, measure };
