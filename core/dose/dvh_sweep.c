/* Counts univels by dose: threads take slices of the labels in turn, find runs of equal label, read the dose along the
 * row and count. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/dose/dvh.h"
#include "core/dose/dvh_sampler.h"
#include "core/region/label_rows.h"

enum {
    N_OCTAVES = 40, /* below the dose's maximum; smaller values share one bin */
    N_KEYS = N_OCTAVES * DVH_OCTAVE_BINS,
    MAX_THREADS = 64,
    MAX_SLOTS = 64, /* labels counted in one pass: bounds its memory */
    NO_SLOT = 255
};
_Static_assert(DVH_OCTAVE_BINS == 1 << (23 - DVH_KEY_SHIFT), "a bin is a value of the upper bits");

/* Counts of one thread. */
struct counter {
    uint32_t *keys;                                        /* [n_slots][N_KEYS + 1]; the last: without a value */
    struct dvh_sums sums[MAX_SLOTS], part_sums[MAX_SLOTS]; /* of whole univels; of parts of univels */
    uint64_t n[MAX_SLOTS];                                 /* sum of the slot's keys */
    float *values, *scratch;
    int32_t *row_keys;
};

struct counting {
    const struct dvh_sweep *sweep;
    struct dvh_sampler sampler;
    const struct dvh_label *labels;
    size_t n_labels;
    uint8_t *slots; /* by label */
    int per_side[MAX_SLOTS];
    int32_t base; /* the first key */
    struct counter counters[MAX_THREADS];
    int n_counters;
    _Atomic uint32_t next_slice;
};

/* ---- one row ---------------------------------------------------------------------------------------------------- */

static uint16_t label_of(const struct volume *labels, size_t at)
{
    return labels->type == VOXEL_U8 ? ((const uint8_t *)labels->voxels)[at] : ((const uint16_t *)labels->voxels)[at];
}

/* Values of whole univels, or each of one of weight parts of a univel. */
static void count(const struct counting *counting, struct counter *counter, uint8_t slot, const float *values,
                  uint32_t n, bool is_part, uint32_t weight)
{
    uint32_t *keys = counter->keys + (size_t)slot * (N_KEYS + 1);
    counting->sampler.kernels->keys(values, n, counting->base, N_KEYS - 1, counter->row_keys);
    for (uint32_t i = 0; i < n; i++)
        keys[counter->row_keys[i]] += weight;
    counter->n[slot] += (uint64_t)n * weight;
    counting->sampler.kernels->measure(values, n, is_part ? &counter->part_sums[slot] : &counter->sums[slot]);
}

static bool is_border(const struct volume *labels, const uint32_t ijk[3])
{
    const size_t strides[3] = { 1, labels->grid.size[0], (size_t)labels->grid.size[0] * labels->grid.size[1] };
    size_t at = ijk[0] + ijk[1] * strides[1] + ijk[2] * strides[2];
    uint16_t label = label_of(labels, at);
    for (int axis = 0; axis < 3; axis++)
        if (ijk[axis] == 0 || ijk[axis] + 1 == labels->grid.size[axis] ||
            label_of(labels, at - strides[axis]) != label || label_of(labels, at + strides[axis]) != label)
            return true;
    return false;
}

/* per_side^3 points of one univel. */
static void count_points(const struct counting *counting, struct counter *counter, uint8_t slot, const float *dose,
                         const uint32_t ijk[3])
{
    int n = counting->per_side[slot];
    float values[DVH_MAX_PER_SIDE * DVH_MAX_PER_SIDE * DVH_MAX_PER_SIDE];
    uint32_t n_values = 0;
    for (int z = 0; z < n; z++)
        for (int y = 0; y < n; y++)
            for (int x = 0; x < n; x++) {
                struct vec3 point =
                    vec3(ijk[0] + (x + 0.5) / n - 0.5, ijk[1] + (y + 0.5) / n - 0.5, ijk[2] + (z + 0.5) / n - 0.5);
                values[n_values++] = dose ? dvh_sampler_point(&counting->sampler, dose, point) : NAN;
            }
    count(counting, counter, slot, values, n_values, true, 1);
}

