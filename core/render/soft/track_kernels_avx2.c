/* The loops that draw tracks for processors with AVX2. */
#include "core/render/soft/tracks.h"

#if defined(__x86_64__)
#define LEAST(a, b) ((a) < (b) ? (a) : (b))
#define MOST(a, b) ((a) > (b) ? (a) : (b))
#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2")))
#include "core/render/soft/track_kernels.inc"

extern const struct soft_track_kernels soft_track_kernels_avx2;
const struct soft_track_kernels soft_track_kernels_avx2 = { project_avx2, find_farthest_avx2, raster_tracks_avx2 };
#endif
