#pragma once
/* How strongly surface_smooth smooths. */

struct smooth_options {
    int n_steps;        /* order of the filters, 1..SMOOTH_MAX_STEPS: how many links far a vertex looks */
    double strong_band; /* frequency, 0 to 2, below which the strong filter keeps the shape, */
    double gentle_band; /* and the gentle one, which is taken where the strong one would pull the surface out of its
                           univels */
    double max_shift;   /* of a univel's edge, below 0.5 */
    int n_volume_steps; /* 0: the volume is left as it comes out */
};
enum { SMOOTH_MAX_STEPS = 128 };
extern const struct smooth_options smooth_defaults;
