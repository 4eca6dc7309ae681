#include "core/dose/gamma.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* The neighbourhood of a voxel is divided into cubes: first with sides of half the distance, parallel to the patient's
 * axes, the first one around the voxel; then each into eight, unless it cannot hold an index that is smaller by more
 * than the tolerance, down to sides of 1/16 of the distance. */
enum { MAX_THREADS = 64, MAX_DEPTH = 3, N_DESCENTS = 3 };
static const double first_half = 0.25, tolerance = 0.005, relative_tolerance = 0.01; /* half a side; in distances */

/* A cube, relative to the voxel, in units of distance_mm. */
struct cube {
    struct vec3 middle;
    double nearest; /* smallest distance of a point of it */
};

struct search {
    const struct volume *first, *second;
    const struct gamma_options *options;
    struct affine ijk_from_ijk;   /* index space of the first dose to that of the second */
    struct affine second_from_mm; /* linear part: a distance in patient mm to index space */
    double half[3];               /* see find_half */
    struct cube *cubes;           /* the first ones, by nearest */
    size_t n_cubes;
    float *changes; /* by voxel of the second dose: how much D2 may change from it within half a first cube */
    float *gammas;  /* by voxel of the first dose */
    float *copies[MAX_THREADS]; /* of values that are spread along an axis */
    int axis;
    struct gamma_facts facts[MAX_THREADS];
    double sums[MAX_THREADS];
};

/* Tri-linear, as volume_sample: NaN outside the outer faces and beside a voxel without a value. */
static double sample(const struct volume *volume, struct vec3 at_ijk)
{
    const uint32_t *size = volume->grid.size;
    const float *voxels = volume->voxels;
    const double at[3] = { at_ijk.x, at_ijk.y, at_ijk.z };
    size_t low[3], step[3];
    double weight[3];
    for (int axis = 0; axis < 3; axis++) {
        double last = size[axis] - 1.0;
        if (!(at[axis] >= -0.5 && at[axis] <= last + 0.5))
            return NAN;
        double inside = fmin(fmax(at[axis], 0), last);
        low[axis] = (size_t)inside;
        weight[axis] = inside - (double)low[axis];
        step[axis] = weight[axis] > 0;
    }
    size_t row = size[0], plane = row * size[1], first = low[0] + row * low[1] + plane * low[2];
    size_t j = row * step[1], k = plane * step[2], i = step[0];
    double values[4] = {
        (double)voxels[first] * (1 - weight[0]) + (double)voxels[first + i] * weight[0],
        (double)voxels[first + j] * (1 - weight[0]) + (double)voxels[first + j + i] * weight[0],
        (double)voxels[first + k] * (1 - weight[0]) + (double)voxels[first + k + i] * weight[0],
        (double)voxels[first + k + j] * (1 - weight[0]) + (double)voxels[first + k + j + i] * weight[0],
    };
    double near = values[0] * (1 - weight[1]) + values[1] * weight[1],
           far = values[2] * (1 - weight[1]) + values[3] * weight[1];
    return near * (1 - weight[2]) + far * weight[2];
}

/* Half the extent of a first cube along each index axis of the second dose. */
static void find_half(struct search *search)
{
    double side = search->options->distance_mm * first_half;
    for (int i = 0; i < 3; i++) {
        const struct vec3 *column = &search->second_from_mm.columns[i];
        search->half[0] += side * fabs(column->x);
        search->half[1] += side * fabs(column->y);
        search->half[2] += side * fabs(column->z);
    }
}

/* Changes between the corners of a cell that have values, by its lowest corner. */
static float cell_change(const struct search *search, const size_t at[3])
{
    const struct grid *grid = &search->second->grid;
    const float *voxels = search->second->voxels;
    const size_t strides[3] = { 1, grid->size[0], (size_t)grid->size[0] * grid->size[1] };
    size_t first = 0, next[3];
    for (int axis = 0; axis < 3; axis++) {
        first += at[axis] * strides[axis];
        next[axis] = at[axis] + 1 < grid->size[axis] ? strides[axis] : 0;
    }
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        size_t j = next[(axis + 1) % 3], k = next[(axis + 2) % 3];
        float most = 0;
        for (int corner = 0; corner < 4; corner++) {
            const float *from = voxels + first + (corner & 1 ? j : 0) + (corner & 2 ? k : 0);
            most = fmaxf(most, fabsf(from[next[axis]] - *from)); /* ignores NaN */
        }
        sum += (double)most * search->half[axis];
    }
    return (float)sum;
}

