#pragma once
/* Strength of the smoothing in surface_smooth. */

struct smooth_options {
    int n_steps;        /* order of the filters, 1..SMOOTH_MAX_STEPS: how many links away a vertex has influence */
    double strong_band; /* frequency, 0 to 2, below which the strong filter keeps the shape */
    double gentle_band; /* the same for the gentle filter, used where the strong one would pull the surface out of its
                           univels */
    double max_shift;   /* share of a univel's edge, below 0.5; across interpolated slices, the distance that is left to
                           the end of an edge is as short as that of the shortest edge */
    int n_volume_steps; /* volume correction steps; 0: the volume is left as it is */
    double slice_ratio; /* slices farther apart than this, relative to either other edge of a univel, are interpolated;
                           INFINITY: never */
};
enum { SMOOTH_MAX_STEPS = 128 };
extern const struct smooth_options smooth_defaults;
