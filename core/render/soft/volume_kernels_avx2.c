/* The inner loops of volumes for processors with AVX2. */
#include "core/derive/volume_bricks.h"
#include "core/render/soft/volume.h"
#include "core/render/soft/wash.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2")))
#include "core/render/soft/volume_vectors.inc"

#define ANY_SET(v) (!_mm256_testz_si256((__m256i)(v), (__m256i)(v)))
#define PICK8(mask, a, b) ((FLOATS)_mm256_blendv_ps((__m256)(b), (__m256)(a), (__m256)(mask)))
#define LEAST8(a, b) ((FLOATS)_mm256_min_ps((__m256)(a), (__m256)(b)))
#define MOST8(a, b) ((FLOATS)_mm256_max_ps((__m256)(a), (__m256)(b)))
#define SQRT8(x) ((FLOATS)_mm256_sqrt_ps((__m256)(x)))
#define MADD16(a, b) ((INTS)_mm256_madd_epi16((__m256i)(a), (__m256i)(b)))

/* Single loads and inserts: the processor's own gathering loads are slower on many (they were here by three times). */
#define LOADER(NAME, TYPE) \
    TARGET static inline WORDS NAME(const void *base, WORDS at, int shift) \
    { \
        const char *from = base; \
        const __m128i low = _mm256_castsi256_si128((__m256i)at), high = _mm256_extracti128_si256((__m256i)at, 1); \
        const uint64_t at_01 = (uint64_t)_mm_cvtsi128_si64(low), at_23 = (uint64_t)_mm_extract_epi64(low, 1), \
                       at_45 = (uint64_t)_mm_cvtsi128_si64(high), at_67 = (uint64_t)_mm_extract_epi64(high, 1); \
        TYPE v[SOFT_LANES]; \
        memcpy(&v[0], from + ((at_01 & 0xffffffffu) << shift), sizeof(TYPE)); \
        memcpy(&v[1], from + (at_01 >> 32 << shift), sizeof(TYPE)); \
        memcpy(&v[2], from + ((at_23 & 0xffffffffu) << shift), sizeof(TYPE)); \
        memcpy(&v[3], from + (at_23 >> 32 << shift), sizeof(TYPE)); \
        memcpy(&v[4], from + ((at_45 & 0xffffffffu) << shift), sizeof(TYPE)); \
        memcpy(&v[5], from + (at_45 >> 32 << shift), sizeof(TYPE)); \
        memcpy(&v[6], from + ((at_67 & 0xffffffffu) << shift), sizeof(TYPE)); \
        memcpy(&v[7], from + (at_67 >> 32 << shift), sizeof(TYPE)); \
        return (WORDS)_mm256_setr_epi32((int)v[0], (int)v[1], (int)v[2], (int)v[3], (int)v[4], (int)v[5], (int)v[6], \
                                        (int)v[7]); \
    }
LOADER(load_32, uint32_t)
LOADER(load_16, uint16_t)
LOADER(load_8, uint8_t)
#define LOAD32 load_32
#define LOAD16 load_16
#define LOAD8 load_8
#include "core/render/soft/volume_kernels.inc"

extern const struct soft_volume_kernels soft_volume_kernels_avx2;
const struct soft_volume_kernels soft_volume_kernels_avx2 = { "AVX2", compose_avx2, depths_avx2, wash_avx2,
                                                              paint_avx2 };
#endif
