/* The inner loops of the rasteriser for processors with AVX2. */
#include "core/render/soft/kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2")))
#define ANY_SET(v) (!_mm256_testz_si256((__m256i)(v), (__m256i)(v)))
#define ALL_SET(v) (_mm256_movemask_epi8((__m256i)(v)) == -1)
#include "core/render/soft/kernels.inc"
#include "core/render/soft/plane_kernels.inc"

#include "core/render/soft/cap_kernels.inc"

extern const struct soft_kernels soft_kernels_avx2;
const struct soft_kernels soft_kernels_avx2 = { "AVX2",       shade_avx2,  classify_avx2, raster_avx2,
                                                compose_avx2, sample_avx2, cover_avx2,    halve_avx2 };
#endif
