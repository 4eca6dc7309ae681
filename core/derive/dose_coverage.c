/* Compares the dose at the univels of a region with limits, in several threads. */
#include "core/derive/dose_coverage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/dose_histogram.h"

struct coverage_recipe {
    struct derive_recipe base;
    struct dose_coverage_choice choice;
};

enum { MAX_THREADS = 64 };

struct counts {
    uint64_t n, n_region, n_without;
};

struct marking {
    const struct dose_field *field;
    uint8_t row;                  /* of the field */
    const struct volume *members; /* the univels that count */
    double low, high;
    uint32_t first[3]; /* index in the region's grid of voxel 0 of labels */
    struct volume *labels;
    struct counts counts[MAX_THREADS];
};

/* The box of the univels that count; false: there is none. */
static bool find_box(const struct volume *members, uint32_t low[3], uint32_t high[3])
{
    const uint32_t *size = members->grid.size;
    const uint8_t *at = members->voxels;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = UINT32_MAX;
        high[axis] = 0;
    }
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++, at += size[0]) {
            const uint8_t *first = memchr(at, 1, size[0]), *last = at + size[0] - 1;
            if (!first)
                continue;
            while (!*last)
                last--;
            const uint32_t ends[2][3] = { { (uint32_t)(first - at), j, k }, { (uint32_t)(last - at), j, k } };
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = ends[0][axis] < low[axis] ? ends[0][axis] : low[axis];
                high[axis] = ends[1][axis] > high[axis] ? ends[1][axis] : high[axis];
            }
        }
    return low[0] != UINT32_MAX;
}

static void mark_row(struct marking *marking, uint32_t j, uint32_t k, struct counts *counts)
{
    const struct grid *all = &marking->members->grid;
    const uint32_t *size = marking->labels->grid.size, *first = marking->first;
    const uint8_t *members =
        (const uint8_t *)marking->members->voxels + first[0] + (size_t)all->size[0] * (j + (size_t)all->size[1] * k);
    uint8_t *labels =
        (uint8_t *)marking->labels->voxels + (size_t)size[0] * (j - first[1] + (size_t)size[1] * (k - first[2]));
    for (uint32_t i = 0; i < size[0]; i++) {
        double value;
        if (!members[i])
            continue;
        counts->n_region++;
        if (!dose_field_value_in(marking->field, marking->row,
                                 affine_point(&all->lps_mm_from_ijk, vec3(first[0] + i, j, k)), &value))
            counts->n_without++;
        else if (value >= marking->low && value < marking->high) {
            labels[i] = 1;
            counts->n++;
        }
    }
}

static void mark_some(void *context, int part, int n_parts)
{
    struct marking *marking = context;
    const uint32_t *size = marking->labels->grid.size;
    for (uint32_t k = (uint32_t)part; k < size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < size[1]; j++)
            mark_row(marking, marking->first[1] + j, marking->first[2] + k, &marking->counts[part]);
}

/* The voxels low to high of a grid. */
static bool part_of_grid(const struct grid *grid, const uint32_t low[3], const uint32_t high[3], struct grid *part,
                         struct error *err)
{
    struct affine map = grid->lps_mm_from_ijk;
    map.origin = affine_point(&map, vec3(low[0], low[1], low[2]));
    return grid_init(part, (uint32_t[3]){ high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1 }, &map,
                     err);
}

static bool fill(struct derive *derive, struct dose_coverage *coverage, const struct dose_coverage_choice *choice,
                 struct marking *marking, struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    const struct grid *grid = &set->layers[set->regions[choice->region].layer]->grid;
    uint32_t high[3];
    struct grid part;
    if (!find_box(marking->members, marking->first, high))
        return error_set(err, ERROR_NOT_FOUND, "region \"%s\" has no univels", set->regions[choice->region].id);
    if (!part_of_grid(grid, marking->first, high, &part, err) ||
        !(coverage->labels = volume_create(&part, VOXEL_U8, err)))
        return false;
    marking->labels = coverage->labels;
    marking->low = choice->low;
    marking->high = choice->high;
    parallel_run(parallel_cores(), mark_some, marking);
    for (int t = 0; t < MAX_THREADS; t++) {
        coverage->n += marking->counts[t].n;
        coverage->n_region += marking->counts[t].n_region;
        coverage->n_without += marking->counts[t].n_without;
    }
    uint64_t n_with = coverage->n_region - coverage->n_without;
    coverage->volume_cm3 = (double)coverage->n * grid_voxel_mm3(grid) / 1000;
    coverage->share = n_with > 0 ? (double)coverage->n / (double)n_with : NAN;
    coverage->least_share = (double)coverage->n / (double)coverage->n_region;
    coverage->most_share = (double)(coverage->n + coverage->n_without) / (double)coverage->n_region;
    volume_measure(coverage->labels);
    return true;
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return memcmp(&((const struct coverage_recipe *)a)->choice, &((const struct coverage_recipe *)b)->choice,
                  sizeof(struct dose_coverage_choice)) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    volume_unref(((struct dose_coverage *)base)->labels);
    free(base);
}

static const struct derive_kind kind = { sizeof(struct coverage_recipe), is_equal, build, destroy };

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct dose_coverage_choice *choice = &((const struct coverage_recipe *)base)->choice;
    const struct region_set *set = &derive_plan(derive)->regions;
    struct volume *members = population_labels(set, choice->region, choice->population, err);
    uint8_t row = members ? dose_row_of_region(set, &choice->dose, choice->region, err) : DOSE_NO_ROW;
    struct dose_field *field = row != DOSE_NO_ROW ? dose_field_get(derive, &choice->dose, err) : NULL;
    struct dose_coverage *coverage = field ? mem_array(1, sizeof *coverage, UINT64_MAX, err) : NULL;
    (void)way;
    bool is_good = coverage != NULL;
    if (is_good) {
        struct marking marking = { .field = field, .row = row, .members = members };
        derive_result_init(&coverage->base, &kind, 0);
        is_good = fill(derive, coverage, choice, &marking, err);
    }
    if (is_good)
        coverage->base.n_bytes = sizeof *coverage + grid_n_voxels(&coverage->labels->grid);
    else if (coverage) {
        destroy(&coverage->base);
        coverage = NULL;
    }
    if (members)
        volume_unref(members);
    if (field)
        derive_result_unref(&field->base);
    return coverage ? &coverage->base : NULL;
}

struct dose_coverage *dose_coverage_get(struct derive *derive, const struct dose_coverage_choice *choice,
                                        struct error *err)
{
    const struct coverage_recipe recipe = { { &kind, { SUBJECT_REGION, choice->region, 0 } }, *choice };
    if (isnan(choice->low) || isnan(choice->high)) {
        (void)error_set(err, ERROR_RANGE, "a limit of the dose is not a number");
        return NULL;
    }
    return (struct dose_coverage *)derive_get(derive, &recipe.base, NULL, err);
}