/* Univels from to to - 1 of a row: of one label, and in one dose (NULL: none). */
static void count_run(const struct counting *counting, struct counter *counter, uint8_t slot, const float *dose,
                      uint32_t from, uint32_t to, uint32_t j, uint32_t k)
{
    uint32_t n = (uint32_t)counting->per_side[slot], weight = n * n * n;
    if (dose)
        dvh_sampler_row(&counting->sampler, dose, j, k, from, to, counter->scratch, counter->values);
    else
        for (uint32_t i = from; i < to; i++)
            counter->values[i] = NAN;
    if (n == 1) {
        count(counting, counter, slot, counter->values + from, to - from, false, 1);
        return;
    }
    for (uint32_t i = from, inner; i < to; i = inner + 1) {
        for (inner = i; inner < to && !is_border(counting->sweep->labels, (const uint32_t[3]){ inner, j, k }); inner++)
            ;
        if (inner > i)
            count(counting, counter, slot, counter->values + i, inner - i, false, weight);
        if (inner < to)
            count_points(counting, counter, slot, dose, (const uint32_t[3]){ inner, j, k });
    }
}

static const float *row_values(const struct dvh_sweep *sweep, uint8_t row)
{
    return row < sweep->n_rows ? sweep->rows[row]->voxels : NULL;
}

static void count_row(const struct counting *counting, struct counter *counter, uint32_t j, uint32_t k)
{
    const struct dvh_sweep *sweep = counting->sweep;
    const struct volume *labels = sweep->labels;
    uint32_t n = labels->grid.size[0];
    size_t start = ((size_t)k * labels->grid.size[1] + j) * n;
    const void *row = (const char *)labels->voxels + start * voxel_size(labels->type);
    const uint8_t *row_of = sweep->row_of ? (const uint8_t *)sweep->row_of->voxels + start : NULL;
    for (uint32_t from = 0, to; from < n; from = to) {
        uint8_t slot = counting->slots[label_of(labels, start + from)];
        to = label_row_end(labels->type, row, from, n);
        for (uint32_t part = from, end; slot != NO_SLOT && part < to; part = end) {
            end = row_of ? label_row_end(VOXEL_U8, row_of, part, to) : to;
            count_run(counting, counter, slot, row_values(sweep, row_of ? row_of[part] : 0), part, end, j, k);
        }
    }
}

static void count_slices(void *context, int part, int n_parts)
{
    struct counting *counting = context;
    const uint32_t *size = counting->sweep->labels->grid.size;
    (void)n_parts;
    for (uint32_t k; (k = atomic_fetch_add(&counting->next_slice, 1)) < size[2];)
        for (uint32_t j = 0; j < size[1]; j++)
            count_row(counting, &counting->counters[part], j, k);
}

/* ---- begin and end ---------------------------------------------------------------------------------------------- */

static bool counter_init(const struct counting *counting, struct counter *counter, struct error *err)
{
    size_t n = counting->sweep->labels->grid.size[0];
    size_t n_keys = n > 125 ? n : 125;
    if (!(counter->keys = mem_array(counting->n_labels * (N_KEYS + 1), sizeof *counter->keys, UINT64_MAX, err)) ||
        !(counter->values = mem_array(n + DVH_PADDING, sizeof *counter->values, UINT64_MAX, err)) ||
        !(counter->row_keys = mem_array(n_keys + DVH_PADDING, sizeof *counter->row_keys, UINT64_MAX, err)))
        return false;
    for (size_t slot = 0; slot < counting->n_labels; slot++)
        for (int lane = 0; lane < DVH_LANES; lane++) {
            struct dvh_sums *both[2] = { &counter->sums[slot], &counter->part_sums[slot] };
            for (int which = 0; which < 2; which++) {
                both[which]->low[lane] = INFINITY;
                both[which]->high[lane] = -INFINITY;
            }
        }
    return (counter->scratch =
                mem_array(dvh_sampler_scratch(&counting->sampler), sizeof *counter->scratch, UINT64_MAX, err)) != NULL;
}

