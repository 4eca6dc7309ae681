/* Computes isoeffective doses of a region's univels at any output of the source. */
#include "core/derive/dose_growth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/dose_histogram.h"
#include "core/derive/isoeffective_rows.h"
#include "dose_presets.h" /* generated from proto/dose_presets.json */

struct dose_growth {
    const struct isoeffective_set *set;
    double unit_gy;
    size_t n;                /* univels */
    float (*gy)[4];          /* [n] boron, nitrogen, fast, gamma per one unit of output; NaN: no value */
    struct volume *labels;   /* 1 at the first n voxels of a cube: a place for each univel */
    struct volume *values;   /* the doses there */
    struct isoeffective now; /* of the output that is computed */
    double output;
};

/* ---- sampling --------------------------------------------------------------------------------------------------- */

struct sampling {
    const struct isoeffective_rows *rows;
    const struct volume *labels; /* 1: counts */
    size_t *first;               /* [slices + 1] univels before each slice */
    float (*gy)[4];
};

static void count_slices(const struct volume *labels, size_t *first)
{
    const uint8_t *label = labels->voxels;
    const size_t n_slice = (size_t)labels->grid.size[0] * labels->grid.size[1];
    for (uint32_t k = 0; k < labels->grid.size[2]; k++) {
        size_t n = 0;
        for (size_t i = 0; i < n_slice; i++)
            n += *label++ != 0;
        first[k + 1] = first[k] + n;
    }
}

static void sample_some(void *context, int part, int n_parts)
{
    const struct sampling *sampling = context;
    const struct grid *grid = &sampling->labels->grid;
    const uint8_t *label = sampling->labels->voxels;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts) {
        size_t to = sampling->first[k];
        for (uint32_t j = 0; sampling->first[k + 1] > sampling->first[k] && j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                if (!label[i + (size_t)grid->size[0] * (j + (size_t)grid->size[1] * k)])
                    continue;
                double gy[4] = { NAN, NAN, NAN, NAN };
                (void)isoeffective_rows_components(sampling->rows, 0,
                                                   affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)), gy);
                for (int c = 0; c < 4; c++)
                    sampling->gy[to][c] = (float)gy[c];
                to++;
            }
    }
}

/* A cube of voxels as large as a univel, with a place for each. */
static bool make_places(struct dose_growth *growth, double univel_mm3, struct error *err)
{
    struct grid grid;
    const double step_mm = cbrt(univel_mm3);
    const struct affine map = { { vec3(step_mm, 0, 0), vec3(0, step_mm, 0), vec3(0, 0, step_mm) }, vec3(0, 0, 0) };
    uint32_t side = 1;
    while ((size_t)side * side * side < growth->n)
        side++;
    if (!grid_init(&grid, (uint32_t[3]){ side, side, side }, &map, err))
        return false;
    growth->labels = volume_create(&grid, VOXEL_U8, err);
    growth->values = growth->labels ? volume_create(&grid, VOXEL_F32, err) : NULL;
    if (growth->values)
        memset(growth->labels->voxels, 1, growth->n);
    return growth->values != NULL;
}

static bool sample(struct dose_growth *growth, const struct isoeffective_rows *rows, const struct volume *labels,
                   struct error *err)
{
    struct sampling sampling = { .rows = rows, .labels = labels };
    const uint32_t n_slices = labels->grid.size[2];
    sampling.first = mem_array((size_t)n_slices + 1, sizeof *sampling.first, UINT64_MAX, err);
    if (!sampling.first)
        return false;
    count_slices(labels, sampling.first);
    growth->n = sampling.first[n_slices];
    bool is_good =
        growth->n <= DOSE_GROWTH_MAX_UNIVELS ||
        error_set(err, ERROR_LIMIT, "more than %d million univels: no time is computed for an isoeffective dose",
                  DOSE_GROWTH_MAX_UNIVELS >> 20);
    if (is_good)
        growth->gy = mem_large_array(growth->n, sizeof *growth->gy, UINT64_MAX, err);
    is_good = is_good && growth->gy && make_places(growth, grid_voxel_mm3(&labels->grid), err);
    sampling.gy = growth->gy;
    if (is_good)
        parallel_run(parallel_cores(), sample_some, &sampling);
    free(sampling.first);
    return is_good;
}

/* Leaves the weights of one region alone. */
static bool narrow(const struct region_set *set, size_t region, struct dose_choice *choice, struct error *err)
{
    if (dose_leaves_out(choice, region))
        return error_set(err, ERROR_STATE, "%s is not used with this dose", set->regions[region].name);
    const uint8_t row = dose_row_of_region(set, choice, region, err);
    if (row == DOSE_NO_ROW)
        return false;
    choice->rows[0] = choice->rows[row];
    choice->models[0] = choice->models[row];
    choice->n_rows = 1;
    choice->is_everywhere = true;
    return true;
}

struct dose_growth *dose_growth_create(struct derive *derive, const struct dose_choice *choice, size_t region,
                                       enum region_population population, struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    struct dose_choice of = *choice;
    struct volume *labels = NULL;
    struct dose_growth *growth = NULL;
    if (!narrow(set, region, &of, err))
        return NULL;
    struct isoeffective_rows *rows = isoeffective_rows_create(derive, &of, dose_field_get, err);
    if (rows)
        labels = population_labels(set, region, population, err);
    if (labels)
        growth = mem_new(sizeof *growth);
    if (growth) {
        *growth =
            (struct dose_growth){ .set = &isoeffective_sets[of.models[0]], .unit_gy = isoeffective_rows_unit_gy(rows) };
        if (!sample(growth, rows, labels, err)) {
            dose_growth_destroy(growth);
            growth = NULL;
        }
    }
    volume_unref(labels);
    isoeffective_rows_destroy(rows);
    return growth;
}

void dose_growth_destroy(struct dose_growth *growth)
{
    if (!growth)
        return;
    free(growth->gy);
    volume_unref(growth->labels);
    volume_unref(growth->values);
    free(growth);
}

/* ---- histograms ------------------------------------------------------------------------------------------------- */

static void grow_some(void *context, int part, int n_parts)
{
    const struct dose_growth *growth = context;
    float *values = growth->values->voxels;
    const size_t step = growth->n / (size_t)n_parts, from = step * (size_t)part,
                 to = part + 1 == n_parts ? growth->n : from + step;
    for (size_t i = from; i < to; i++) {
        const float *gy = growth->gy[i];
        double doses[4];
        for (int c = 0; c < 4; c++)
            doses[c] = growth->output * (double)gy[c];
        values[i] = (float)(isoeffective_dose(&growth->now, doses[0], doses[1], doses[2], doses[3]) / growth->unit_gy);
    }
}

bool dose_growth_histogram(struct dose_growth *growth, double output, double minutes, struct dvh *dvh,
                           struct error *err)
{
    const struct volume *rows[1] = { growth->values };
    const struct dvh_sweep how = { .labels = growth->labels, .rows = rows, .n_rows = 1 };
    isoeffective_init(&growth->now, growth->set, minutes);
    growth->output = output;
    parallel_run(parallel_cores(), grow_some, growth);
    volume_measure(growth->values);
    return dvh_sweep(&how, &(struct dvh_label){ 1, 1 }, 1, dvh, err);
}
