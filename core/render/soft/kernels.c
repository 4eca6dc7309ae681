/* The inner loops of the rasteriser for any processor, and the choice between them and newer ones. */
#include "core/render/soft/kernels.h"

#define NAME(x) x##_portable
#define TARGET
/* of vectors whose lanes are 0 or -1 */
#define LANES_OR(v) ((((LONGS)(v))[0] | ((LONGS)(v))[1]) | (((LONGS)(v))[2] | ((LONGS)(v))[3]))
#define LANES_AND(v) ((((LONGS)(v))[0] & ((LONGS)(v))[1]) & (((LONGS)(v))[2] & ((LONGS)(v))[3]))
#define ANY_SET(v) (LANES_OR(v) != 0)
#define ALL_SET(v) (LANES_AND(v) == -1)
#include "core/render/soft/kernels.inc"
#include "core/render/soft/plane_kernels.inc"

#include "core/render/soft/cap_kernels.inc"

/* A sample is stored as one 32-bit word, whose bytes must be those of the image. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "the software rasteriser packs samples for little-endian machines");

const struct soft_kernels soft_kernels_portable = { "portable",      shade_portable,   classify_portable,
                                                    raster_portable, compose_portable, sample_portable,
                                                    cover_portable,  halve_portable };

uint32_t soft_light(const struct soft_lighting *lighting, const float normal_lps[3], const float towards_lps[3])
{
    return light_at(lighting, normal_lps[0], normal_lps[1], normal_lps[2], towards_lps[0], towards_lps[1],
                    towards_lps[2]);
}

#if defined(__x86_64__)
extern const struct soft_kernels soft_kernels_avx2;
const struct soft_kernels *soft_kernels_best(void)
{
    return __builtin_cpu_supports("avx2") ? &soft_kernels_avx2 : &soft_kernels_portable;
}
#else
const struct soft_kernels *soft_kernels_best(void)
{
    return &soft_kernels_portable;
}
#endif
