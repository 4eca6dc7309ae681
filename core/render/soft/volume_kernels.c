/* The inner loops of volumes for any processor, and the choice between them and newer ones. */
#include "core/derive/volume_bricks.h"
#include "core/render/soft/volume.h"
#include "core/render/soft/wash.h"

#define NAME(x) x##_portable
#define TARGET
#include "core/render/soft/volume_vectors.inc"

#define LANES_OR(v) ((((LONGS)(v))[0] | ((LONGS)(v))[1]) | (((LONGS)(v))[2] | ((LONGS)(v))[3]))
#define ANY_SET(v) (LANES_OR(v) != 0)

static inline FLOATS pick(INTS mask, FLOATS a, FLOATS b)
{
    return (FLOATS)(((INTS)a & mask) | ((INTS)b & ~mask));
}
static inline FLOATS root(FLOATS x)
{
    for (int l = 0; l < SOFT_LANES; l++)
        x[l] = sqrtf(x[l]);
    return x;
}
/* Products of the low and high halves, added. */
static inline INTS multiply_add(INTS a, INTS b)
{
    const INTS low_a = (INTS)((WORDS)a << 16) >> 16, low_b = (INTS)((WORDS)b << 16) >> 16;
    return low_a * low_b + (a >> 16) * (b >> 16);
}
#define PICK8(mask, a, b) pick(mask, a, b)
#define LEAST8(a, b) pick((a) < (b), a, b)
#define MOST8(a, b) pick((a) > (b), a, b)
#define SQRT8(x) root(x)
#define MADD16(a, b) multiply_add(a, b)

#define LOADER(NAME, TYPE) \
    static inline WORDS NAME(const void *base, WORDS at, int shift) \
    { \
        WORDS loaded; \
        for (int l = 0; l < SOFT_LANES; l++) { \
            TYPE value; \
            memcpy(&value, (const char *)base + ((size_t)at[l] << shift), sizeof value); \
            loaded[l] = value; \
        } \
        return loaded; \
    }
LOADER(load_32, uint32_t)
LOADER(load_16, uint16_t)
LOADER(load_8, uint8_t)
#define LOAD32 load_32
#define LOAD16 load_16
#define LOAD8 load_8
#include "core/render/soft/volume_kernels.inc"

const struct soft_volume_kernels soft_volume_kernels_portable = { "portable", compose_portable, depths_portable,
                                                                  wash_portable, paint_portable };

#if defined(__x86_64__)
extern const struct soft_volume_kernels soft_volume_kernels_avx2;
const struct soft_volume_kernels *soft_volume_kernels_of(const struct soft_kernels *kernels)
{
    return kernels == &soft_kernels_portable ? &soft_volume_kernels_portable : &soft_volume_kernels_avx2;
}
#else
const struct soft_volume_kernels *soft_volume_kernels_of(const struct soft_kernels *kernels)
{
    (void)kernels;
    return &soft_volume_kernels_portable;
}
#endif