static void find_some_changes(void *context, int part, int n_parts)
{
    struct search *search = context;
    const uint32_t *size = search->second->grid.size;
    for (size_t k = (size_t)part; k < size[2]; k += (size_t)n_parts)
        for (size_t j = 0; j < size[1]; j++)
            for (size_t i = 0; i < size[0]; i++)
                search->changes[i + size[0] * (j + size[1] * k)] = cell_change(search, (size_t[]){ i, j, k });
}

/* Sets each value to the largest within `reach` voxels along an axis: rows of `width` values, n of them `stride`
 * apart. */
static void spread(float *values, size_t width, size_t n, size_t stride, size_t reach, float *copy)
{
    for (size_t row = 0; row < n; row++)
        memcpy(copy + row * width, values + row * stride, width * sizeof *values);
    for (size_t row = 0; row < n; row++) {
        float *most = values + row * stride;
        size_t to = row + reach + 1 < n ? row + reach + 1 : n;
        for (size_t other = row > reach ? row - reach : 0; other < to; other++)
            for (size_t i = 0; i < width; i++)
                most[i] = copy[other * width + i] > most[i] ? copy[other * width + i] : most[i];
    }
}

static void spread_some(void *context, int part, int n_parts)
{
    struct search *search = context;
    const uint32_t *size = search->second->grid.size;
    size_t row = size[0], plane = row * size[1], n_slabs = search->axis == 2 ? size[1] : size[2];
    /* the straight way from the middle of a cube to a point of it; the middle is rounded to a voxel */
    size_t reach = (size_t)ceil(search->half[search->axis]) + 1;
    for (size_t slab = (size_t)part; slab < n_slabs; slab += (size_t)n_parts) {
        float *values = search->changes + slab * (search->axis == 2 ? row : plane);
        if (search->axis > 0)
            spread(values, row, size[search->axis], search->axis == 1 ? row : plane, reach, search->copies[part]);
        else
            for (size_t j = 0; j < size[1]; j++)
                spread(values + j * row, 1, row, 1, reach, search->copies[part]);
    }
}

static bool find_changes(struct search *search, struct error *err)
{
    const uint32_t *size = search->second->grid.size;
    int n_parts = parallel_cores(), n_copies = 0;
    size_t longest = size[1] > size[2] ? size[1] : size[2];
    search->changes = mem_large_array(grid_n_voxels(&search->second->grid), sizeof(float), UINT64_MAX, err);
    bool is_good = search->changes;
    for (; is_good && n_copies < n_parts; n_copies++) {
        search->copies[n_copies] = mem_array(longest * size[0], sizeof(float), UINT64_MAX, err);
        is_good = search->copies[n_copies];
    }
    if (is_good)
        parallel_run(n_parts, find_some_changes, search);
    for (search->axis = 0; is_good && search->axis < 3; search->axis++)
        parallel_run(n_parts, spread_some, search);
    for (int part = 0; part < n_copies; part++)
        free(search->copies[part]);
    return is_good;
}

static int compare_cubes(const void *left, const void *right)
{
    const struct cube *a = left, *b = right;
    if (a->nearest != b->nearest)
        return a->nearest < b->nearest ? -1 : 1;
    return memcmp(&a->middle, &b->middle, sizeof a->middle); /* some order, always the same */
}

static struct cube cube_at(struct vec3 middle, double half)
{
    return (struct cube){ middle, vec3_length(vec3(fmax(fabs(middle.x) - half, 0), fmax(fabs(middle.y) - half, 0),
                                                   fmax(fabs(middle.z) - half, 0))) };
}

static bool list_cubes(struct search *search, struct error *err)
{
    double most = search->options->most, side = 2 * first_half;
    int reach = (int)ceil(most / side) + 1;
    size_t n = (size_t)(2 * reach + 1);
    search->cubes = mem_array(n * n * n, sizeof *search->cubes, UINT64_MAX, err);
    if (!search->cubes)
        return false;
    for (int k = -reach; k <= reach; k++)
        for (int j = -reach; j <= reach; j++)
            for (int i = -reach; i <= reach; i++) {
                struct cube cube = cube_at(vec3(i * side, j * side, k * side), first_half);
                if (cube.nearest < most)
                    search->cubes[search->n_cubes++] = cube;
            }
    qsort(search->cubes, search->n_cubes, sizeof *search->cubes, compare_cubes);
    return true;
}

