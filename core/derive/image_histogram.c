/* Counts the values of an image in several threads, and finds percentiles in the counts. */
#include "core/derive/image_histogram.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

enum {
    N_LEVELS = IMAGE_HISTOGRAM_LEVELS,
    N_PARTS = 4096,
    N_PERCENTILES = IMAGE_HISTOGRAM_N_PERCENTILES,
    MAX_COUNTERS = 64
};
const double image_histogram_percents[N_PERCENTILES] = { 0.1, 1, 50, 99, 99.9 };
static const uint64_t per_mille[N_PERCENTILES] = { 1, 10, 500, 990, 999 };

struct counting {
    const struct volume *volume;
    double low, scale; /* of floats: level = (value - low) * scale */
    /* of floats, the second pass: the levels whose parts are counted */
    bool has_parts;
    size_t part_levels[N_PERCENTILES];
    size_t n_counters;                /* of a thread */
    uint64_t *counters[MAX_COUNTERS]; /* by thread; counters[0] gets the sums */
    uint64_t n_left_out[MAX_COUNTERS];
};

static double position_of(const struct counting *counting, double value)
{
    double at = (value - counting->low) * counting->scale;
    return at > 0 ? fmin(at, N_LEVELS - 0.5 / N_PARTS) : 0;
}

static void count_float(struct counting *counting, float raw, uint64_t *counters, uint64_t *n_left_out)
{
    const struct volume *volume = counting->volume;
    if (!isfinite(raw)) {
        ++*n_left_out;
        return;
    }
    double at = position_of(counting, (double)raw * volume->slope + volume->offset);
    size_t level = (size_t)at;
    if (!counting->has_parts) {
        counters[level]++;
        return;
    }
    for (int i = 0; i < N_PERCENTILES; i++)
        if (counting->part_levels[i] == level)
            counters[(size_t)i * N_PARTS + (size_t)((at - (double)level) * N_PARTS)]++;
}

static void count_some(void *context, int part, int n_parts)
{
    struct counting *counting = context;
    const struct volume *volume = counting->volume;
    size_t n = grid_n_voxels(&volume->grid), from = n / (size_t)n_parts * (size_t)part,
           to = part + 1 == n_parts ? n : n / (size_t)n_parts * (size_t)(part + 1);
    uint64_t *counters = counting->counters[part];
    for (size_t i = from; i < to; i++)
        switch (volume->type) {
        case VOXEL_U8: counters[((const uint8_t *)volume->voxels)[i]]++; break;
        case VOXEL_U16: counters[((const uint16_t *)volume->voxels)[i]]++; break;
        case VOXEL_I16: counters[((const int16_t *)volume->voxels)[i] + 32768]++; break;
        case VOXEL_F32:
            count_float(counting, ((const float *)volume->voxels)[i], counters, &counting->n_left_out[part]);
            break;
        }
}

/* Counts into counters[0]. */
static bool count(struct counting *counting, size_t n_counters, struct error *err)
{
    int n_threads = parallel_cores(), n_made = 0;
    for (; n_made < n_threads; n_made++) {
        counting->n_left_out[n_made] = 0;
        if (!(counting->counters[n_made] = mem_array(n_counters, sizeof **counting->counters, UINT64_MAX, err)))
            break;
    }
    bool is_good = n_made == n_threads;
    if (is_good)
        parallel_run(n_threads, count_some, counting);
    for (int i = 1; i < n_made; i++) {
        for (size_t c = 0; is_good && c < n_counters; c++)
            counting->counters[0][c] += counting->counters[i][c];
        counting->n_left_out[0] += counting->n_left_out[i];
        free(counting->counters[i]);
    }
    if (!is_good && n_made > 0)
        free(counting->counters[0]);
    return is_good;
}

/* How many values are at most a percentile's. */
static uint64_t rank_of(const struct image_histogram *histogram, int percentile)
{
    uint64_t n = histogram->n, rank = n / 1000 * per_mille[percentile];
    rank += (n % 1000 * per_mille[percentile] + 999) / 1000; /* rounded up */
    return rank < 1 ? 1 : rank;
}

/* The first of the counters up to which there are `rank` of them; *before: how many there are before it. */
static size_t find_rank(const uint64_t *counters, size_t n_counters, uint64_t rank, uint64_t *before)
{
    size_t at = 0;
    for (*before = 0; at + 1 < n_counters && *before + counters[at] < rank; at++)
        *before += counters[at];
    return at;
}

