/* Reads a dose along rows of univels: where the grids are parallel, four rows of dose voxels are mixed into one, which
 * is then read along by precomputed positions. */
#include "core/dose/dvh_sampler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* Nearer than this to a voxel's centre, or to the outer face, counts as on it. In dose voxels. */
#define NEAR_VOXEL 1e-5

/* False outside of the n voxels. */
static inline bool place(double c, uint32_t n, uint32_t *at, float *between)
{
    if (!(c >= -0.5 - NEAR_VOXEL && c < n - 0.5 + NEAR_VOXEL))
        return false;
    double last = n - 1.0, inside = c < 0 ? 0 : c > last ? last : c;
    *at = (uint32_t)(inside + NEAR_VOXEL);
    double rest = inside - *at;
    *between = rest < NEAR_VOXEL ? 0 : (float)rest;
    return true;
}

static double column(const struct vec3 *v, int axis)
{
    return axis == 0 ? v->x : axis == 1 ? v->y : v->z;
}

/* Whether each label axis moves along one dose axis only, over the whole label grid. */
static bool find_axes(struct dvh_sampler *sampler)
{
    bool is_taken[3] = { false };
    for (int a = 0; a < 3; a++) {
        const struct vec3 *step = &sampler->dose_from_label.columns[a];
        int most = 0;
        for (int d = 1; d < 3; d++)
            if (fabs(column(step, d)) > fabs(column(step, most)))
                most = d;
        for (int d = 0; d < 3; d++)
            if (d != most && fabs(column(step, d)) * sampler->labels->size[a] > NEAR_VOXEL / 4)
                return false;
        if (is_taken[most])
            return false;
        is_taken[most] = true;
        sampler->dose_axis[a] = most;
    }
    return true;
}

static bool fill_axis(struct dvh_sampler *sampler, int a, struct error *err)
{
    struct dvh_axis *axis = &sampler->along[a];
    int d = sampler->dose_axis[a];
    uint32_t n = sampler->labels->size[a], n_dose = sampler->dose->size[d], n_padded = n + DVH_PADDING;
    double step = column(&sampler->dose_from_label.columns[a], d), origin = column(&sampler->dose_from_label.origin, d);
    axis->n = n;
    axis->at = mem_array(n_padded, sizeof *axis->at, UINT64_MAX, err);
    axis->between = axis->at ? mem_array(n_padded, sizeof *axis->between, UINT64_MAX, err) : NULL;
    if (!axis->between)
        return false;
    for (uint32_t i = 0; i < n_padded; i++) {
        double c = origin + step * (i < n ? i : n - 1);
        uint32_t at;
        if (!place(c, n_dose, &at, &axis->between[i])) {
            at = c < 0 ? 0 : n_dose - 1;
            axis->between[i] = NAN;
        }
        axis->at[i] = (int32_t)at;
        if (i >= n)
            axis->between[i] = NAN;
    }
    axis->is_dense = true;
    for (uint32_t i = 0; i < n; i += DVH_LANES)
        axis->is_dense = axis->is_dense && abs(axis->at[i] - axis->at[i + DVH_LANES - 1]) < DVH_LANES;
    return true;
}

bool dvh_sampler_init(struct dvh_sampler *sampler, const struct grid *labels, const struct grid *dose, bool is_general,
                      struct error *err)
{
    *sampler = (struct dvh_sampler){ .labels = labels, .dose = dose, .kernels = dvh_kernels_here() };
    sampler->strides[0] = 1;
    sampler->strides[1] = dose->size[0];
    sampler->strides[2] = (size_t)dose->size[0] * dose->size[1];
    sampler->dose_from_label = affine_compose(&dose->ijk_from_lps_mm, &labels->lps_mm_from_ijk);
    sampler->is_parallel = !is_general && find_axes(sampler);
    if (!sampler->is_parallel)
        return true;
    for (int a = 0; a < 3; a++)
        if (!fill_axis(sampler, a, err)) {
            dvh_sampler_finish(sampler);
            return false;
        }
    const struct dvh_axis *x = &sampler->along[0];
    int32_t first = x->at[0], last = x->at[x->n - 1], n_dose = (int32_t)dose->size[sampler->dose_axis[0]];
    sampler->low = (uint32_t)(first < last ? first : last);
    int32_t high = (first < last ? last : first) + 1;
    sampler->high = (uint32_t)(high < n_dose ? high : n_dose - 1);
    return true;
}

void dvh_sampler_finish(struct dvh_sampler *sampler)
{
    for (int a = 0; a < 3; a++) {
        free(sampler->along[a].at);
        free(sampler->along[a].between);
        sampler->along[a] = (struct dvh_axis){ 0 };
    }
}

size_t dvh_sampler_scratch(const struct dvh_sampler *sampler)
{
    return (sampler->is_parallel ? sampler->dose->size[sampler->dose_axis[0]] : 0) + (size_t)DVH_PADDING;
}

