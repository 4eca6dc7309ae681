/* The inner loops of dvh_sweep for processors with AVX2. */
#include "core/dose/dvh_kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>
#include <math.h>

#define TARGET __attribute__((target("avx2")))

/* Eight univels in line read eight dose voxels and their neighbours at once, and put each at its place. */
TARGET static void resample_avx2(const float *row, const struct dvh_axis *axis, uint32_t from, uint32_t to, float *out)
{
    if (!axis->is_dense) {
        dvh_kernels_portable.resample(row, axis, from, to, out);
        return;
    }
    for (uint32_t i = from / DVH_LANES * DVH_LANES; i < to; i += DVH_LANES) {
        const int32_t *at = axis->at + i;
        int32_t base = at[0] < at[DVH_LANES - 1] ? at[0] : at[DVH_LANES - 1];
        __m256i lanes =
            _mm256_sub_epi32(_mm256_loadu_si256((const __m256i *)(const void *)at), _mm256_set1_epi32(base));
        __m256 here = _mm256_permutevar8x32_ps(_mm256_loadu_ps(row + base), lanes),
               next = _mm256_permutevar8x32_ps(_mm256_loadu_ps(row + base + 1), lanes);
        __m256 t = _mm256_loadu_ps(axis->between + i);
        __m256 mixed = _mm256_add_ps(here, _mm256_mul_ps(t, _mm256_sub_ps(next, here)));
        __m256 is_voxel = _mm256_cmp_ps(t, _mm256_setzero_ps(), _CMP_EQ_OQ);
        _mm256_storeu_ps(out + i, _mm256_blendv_ps(mixed, here, is_voxel));
    }
}

TARGET static void keys_avx2(const float *values, uint32_t n, int32_t base, int32_t last, int32_t *keys)
{
    uint32_t i = 0;
    const __m256i bases = _mm256_set1_epi32(base), lasts = _mm256_set1_epi32(last), nones = _mm256_set1_epi32(last + 1);
    for (; i + DVH_LANES <= n; i += DVH_LANES) {
        __m256 value = _mm256_loadu_ps(values + i);
        __m256i key = _mm256_sub_epi32(_mm256_srai_epi32(_mm256_castps_si256(value), DVH_KEY_SHIFT), bases);
        key = _mm256_min_epi32(_mm256_max_epi32(key, _mm256_setzero_si256()), lasts);
        __m256i is_none = _mm256_castps_si256(_mm256_cmp_ps(value, value, _CMP_UNORD_Q));
        _mm256_storeu_si256((__m256i *)(void *)(keys + i), _mm256_blendv_epi8(key, nones, is_none));
    }
    dvh_kernels_portable.keys(values + i, n - i, base, last, keys + i);
}

TARGET static void measure_avx2(const float *values, uint32_t n, struct dvh_sums *sums)
{
    static const int32_t masks[2 * DVH_LANES] = { -1, -1, -1, -1, -1, -1, -1, -1 };
    __m256d lower = _mm256_loadu_pd(sums->parts), upper = _mm256_loadu_pd(sums->parts + 4);
    __m256 low = _mm256_loadu_ps(sums->low), high = _mm256_loadu_ps(sums->high);
    const __m256 none = _mm256_set1_ps(NAN);
    for (uint32_t i = 0; i < n; i += DVH_LANES) {
        __m256 value;
        if (i + DVH_LANES <= n) {
            value = _mm256_loadu_ps(values + i);
        } else {
            __m256i mask = _mm256_loadu_si256((const __m256i *)(const void *)(masks + DVH_LANES - (n - i)));
            value = _mm256_blendv_ps(none, _mm256_maskload_ps(values + i, mask), _mm256_castsi256_ps(mask));
        }
        /* with a NaN, these two give their second operand */
        low = _mm256_min_ps(value, low);
        high = _mm256_max_ps(value, high);
        value = _mm256_and_ps(value, _mm256_cmp_ps(value, value, _CMP_ORD_Q));
        lower = _mm256_add_pd(lower, _mm256_cvtps_pd(_mm256_castps256_ps128(value)));
        upper = _mm256_add_pd(upper, _mm256_cvtps_pd(_mm256_extractf128_ps(value, 1)));
    }
    _mm256_storeu_pd(sums->parts, lower);
    _mm256_storeu_pd(sums->parts + 4, upper);
    _mm256_storeu_ps(sums->low, low);
    _mm256_storeu_ps(sums->high, high);
}

const struct dvh_kernels dvh_kernels_avx2 = { resample_avx2, keys_avx2, measure_avx2 };
#endif
