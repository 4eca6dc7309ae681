#pragma once
/* Turns SERA's patient axes into patient LPS, here alone. RL grows to the left, PA to the anterior, IS to the superior
 * side: L = RL, P = -PA, S = IS. */
#include "core/report/report.h"
#include "core/volume/volume.h"

enum sera_axis { SERA_RL, SERA_PA, SERA_IS };

struct sera_direction {
    enum sera_axis axis;
    int sign; /* +1: the index grows along the axis; -1: against it */
};

/* Reads a word such as "PA-", in any case. */
bool sera_direction_from_word(const char *word, struct sera_direction *direction);
struct vec3 sera_lps_from_rpi(double rl, double pa, double is);

/* A grid as a SERA header gives it: along[0] columns (fastest), [1] rows, [2] slices. */
struct sera_grid {
    uint32_t size[3];
    double step[3]; /* size of a voxel along columns, rows and slices, in the header's unit */
    struct sera_direction along[3];
    double low[3], high[3]; /* [RL, PA, IS] outer faces, in the header's unit */
    double mm;              /* length of one unit, as the header says */
    double given_mm;        /* length of one unit as the plan gives it, instead; 0: not given */
};

/* Makes the grid. Index 0 lies half a step inside the low face of its axis, or inside the high face when the index runs
 * against the axis. A patient metres wide means a wrong unit: millimetres are then taken, and reported; a given unit is
 * taken as it is. errors  ERROR_FORMAT an axis twice; as grid_init */
NODISCARD bool sera_grid_resolve(const struct sera_grid *sera, const char *name, struct grid *grid,
                                 struct report *report, struct error *err);
