/* Weighted sums of volumes. */
#include "core/dose/combine.h"

#include <math.h>
#include <stdint.h>

static void combine_one(const float *const *raw, const float *factor, const float *offset, size_t n_terms, size_t i,
                        const float *before, float *sum, float range[2])
{
    float value = before ? before[i] + (raw[0][i] * factor[0] + offset[0]) : raw[0][i] * factor[0] + offset[0];
    for (size_t t = 1; t < n_terms; t++)
        value += raw[t][i] * factor[t] + offset[t];
    const bool is_finite = value - value == 0;
    sum[i] = is_finite ? value : NAN;
    range[0] = is_finite && value < range[0] ? value : range[0];
    range[1] = is_finite && value > range[1] ? value : range[1];
}

#if defined(__x86_64__)
#include <immintrin.h>

enum { LANES = 4 };

/* Sums i .. end - 1, a multiple of LANES; compiled for each number of terms. */
__attribute__((always_inline)) static inline void combine_lanes(const float *const *raw, const float *factor,
                                                                const float *offset, size_t n_terms, size_t i,
                                                                size_t end, const float *before, float *sum,
                                                                bool is_streaming, float range[2])
{
    __m128 low = _mm_set1_ps(range[0]), high = _mm_set1_ps(range[1]);
    const __m128 none = _mm_set1_ps(NAN);
    for (; i < end; i += LANES) {
        __m128 value = _mm_add_ps(_mm_mul_ps(_mm_loadu_ps(raw[0] + i), _mm_set1_ps(factor[0])), _mm_set1_ps(offset[0]));
        if (before)
            value = _mm_add_ps(_mm_loadu_ps(before + i), value);
        for (size_t t = 1; t < n_terms; t++)
            value = _mm_add_ps(value, _mm_add_ps(_mm_mul_ps(_mm_loadu_ps(raw[t] + i), _mm_set1_ps(factor[t])),
                                                 _mm_set1_ps(offset[t])));
        const __m128 is_finite = _mm_cmpeq_ps(_mm_sub_ps(value, value), _mm_setzero_ps());
        value = _mm_or_ps(_mm_and_ps(is_finite, value), _mm_andnot_ps(is_finite, none));
        low = _mm_min_ps(value, low); /* the second one where a value is not a number */
        high = _mm_max_ps(value, high);
        if (is_streaming)
            _mm_stream_ps(sum + i, value);
        else
            _mm_storeu_ps(sum + i, value);
    }
    float lows[LANES], highs[LANES];
    _mm_storeu_ps(lows, low);
    _mm_storeu_ps(highs, high);
    for (int l = 0; l < LANES; l++) {
        range[0] = lows[l] < range[0] ? lows[l] : range[0];
        range[1] = highs[l] > range[1] ? highs[l] : range[1];
    }
}

void dose_combine(const float *const *raw, const float *factor, const float *offset, size_t n_terms, size_t n,
                  const float *before, float *sum, bool is_streaming, float range[2])
{
    size_t i = 0;
    for (; i < n && is_streaming && (uintptr_t)(sum + i) % sizeof(__m128) != 0; i++)
        combine_one(raw, factor, offset, n_terms, i, before, sum, range);
    const size_t end = i + (n - i) / LANES * LANES;
#define CASE(N) \
    case N: combine_lanes(raw, factor, offset, N, i, end, before, sum, is_streaming, range); break
    switch (n_terms) {
        CASE(1);
        CASE(2);
        CASE(3);
        CASE(4);
        CASE(5);
    default: combine_lanes(raw, factor, offset, n_terms, i, end, before, sum, is_streaming, range); break;
    }
#undef CASE
    for (i = end; i < n; i++)
        combine_one(raw, factor, offset, n_terms, i, before, sum, range);
}

void dose_combine_flush(void)
{
    _mm_sfence();
}

#else
void dose_combine(const float *const *raw, const float *factor, const float *offset, size_t n_terms, size_t n,
                  const float *before, float *sum, bool is_streaming, float range[2])
{
    (void)is_streaming;
    for (size_t i = 0; i < n; i++)
        combine_one(raw, factor, offset, n_terms, i, before, sum, range);
}

void dose_combine_flush(void)
{
}
#endif
