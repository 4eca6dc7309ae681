/* The loops that draw tracks for any processor, and the choice between them and those for newer ones. */
#include "core/render/soft/tracks.h"

#define LEAST(a, b) ((a) < (b) ? (a) : (b))
#define MOST(a, b) ((a) > (b) ? (a) : (b))
#define NAME(x) x##_portable
#define TARGET
#include "core/render/soft/track_kernels.inc"

const struct soft_track_kernels soft_track_kernels_portable = { project_portable, find_farthest_portable,
                                                                raster_tracks_portable };

#if defined(__x86_64__)
extern const struct soft_track_kernels soft_track_kernels_avx2;
const struct soft_track_kernels *soft_track_kernels_of(const struct soft_kernels *kernels)
{
    return kernels == &soft_kernels_portable ? &soft_track_kernels_portable : &soft_track_kernels_avx2;
}
#else
const struct soft_track_kernels *soft_track_kernels_of(const struct soft_kernels *kernels)
{
    (void)kernels;
    return &soft_track_kernels_portable;
}
#endif
