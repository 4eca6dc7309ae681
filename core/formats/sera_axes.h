#pragma once
/* SERA's patient axes: RL grows to the left, PA to the anterior, IS to the superior side. Here alone they become
 * patient LPS. */
#include "core/report/report.h"
#include "core/volume/volume.h"

enum sera_axis { SERA_RL, SERA_PA, SERA_IS };

struct sera_direction {
    enum sera_axis axis;
    int sign; /* +1 or -1: whether the index grows with the axis */
};

/* "PA-" and its like, letters of either case. */
bool sera_direction_from_word(const char *word, struct sera_direction *direction);
struct vec3 sera_lps_from_rpi(double rl, double pa, double is);

/* What a header of SERA's says of a grid: along[0] columns (fastest), [1] rows, [2] slices. */
struct sera_grid {
    uint32_t size[3];
    double step[3]; /* size of a univel along them, in the header's unit */
    struct sera_direction along[3];
    double low[3], high[3]; /* [RL, PA, IS] outer faces, in the header's unit */
    double mm;              /* of one unit, as the header says */
    double given_mm;        /* as somebody who knows better says; 0: nobody does */
};

/* Index 0 lies half a step inside the low face of its axis, or the high face where the index runs against it.
 * A head of metres means that the unit is wrong: millimetres are then taken, and reported. A given unit is taken as it
 * is. errors  ERROR_FORMAT an axis twice; as grid_init */
NODISCARD bool sera_grid_resolve(const struct sera_grid *sera, const char *name, struct grid *grid,
                                 struct report *report, struct error *err);