/* Search for one voxel's gamma index: the voxel, the smallest index so far, and its place. */
struct point {
    struct vec3 at_ijk; /* in index space of the second dose */
    double value, per_difference;
    double best;
    struct vec3 best_away; /* in units of distance_mm */
};

/* (D2 - D1) / dD at a place relative to the voxel, in units of distance_mm. */
static double difference_at(const struct search *search, const struct point *point, struct vec3 away)
{
    struct vec3 away_ijk = affine_vector(&search->second_from_mm, vec3_scale(away, search->options->distance_mm));
    return (sample(search->second, vec3_add(point->at_ijk, away_ijk)) - point->value) * point->per_difference;
}

static bool note(struct point *point, double difference, struct vec3 away)
{
    double index = sqrt(difference * difference + vec3_dot(away, away));
    if (!(index < point->best)) /* also for NaN */
        return false;
    point->best = index;
    point->best_away = away;
    return true;
}

/* Descends from the best place: where D2 is c + g . q around it, the smallest of (c + g . q)^2 + q^2 is at q = -c g /
 * (1 + g^2). */
static void descend(const struct search *search, struct point *point)
{
    const double step = 1.0 / 32;
    for (int i = 0; i < N_DESCENTS; i++) {
        struct vec3 at = point->best_away;
        double here = difference_at(search, point, at);
        struct vec3 g = vec3((difference_at(search, point, vec3_add(at, vec3(step, 0, 0))) - here) / step,
                             (difference_at(search, point, vec3_add(at, vec3(0, step, 0))) - here) / step,
                             (difference_at(search, point, vec3_add(at, vec3(0, 0, step))) - here) / step);
        double before = point->best;
        struct vec3 to = vec3_scale(g, -(here - vec3_dot(g, at)) / (1 + vec3_dot(g, g)));
        if (!note(point, difference_at(search, point, to), to) || !(point->best < before - 1e-4))
            return;
    }
}

/* Tries the middle of a cube. Returns what no index in the cube is below; beside voxels without a value that is an
 * estimate. half: half the cube's side, as a part of first_half. */
static double try_cube(const struct search *search, struct point *point, const struct cube *cube, double half)
{
    const struct grid *grid = &search->second->grid;
    struct vec3 middle = vec3_add(point->at_ijk, affine_vector(&search->second_from_mm,
                                                               vec3_scale(cube->middle, search->options->distance_mm)));
    double value = sample(search->second, middle);
    if (isnan(value))
        return cube->nearest; /* the dose may begin within the cube */
    double difference = fabs(value - point->value) * point->per_difference;
    (void)note(point, difference, cube->middle);
    size_t i = (size_t)lround(fmin(fmax(middle.x, 0), grid->size[0] - 1.0)),
           j = (size_t)lround(fmin(fmax(middle.y, 0), grid->size[1] - 1.0)),
           k = (size_t)lround(fmin(fmax(middle.z, 0), grid->size[2] - 1.0));
    double change = (double)search->changes[i + grid->size[0] * (j + grid->size[1] * k)] * half * (1 + 1e-6),
           least = fmax(difference - change * point->per_difference, 0);
    return sqrt(least * least + cube->nearest * cube->nearest);
}

/* True if nothing in a cube is worth a look. */
static bool is_hopeless(const struct point *point, double least)
{
    return least >= point->best - fmax(tolerance, relative_tolerance * point->best);
}