/* ---- parallel grids --------------------------------------------------------------------------------------------- */

/* line = low + t (high - low), n values that are stride apart; a neighbour of no weight is not looked at. */
static void mix(const float *low, const float *high, float t, size_t stride, size_t n, float *line)
{
    if (t == 0) {
        for (size_t i = 0; i < n; i++)
            line[i] = low[i * stride];
    } else if (stride == 1) {
        for (size_t i = 0; i < n; i++)
            line[i] = low[i] + t * (high[i] - low[i]);
    } else {
        for (size_t i = 0; i < n; i++)
            line[i] = low[i * stride] + t * (high[i * stride] - low[i * stride]);
    }
}

static void fill(float *out, uint32_t from, uint32_t to, float value)
{
    for (uint32_t i = from; i < to; i++)
        out[i] = value;
}

enum { PIECE = 256 }; /* dose voxels mixed at a time; keeps the second line on the stack */

static void parallel_row(const struct dvh_sampler *sampler, const float *dose, uint32_t j, uint32_t k, uint32_t from,
                         uint32_t to, float *scratch, float *out)
{
    const struct dvh_axis *y = &sampler->along[1], *z = &sampler->along[2];
    if (isnan(y->between[j]) || isnan(z->between[k])) {
        fill(out, from, to, NAN);
        return;
    }
    size_t x_stride = sampler->strides[sampler->dose_axis[0]], y_stride = sampler->strides[sampler->dose_axis[1]],
           z_stride = sampler->strides[sampler->dose_axis[2]];
    const float *base = dose + (size_t)y->at[j] * y_stride + (size_t)z->at[k] * z_stride;
    float ty = y->between[j], tz = z->between[k], upper[PIECE];
    int32_t ends[2] = { sampler->along[0].at[from], sampler->along[0].at[to - 1] };
    uint32_t low = (uint32_t)(ends[0] < ends[1] ? ends[0] : ends[1]),
             high = (uint32_t)(ends[0] < ends[1] ? ends[1] : ends[0]) + 1;
    high = high < sampler->high ? high : sampler->high;
    for (size_t at = low; at <= high; at += PIECE) {
        size_t n = high + 1 - at < PIECE ? high + 1 - at : PIECE;
        const float *line = base + at * x_stride;
        mix(line, line + y_stride, ty, x_stride, n, scratch + at);
        if (tz == 0)
            continue;
        mix(line + z_stride, line + z_stride + y_stride, ty, x_stride, n, upper);
        mix(scratch + at, upper, tz, 1, n, scratch + at);
    }
    sampler->kernels->resample(scratch, &sampler->along[0], from, to, out);
}

/* ---- any grids -------------------------------------------------------------------------------------------------- */

static inline float lerp(float low, float high, float t)
{
    return low + t * (high - low);
}

static inline float value_at(const struct dvh_sampler *sampler, const float *dose, double x, double y, double z)
{
    const uint32_t *size = sampler->dose->size;
    uint32_t at[3];
    float t[3];
    if (!place(x, size[0], &at[0], &t[0]) || !place(y, size[1], &at[1], &t[1]) || !place(z, size[2], &at[2], &t[2]))
        return NAN;
    const float *corner = dose + at[0] + at[1] * sampler->strides[1] + at[2] * sampler->strides[2];
    /* a neighbour of no weight is the voxel itself */
    size_t dx = t[0] > 0, dy = t[1] > 0 ? sampler->strides[1] : 0, dz = t[2] > 0 ? sampler->strides[2] : 0;
    float lower = lerp(lerp(corner[0], corner[dx], t[0]), lerp(corner[dy], corner[dy + dx], t[0]), t[1]);
    corner += dz;
    float upper = lerp(lerp(corner[0], corner[dx], t[0]), lerp(corner[dy], corner[dy + dx], t[0]), t[1]);
    return lerp(lower, upper, t[2]);
}

float dvh_sampler_point(const struct dvh_sampler *sampler, const float *dose, struct vec3 ijk)
{
    struct vec3 c = affine_point(&sampler->dose_from_label, ijk);
    return value_at(sampler, dose, c.x, c.y, c.z);
}

static void general_row(const struct dvh_sampler *sampler, const float *dose, uint32_t j, uint32_t k, uint32_t from,
                        uint32_t to, float *out)
{
    struct vec3 start = affine_point(&sampler->dose_from_label, vec3(0, j, k)),
                step = sampler->dose_from_label.columns[0];
    for (uint32_t i = from; i < to; i++)
        out[i] = value_at(sampler, dose, start.x + i * step.x, start.y + i * step.y, start.z + i * step.z);
}

void dvh_sampler_row(const struct dvh_sampler *sampler, const float *dose, uint32_t j, uint32_t k, uint32_t from,
                     uint32_t to, float *scratch, float *out)
{
    if (sampler->is_parallel)
        parallel_row(sampler, dose, j, k, from, to, scratch, out);
    else
        general_row(sampler, dose, j, k, from, to, out);
}