static void counter_finish(struct counter *counter)
{
    free(counter->keys);
    free(counter->values);
    free(counter->row_keys);
    free(counter->scratch);
}

/* Adds a counter's sum, and widens the range. */
static void add_sums(const struct dvh_sums *sums, double scale, struct dvh *dvh, float range[2])
{
    for (int lane = 0; lane < DVH_LANES; lane++) {
        dvh->sum += sums->parts[lane] * scale;
        range[0] = fminf(range[0], sums->low[lane]);
        range[1] = fmaxf(range[1], sums->high[lane]);
    }
}

/* The counters' sum of one label. */
static bool take(const struct counting *counting, size_t slot, struct dvh *dvh, struct error *err)
{
    double per_univel = pow(counting->per_side[slot], 3);
    float range[2] = { INFINITY, -INFINITY };
    for (int c = 0; c < counting->n_counters; c++) {
        const struct counter *counter = &counting->counters[c];
        if (counter->n[slot] > UINT32_MAX)
            return error_set(err, ERROR_LIMIT, "more than %u samples of label %u", UINT32_MAX,
                             (unsigned)counting->labels[slot].label);
        dvh->n_missing += counter->keys[slot * (N_KEYS + 1) + N_KEYS] / per_univel;
        add_sums(&counter->sums[slot], 1, dvh, range);
        add_sums(&counter->part_sums[slot], 1 / per_univel, dvh, range);
    }
    dvh->univel_cm3 = grid_voxel_mm3(&counting->sweep->labels->grid) / 1e3;
    if (!(range[0] <= range[1]))
        return true;
    int32_t ends[2];
    counting->sampler.kernels->keys(range, 2, counting->base, N_KEYS - 1, ends);
    dvh->low = (double)range[0];
    dvh->high = (double)range[1];
    dvh->first = (uint32_t)(counting->base + ends[0]);
    dvh->n_bins = (uint32_t)(ends[1] - ends[0]) + 1;
    dvh->bins = mem_array(dvh->n_bins, sizeof *dvh->bins, UINT64_MAX, err);
    if (!dvh->bins)
        return false;
    for (int c = 0; c < counting->n_counters; c++) {
        const uint32_t *keys = counting->counters[c].keys + slot * (N_KEYS + 1) + (size_t)ends[0];
        for (uint32_t i = 0; i < dvh->n_bins; i++)
            dvh->bins[i] += keys[i];
    }
    for (uint32_t i = 0; i < dvh->n_bins; i++)
        dvh->n += dvh->bins[i] /= per_univel;
    return true;
}

static double highest_of(const struct dvh_sweep *sweep)
{
    double highest = 0;
    for (size_t row = 0; row < sweep->n_rows; row++) {
        const struct volume *volume = sweep->rows[row];
        if (volume->high > volume->low) {
            highest = fmax(highest, volume->high);
            continue;
        }
        size_t n = grid_n_voxels(&volume->grid);
        for (size_t i = 0; i < n; i++)
            highest = fmax(highest, (double)((const float *)volume->voxels)[i]);
    }
    return highest;
}

