/* Chooses the inner loops of dvh_sweep for the processor at hand. */
#include "core/dose/dvh_kernels.h"

#if defined(__x86_64__)
const struct dvh_kernels *dvh_kernels_here(void)
{
    return __builtin_cpu_supports("avx2") ? &dvh_kernels_avx2 : &dvh_kernels_portable;
}
#else
const struct dvh_kernels *dvh_kernels_here(void)
{
    return &dvh_kernels_portable;
}
#endif
