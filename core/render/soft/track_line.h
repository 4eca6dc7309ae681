#pragma once
/* A line of a track from its two ends: the samples of a thin one, and what rows it reaches. The same for all
 * processors; has no branches, so that compilers vectorise it. */
#include "core/render/soft/tracks.h"

/* A line between two points in the picture: samples, depth -1 .. 1, level of the cue 0 .. 255. */
struct track_ends {
    float x[2], y[2], z[2], cue[2];
};

/* The samples of a thin line. */
struct track_chain {
    int32_t is_tall, is_turned; /* is_turned: its first sample is at its second end */
    int32_t first, n, at, step, low_row, high_row;
    float z, z_step, cue, cue_step;
};

/* All places are inside the picture. */
__attribute__((always_inline)) static inline void track_chain_make(float x0, float y0, float z0, float c0, float x1,
                                                                   float y1, float z1, float c1,
                                                                   struct track_chain *out)
{
    const int32_t is_tall = fabsf(y1 - y0) > fabsf(x1 - x0);
    const float a0 = is_tall ? y0 : x0, a1 = is_tall ? y1 : x1, b0 = is_tall ? x0 : y0, b1 = is_tall ? x1 : y1;
    const int32_t is_turned = a1 < a0;
    const float start = is_turned ? a1 : a0, end = is_turned ? a0 : a1, from = is_turned ? b1 : b0,
                to = is_turned ? b0 : b1, z_from = is_turned ? z1 : z0, z_to = is_turned ? z0 : z1,
                c_from = is_turned ? c1 : c0, c_to = is_turned ? c0 : c1;
    const float run = end - start, slope = (to - from) / (run > 1e-6f ? run : 1.0f);
    const int32_t first = (int32_t)start, last = (int32_t)end, steps = last - first;
    const float per_step = 1.0f / (float)(steps > 0 ? steps : 1);
    const float at = (from + slope * ((float)first + 0.5f - start)) * 65536.0f, step = slope * 65536.0f;
    out->is_tall = is_tall;
    out->is_turned = is_turned;
    out->first = first;
    out->n = steps + 1;
    out->at = (int32_t)at;
    out->step = (int32_t)(step + (step < 0 ? -0.5f : 0.5f));
    out->z_step = (z_to - z_from) * per_step;
    out->z = z_from;
    out->cue_step = (c_to - c_from) * per_step;
    out->cue = c_from;
    const int32_t row = out->at >> 16, other = (out->at + steps * out->step) >> 16;
    const int32_t low = row < other ? row : other, high = row < other ? other : row;
    out->low_row = is_tall ? first : low;
    out->high_row = is_tall ? last : high;
}

/* Where the dashes of a thin line are at its first sample, and from sample to sample. phase: at its first end. */
static inline void track_line_dash(struct soft_track_line *line, const struct track_chain *chain,
                                   const struct track_ends *ends, float periods, float phase)
{
    const float dx = ends->x[1] - ends->x[0], dy = ends->y[1] - ends->y[0], whole = sqrtf(dx * dx + dy * dy) * periods;
    const float per_step = chain->n > 1 ? whole / (float)(chain->n - 1) : 0;
    const float begin = phase + (chain->is_turned ? whole : 0), change = chain->is_turned ? -per_step : per_step;
    line->thin.phase = (uint16_t)(int32_t)((begin - floorf(begin)) * 65536.0f);
    line->thin.phase_step = (uint16_t)(int32_t)((change - floorf(change)) * 65536.0f);
}

static inline void track_line_thin(struct soft_track_line *line, const struct track_chain *chain)
{
    line->cue = (uint16_t)(int32_t)(chain->cue * 256.0f);
    line->thin.first = (int16_t)chain->first;
    line->thin.n = (int16_t)chain->n;
    line->thin.at = chain->at;
    line->thin.step = chain->step;
    line->thin.z = chain->z;
    line->thin.z_step = chain->z_step;
    line->thin.cue_step = chain->cue_step;
    line->thin.phase = line->thin.phase_step = 0;
}

static inline void track_line_wide(struct soft_track_line *line, const struct track_ends *ends, float phase)
{
    for (int i = 0; i < 2; i++) {
        line->cues[i] = (uint8_t)(int32_t)(ends->cue[i] + 0.5f);
        line->wide.x[i] = ends->x[i];
        line->wide.y[i] = ends->y[i];
        line->wide.z[i] = ends->z[i];
    }
    line->wide.phase = phase;
}

/* The bands of rows low .. high, as far as they are in the picture. False: none is. */
static inline bool track_reach(struct soft_track_reach *reach, int32_t low, int32_t high, int32_t height)
{
    low = low > 0 ? low : 0;
    high = high < height ? high : height - 1;
    reach->first_band = (uint16_t)(low / SOFT_BAND_ROWS);
    reach->last_band = (uint16_t)(high / SOFT_BAND_ROWS);
    return low <= high;
}

static inline bool track_reach_wide(struct soft_track_reach *reach, const struct soft_track_view *view,
                                    const struct track_ends *ends)
{
    const float low = ends->y[0] < ends->y[1] ? ends->y[0] : ends->y[1],
                high = ends->y[0] < ends->y[1] ? ends->y[1] : ends->y[0];
    /* 0.75 of the width: farther than a corner of the line's square end */
    return track_reach(reach, (int32_t)floorf(low - 0.75f * view->line_width),
                       (int32_t)floorf(high + 0.75f * view->line_width), view->height);
}