/* One pass for up to MAX_SLOTS labels. */
static bool sweep_some(struct counting *counting, struct dvh *dvhs, struct error *err)
{
    int n_threads = counting->sweep->n_threads > 0 ? counting->sweep->n_threads : parallel_cores();
    uint32_t n_slices = counting->sweep->labels->grid.size[2];
    n_threads = n_threads > MAX_THREADS ? MAX_THREADS : n_threads;
    n_threads = (uint32_t)n_threads > n_slices ? (int)n_slices : n_threads;
    memset(counting->slots, NO_SLOT, 65536);
    for (size_t i = 0; i < counting->n_labels; i++)
        counting->slots[counting->labels[i].label] = (uint8_t)i;
    memset(counting->counters, 0, sizeof counting->counters);
    bool is_good = true;
    for (counting->n_counters = 0; is_good && counting->n_counters < n_threads; counting->n_counters++)
        is_good = counter_init(counting, &counting->counters[counting->n_counters], err);
    if (is_good) {
        atomic_store(&counting->next_slice, 0);
        parallel_run(n_threads, count_slices, counting);
    }
    for (size_t i = 0; is_good && i < counting->n_labels; i++)
        is_good = take(counting, i, &dvhs[i], err);
    for (int c = 0; c < counting->n_counters; c++)
        counter_finish(&counting->counters[c]);
    return is_good;
}

static bool check(const struct dvh_sweep *sweep, struct error *err)
{
    const struct volume *labels = sweep->labels;
    if (labels->type != VOXEL_U8 && labels->type != VOXEL_U16)
        return error_set(err, ERROR_RANGE, "labels must be of 8 or 16 bits without sign");
    if (grid_n_voxels(&labels->grid) >= UINT32_MAX)
        return error_set(err, ERROR_LIMIT, "more than %u labels", UINT32_MAX - 1);
    for (size_t row = 0; row < sweep->n_rows; row++) {
        const struct volume *volume = sweep->rows[row];
        if (volume->type != VOXEL_F32 || volume->slope != 1 || volume->offset != 0 ||
            !grid_is_same(&volume->grid, &sweep->rows[0]->grid))
            return error_set(err, ERROR_RANGE, "doses must be unscaled floats on one grid");
    }
    if (sweep->n_rows == 0)
        return error_set(err, ERROR_RANGE, "there is no dose");
    if (sweep->row_of && (sweep->row_of->type != VOXEL_U8 ||
                          memcmp(sweep->row_of->grid.size, labels->grid.size, sizeof labels->grid.size) != 0))
        return error_set(err, ERROR_RANGE, "tissues must be bytes on the labels' grid");
    return true;
}

bool dvh_sweep(const struct dvh_sweep *sweep, const struct dvh_label *labels, size_t n, struct dvh *dvhs,
               struct error *err)
{
    memset(dvhs, 0, n * sizeof *dvhs);
    if (!check(sweep, err))
        return false;
    struct counting *counting = mem_new(sizeof *counting);
    counting->sweep = sweep;
    counting->slots = mem_new(65536);
    float highest = (float)highest_of(sweep);
    memcpy(&counting->base, &highest, sizeof highest);
    counting->base = (counting->base >> DVH_KEY_SHIFT) + 2 - N_KEYS; /* rounding may pass the highest by one bin */
    counting->base = counting->base > 0 ? counting->base : 0;
    bool is_good =
        dvh_sampler_init(&counting->sampler, &sweep->labels->grid, &sweep->rows[0]->grid, sweep->is_general, err);
    for (size_t from = 0; is_good && from < n; from += counting->n_labels) {
        counting->labels = labels + from;
        counting->n_labels = n - from < MAX_SLOTS ? n - from : MAX_SLOTS;
        for (size_t i = 0; i < counting->n_labels; i++) {
            int per_side = labels[from + i].per_side;
            if (per_side < 1 || per_side > DVH_MAX_PER_SIDE)
                is_good = error_set(err, ERROR_RANGE, "1 to %d points a side of a univel", DVH_MAX_PER_SIDE);
            counting->per_side[i] = per_side;
        }
        is_good = is_good && sweep_some(counting, dvhs + from, err);
    }
    dvh_sampler_finish(&counting->sampler);
    free(counting->slots);
    free(counting);
    for (size_t i = 0; !is_good && i < n; i++)
        dvh_finish(&dvhs[i]);
    return is_good;
}