/* Counts again, by parts of the levels that hold the percentiles. */
static bool refine(struct image_histogram *histogram, struct counting *counting, struct error *err)
{
    uint64_t rank[N_PERCENTILES];
    for (int i = 0; i < N_PERCENTILES; i++) {
        uint64_t before;
        counting->part_levels[i] = find_rank(histogram->levels, N_LEVELS, rank_of(histogram, i), &before);
        rank[i] = rank_of(histogram, i) - before;
    }
    counting->has_parts = true;
    if (!count(counting, (size_t)N_PERCENTILES * N_PARTS, err))
        return false;
    for (int i = 0; i < N_PERCENTILES; i++) {
        uint64_t before;
        size_t part = find_rank(counting->counters[0] + (size_t)i * N_PARTS, N_PARTS, rank[i], &before);
        double at = (double)counting->part_levels[i] + ((double)part + 0.5) / N_PARTS;
        histogram->percentiles[i] = histogram->low + histogram->step * at;
    }
    free(counting->counters[0]);
    return true;
}

static bool fill_floats(struct image_histogram *histogram, const struct volume *volume, struct error *err)
{
    struct counting counting = { .volume = volume, .low = volume->low };
    histogram->step = (volume->high - volume->low) / N_LEVELS;
    histogram->first = volume->low + histogram->step / 2;
    counting.scale = histogram->step > 0 ? 1 / histogram->step : 0;
    if (!count(&counting, N_LEVELS, err))
        return false;
    histogram->n_left_out = counting.n_left_out[0];
    for (size_t i = 0; i < N_LEVELS; i++) {
        histogram->levels[i] = counting.counters[0][i];
        histogram->n += counting.counters[0][i];
    }
    free(counting.counters[0]);
    return histogram->n == 0 || refine(histogram, &counting, err);
}

/* Levels ascend with the value: of a falling scale they run backwards. */
static bool fill_integers(struct image_histogram *histogram, const struct volume *volume, struct error *err)
{
    struct counting counting = { .volume = volume };
    bool is_falling = volume->slope < 0;
    double zero = volume->type == VOXEL_I16 ? -32768 : 0;
    histogram->step = fabs(volume->slope);
    histogram->first = (is_falling ? zero + N_LEVELS - 1 : zero) * volume->slope + volume->offset;
    if (!count(&counting, N_LEVELS, err))
        return false;
    for (size_t i = 0; i < N_LEVELS; i++) {
        histogram->levels[i] = counting.counters[0][is_falling ? N_LEVELS - 1 - i : i];
        histogram->n += histogram->levels[i];
    }
    free(counting.counters[0]);
    for (int i = 0; i < N_PERCENTILES; i++) {
        uint64_t before;
        size_t level = find_rank(histogram->levels, N_LEVELS, rank_of(histogram, i), &before);
        histogram->percentiles[i] = histogram->first + histogram->step * (double)level;
    }
    return true;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    free(base);
}

static const struct derive_kind kind = { sizeof(struct derive_recipe), NULL, build, destroy };

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct volume *volume = derive_plan(derive)->images[base->subject.index].volume;
    struct image_histogram *histogram = mem_array(1, sizeof *histogram, UINT64_MAX, err);
    (void)way;
    if (!histogram)
        return NULL;
    derive_result_init(&histogram->base, &kind, sizeof *histogram);
    histogram->low = volume->low;
    histogram->high = volume->high;
    for (int i = 0; i < N_PERCENTILES; i++)
        histogram->percentiles[i] = NAN;
    bool is_good =
        volume->type == VOXEL_F32 ? fill_floats(histogram, volume, err) : fill_integers(histogram, volume, err);
    if (is_good)
        return &histogram->base;
    free(histogram);
    return NULL;
}

struct image_histogram *image_histogram_get(struct derive *derive, size_t index, struct error *err)
{
    const struct derive_recipe recipe = { &kind, { SUBJECT_IMAGE, index, 0 } };
    return (struct image_histogram *)derive_get(derive, &recipe, NULL, err);
}

void image_histogram_counts(const struct image_histogram *histogram, size_t n_bins, uint64_t *counts)
{
    double range = histogram->high - histogram->low;
    for (size_t i = 0; i < n_bins; i++)
        counts[i] = 0;
    for (size_t level = 0; level < N_LEVELS; level++) {
        if (histogram->levels[level] == 0)
            continue;
        double value = histogram->first + histogram->step * (double)level,
               at = range > 0 ? floor((value - histogram->low) / range * (double)n_bins) : 0;
        size_t bin = at > 0 ? (size_t)at : 0;
        counts[bin < n_bins ? bin : n_bins - 1] += histogram->levels[level];
    }
}
