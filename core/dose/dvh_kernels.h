#pragma once
/* Inside core/dose: the inner loops of dvh_sweep, for any processor and for those with AVX2; both give the same bits.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { DVH_LANES = 8, DVH_PADDING = 2 * DVH_LANES };

/* Maps univels along a row to positions along a row of dose voxels. Arrays are padded to whole vectors. */
struct dvh_axis {
    int32_t *at;    /* [n] voxel at or before it */
    float *between; /* [n] from that voxel to the next, 0..1 but not 1; NaN: outside of the grid */
    uint32_t n;
    bool is_dense; /* any DVH_LANES univels in line, from a multiple of that on, lie within DVH_LANES dose voxels */
};

/* Lane l gets values l, l + DVH_LANES, ... of each call: the order of additions is the same on every processor. */
struct dvh_sums {
    double parts[DVH_LANES];
    float low[DVH_LANES], high[DVH_LANES]; /* +inf and -inf without a value */
};

struct dvh_kernels {
    /* out[i] for i in from to to, widened to whole vectors. row: padded by DVH_PADDING values. */
    void (*resample)(const float *row, const struct dvh_axis *axis, uint32_t from, uint32_t to, float *out);
    /* Bin of each value less `base`, at least 0; last + 1 for what is no number. */
    void (*keys)(const float *values, uint32_t n, int32_t base, int32_t last, int32_t *keys);
    /* Adds values; skips NaN. */
    void (*measure)(const float *values, uint32_t n, struct dvh_sums *sums);
};
const struct dvh_kernels *dvh_kernels_here(void);
extern const struct dvh_kernels dvh_kernels_portable, dvh_kernels_avx2; /* the second on x86-64 */

enum { DVH_KEY_SHIFT = 12 }; /* 23 bits of mantissa less 11 */