static void divide(const struct search *search, struct point *point, const struct cube *cube, double half, int depth)
{
    struct cube parts[8];
    double leasts[8];
    int order[8];
    half /= 2;
    for (int i = 0; i < 8; i++) { /* sorted by what they can hold */
        double step = half * first_half;
        parts[i] =
            cube_at(vec3_add(cube->middle, vec3(i & 1 ? step : -step, i & 2 ? step : -step, i & 4 ? step : -step)),
                    step);
        leasts[i] = is_hopeless(point, parts[i].nearest) ? INFINITY : try_cube(search, point, &parts[i], half);
        int at = i;
        for (; at > 0 && leasts[order[at - 1]] > leasts[i]; at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
    for (int i = 0; i < 8 && depth < MAX_DEPTH && !is_hopeless(point, leasts[order[i]]); i++)
        divide(search, point, &parts[order[i]], half, depth + 1);
}

static double find_gamma(const struct search *search, struct point *point)
{
    point->best = INFINITY;
    (void)note(point, difference_at(search, point, vec3(0, 0, 0)), vec3(0, 0, 0));
    descend(search, point);
    point->best = fmin(point->best, search->options->most);
    double before = point->best;
    for (size_t c = 0; c < search->n_cubes && !is_hopeless(point, search->cubes[c].nearest); c++)
        if (!is_hopeless(point, try_cube(search, point, &search->cubes[c], 1)))
            divide(search, point, &search->cubes[c], 1, 1);
    if (point->best < before)
        descend(search, point);
    return point->best;
}

static void count(const struct search *search, struct gamma_facts *facts, double *sum, double gamma)
{
    facts->n++;
    facts->n_passed += gamma <= 1;
    facts->max = fmax(facts->max, gamma);
    *sum += gamma;
    double bin = ceil(gamma / search->options->most * GAMMA_BINS) - 1;
    facts->bins[bin > 0 ? (size_t)fmin(bin, GAMMA_BINS - 1) : 0]++;
}

static void search_some(void *context, int part, int n_parts)
{
    struct search *search = context;
    const struct gamma_options *options = search->options;
    const uint32_t *size = search->first->grid.size;
    size_t n_rows = (size_t)size[1] * size[2];
    for (size_t row = (size_t)part; row < n_rows; row += (size_t)n_parts)
        for (size_t i = 0; i < size[0]; i++) {
            size_t at = i + size[0] * row;
            double value = (double)((const float *)search->first->voxels)[at];
            search->gammas[at] = NAN;
            if (!isfinite(value))
                continue;
            if (value < options->threshold || (options->is_local && value <= 0)) {
                search->facts[part].n_below++;
                continue;
            }
            struct point point = {
                .at_ijk = affine_point(&search->ijk_from_ijk,
                                       vec3((double)i, (double)(row % size[1]), (double)(row / size[1]))),
                .value = value,
                .per_difference = 100 / (options->dose_percent * (options->is_local ? value : options->reference)),
            };
            if (isnan(sample(search->second, point.at_ijk))) {
                search->facts[part].n_without++;
                continue;
            }
            double gamma = find_gamma(search, &point);
            search->gammas[at] = (float)gamma;
            count(search, &search->facts[part], &search->sums[part], gamma);
        }
}

static void add_facts(const struct search *search, struct gamma_facts *facts)
{
    double sum = 0;
    memset(facts, 0, sizeof *facts);
    for (int part = 0; part < MAX_THREADS; part++) {
        const struct gamma_facts *some = &search->facts[part];
        facts->n += some->n;
        facts->n_passed += some->n_passed;
        facts->n_below += some->n_below;
        facts->n_without += some->n_without;
        facts->max = fmax(facts->max, some->max);
        sum += search->sums[part];
        for (size_t bin = 0; bin < GAMMA_BINS; bin++)
            facts->bins[bin] += some->bins[bin];
    }
    facts->mean = facts->n ? sum / (double)facts->n : 0;
}

struct volume *gamma_index(const struct volume *first, const struct volume *second, const struct gamma_options *options,
                           struct gamma_facts *facts, struct error *err)
{
    if (!(options->dose_percent > 0 && options->reference > 0 && options->distance_mm > 0 && options->most > 1)) {
        (void)error_set(err, ERROR_RANGE,
                        "a gamma index needs a dose difference, a distance and a reference greater than 0");
        return NULL;
    }
    struct search *search = mem_array(1, sizeof *search, UINT64_MAX, err);
    struct volume *gammas = search ? volume_create_unset(&first->grid, VOXEL_F32, err) : NULL;
    bool is_good = gammas;
    if (is_good) {
        search->first = first;
        search->second = second;
        search->options = options;
        search->ijk_from_ijk = affine_compose(&second->grid.ijk_from_lps_mm, &first->grid.lps_mm_from_ijk);
        search->second_from_mm = second->grid.ijk_from_lps_mm;
        search->gammas = gammas->voxels;
        find_half(search);
        is_good = list_cubes(search, err) && find_changes(search, err);
    }
    if (is_good) {
        parallel_run(parallel_cores(), search_some, search);
        add_facts(search, facts);
        volume_measure(gammas);
    } else if (gammas) {
        volume_unref(gammas);
        gammas = NULL;
    }
    if (search) {
        free(search->cubes);
        free(search->changes);
    }
    free(search);
    return gammas;
}
