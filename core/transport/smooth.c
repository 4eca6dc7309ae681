/* Smoothing along the three axes, of all lanes at once. */
#include "core/transport/smooth.h"

#include <string.h>

enum { LANES = PHASE_SPACE_LANES };

static void along_axis(const struct smooth_cells *cells, int axis, smooth_band *bands, smooth_lanes *from,
                       smooth_lanes *to)
{
    for (size_t i = 0; i < cells->n_held; i++) {
        const float *band = bands[i];
        float sum[LANES] = { 0 };
        for (ptrdiff_t k = 0; k < SMOOTH_WIDTH; k++) {
            if (band[k] == 0)
                continue;
            const float *at = from[(ptrdiff_t)cells->held[i] + (k - SMOOTH_BAND) * (ptrdiff_t)cells->step[axis]];
            for (int lane = 0; lane < LANES; lane++)
                sum[lane] += band[k] * at[lane];
        }
        memcpy(to[cells->held[i]], sum, sizeof sum);
    }
}

void smooth_field(const struct smooth_cells *cells, const struct smoothing *smoothing, smooth_lanes *values,
                  smooth_lanes *room)
{
    for (size_t i = 0; i < cells->n_held; i++) {
        float *at = values[cells->held[i]], inverse = 1 / cells->volume[cells->held[i]];
        for (int lane = 0; lane < LANES; lane++)
            at[lane] *= inverse;
    }
    along_axis(cells, 0, smoothing->bands[0], values, room);
    along_axis(cells, 1, smoothing->bands[1], room, values);
    along_axis(cells, 2, smoothing->bands[2], values, room);
    memcpy(values, room, cells->n_cells * sizeof *values);
}

void smooth_at(const struct smooth_cells *cells, smooth_lanes *values, const int32_t block[3],
               float at[PHASE_SPACE_LANES])
{
    size_t cell = 0;
    for (int axis = 0; axis < 3; axis++)
        cell += (size_t)(block[axis] / 2) * cells->step[axis];
    memcpy(at, values[cell], sizeof *values);
    for (int axis = 0; axis < 3; axis++) {
        int32_t i = block[axis] / 2;
        size_t low = cell - (i > 0 && cells->volume[cell - cells->step[axis]] > 0 ? cells->step[axis] : 0),
               high = cell +
                      (i + 1 < cells->n[axis] && cells->volume[cell + cells->step[axis]] > 0 ? cells->step[axis] : 0);
        if (low == high)
            continue;
        float by = (block[axis] % 2 ? .25F : -.25F) / (low == cell || high == cell ? 1 : 2);
        for (int lane = 0; lane < LANES; lane++)
            at[lane] += by * (values[high][lane] - values[low][lane]);
    }
}
