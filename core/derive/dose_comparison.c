#include "core/derive/dose_comparison.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

enum { MAX_THREADS = 64 };

struct comparison_recipe {
    struct derive_recipe base;
    struct dose_comparison_choice choice;
};

/* ---- one volume of a field -------------------------------------------------------------------------------------------- */
struct merging {
    const struct dose_field *field;
    const struct grid *grid;
    float *values;
};

static void merge_some(void *context, int part, int n_parts)
{
    const struct merging *merging = context;
    const struct grid *grid = merging->grid;
    bool is_of_rows = grid != &merging->field->grid || !merging->field->exact;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                size_t at = i + grid->size[0] * (j + (size_t)grid->size[1] * k);
                struct vec3 point = affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k));
                uint8_t row = dose_field_row(merging->field, point);
                double value = NAN;
                if (row != DOSE_NO_ROW && is_of_rows)
                    value = (double)((const float *)merging->field->rows[row]->voxels)[at];
                else if (row != DOSE_NO_ROW && !dose_field_value_in(merging->field, row, point, &value))
                    value = NAN;
                merging->values[at] = (float)value;
            }
}

/* The field's values with the tissue at each voxel's centre, on the dose's own grid or on that of its rows. One
 * reference. */
static struct volume *merge(const struct dose_field *field, bool is_on_own_grid, struct error *err)
{
    const struct grid *grid = is_on_own_grid ? &field->grid : &field->rows[0]->grid;
    if (!field->tissue && (!field->exact || !is_on_own_grid))
        return volume_ref(field->rows[0]);
    struct volume *volume = volume_create_unset(grid, VOXEL_F32, err);
    if (volume) {
        struct merging merging = { field, grid, volume->voxels };
        parallel_run(parallel_cores(), merge_some, &merging);
    }
    return volume;
}

/* ---- where they are compared ------------------------------------------------------------------------------------------ */
struct limiting {
    const struct volume *body; /* NULL: all of the grid */
    const float *from;
    struct volume *to;
    struct {
        uint64_t n_domain, n_outside;
    } parts[MAX_THREADS];
};

static void limit_some(void *context, int part, int n_parts)
{
    struct limiting *limiting = context;
    const struct grid *grid = &limiting->to->grid;
    float *to = limiting->to->voxels;
    uint64_t n_domain = 0, n_outside = 0;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                size_t at = i + (size_t)grid->size[0] * (j + (size_t)grid->size[1] * k);
                uint32_t univel[3];
                to[at] = limiting->from[at];
                if (!isfinite(to[at]))
                    continue;
                bool is_in =
                    !limiting->body ||
                    (volume_voxel_at(limiting->body, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)), univel) &&
                     volume_label(limiting->body, univel[0], univel[1], univel[2]));
                if (!is_in)
                    to[at] = NAN;
                n_domain += is_in;
                n_outside += !is_in;
            }
    limiting->parts[part].n_domain = n_domain;
    limiting->parts[part].n_outside = n_outside;
}

/* The values of the first dose, without those outside the body. One reference; takes over `values`. */
static struct volume *in_domain(struct dose_comparison *comparison, struct volume *values,
                                const struct dose_comparison_choice *choice, const struct region_set *set,
                                struct error *err)
{
    struct volume *body = choice->is_in_body ? body_labels(set, &choice->body, err) : NULL;
    struct volume *limited = body || !choice->is_in_body ? volume_create_unset(&values->grid, VOXEL_F32, err) : NULL;
    if (limited) {
        struct limiting *limiting = mem_new(sizeof *limiting);
        *limiting = (struct limiting){ .body = body, .from = values->voxels, .to = limited };
        int n_parts = parallel_cores();
        parallel_run(n_parts, limit_some, limiting);
        for (int part = 0; part < n_parts; part++) {
            comparison->n_domain += limiting->parts[part].n_domain;
            comparison->n_outside += limiting->parts[part].n_outside;
        }
        free(limiting);
        volume_measure(limited);
    }
    if (body)
        volume_unref(body);
    volume_unref(values);
    return limited;
}

/* ---- difference ------------------------------------------------------------------------------------------------------- */
struct subtracting {
    const struct volume *first;
    const struct dose_field *second;
    float *values;
    double threshold;
    struct {
        uint64_t n, n_without, n_below;
        double sum, squares, low, high;
    } parts[MAX_THREADS];
};

/* True if a point lies between centres of voxels. Nearer to a grid's outer faces the value of the last centre stands
 * for the dose, which would differ from the other dose by half a voxel of its gradient. */
static bool is_between_centres(const struct grid *grid, struct vec3 point_lps_mm)
{
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, point_lps_mm);
    const double ijk[3] = { at.x, at.y, at.z }, slack = 1e-4;
    for (int axis = 0; axis < 3; axis++)
        if (grid->size[axis] > 1 && (ijk[axis] < -slack || ijk[axis] > grid->size[axis] - 1 + slack))
            return false;
    return true;
}

static void subtract_some(void *context, int part, int n_parts)
{
    struct subtracting *subtracting = context;
    const struct grid *grid = &subtracting->first->grid;
    uint64_t n = 0, n_without = 0, n_below = 0;
    double sum = 0, squares = 0, low = INFINITY, high = -INFINITY;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                size_t at = i + grid->size[0] * (j + (size_t)grid->size[1] * k);
                double first = (double)((const float *)subtracting->first->voxels)[at], second;
                subtracting->values[at] = NAN;
                if (!isfinite(first))
                    continue;
                if (first < subtracting->threshold) {
                    n_below++;
                    continue;
                }
                struct vec3 point = affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k));
                if (!is_between_centres(&subtracting->second->rows[0]->grid, point) ||
                    !dose_field_value(subtracting->second, point, &second)) {
                    n_without++;
                    continue;
                }
                double difference = second - first;
                subtracting->values[at] = (float)difference;
                n++;
                sum += difference;
                squares += difference * difference;
                low = fmin(low, difference);
                high = fmax(high, difference);
            }
    subtracting->parts[part].n = n;
    subtracting->parts[part].n_without = n_without;
    subtracting->parts[part].n_below = n_below;
    subtracting->parts[part].sum = sum;
    subtracting->parts[part].squares = squares;
    subtracting->parts[part].low = low;
    subtracting->parts[part].high = high;
}

static bool subtract(struct dose_comparison *comparison, const struct volume *first, const struct dose_field *second,
                     double threshold, struct error *err)
{
    comparison->values = volume_create_unset(&first->grid, VOXEL_F32, err);
    struct subtracting *subtracting = comparison->values ? mem_new(sizeof *subtracting) : NULL;
    if (!subtracting)
        return false;
    *subtracting = (struct subtracting){
        .first = first, .second = second, .values = comparison->values->voxels, .threshold = threshold
    };
    int n_parts = parallel_cores();
    parallel_run(n_parts, subtract_some, subtracting);
    double sum = 0, squares = 0;
    comparison->low = INFINITY;
    comparison->high = -INFINITY;
    for (int part = 0; part < n_parts; part++) {
        comparison->n += subtracting->parts[part].n;
        comparison->n_without += subtracting->parts[part].n_without;
        comparison->n_below += subtracting->parts[part].n_below;
        sum += subtracting->parts[part].sum;
        squares += subtracting->parts[part].squares;
        comparison->low = fmin(comparison->low, subtracting->parts[part].low);
        comparison->high = fmax(comparison->high, subtracting->parts[part].high);
    }
    comparison->mean = sum / (double)comparison->n; /* NAN of none */
    comparison->root_mean_square = sqrt(squares / (double)comparison->n);
    if (comparison->n == 0)
        comparison->low = comparison->high = NAN;
    volume_measure(comparison->values);
    free(subtracting);
    return true;
}

/* ---- results ---------------------------------------------------------------------------------------------------------- */
static bool fill(struct dose_comparison *comparison, const struct dose_field *first, const struct dose_field *second,
                 const struct dose_comparison_choice *choice, const struct region_set *set, struct error *err)
{
    if (strcmp(first->unit, second->unit) != 0)
        return error_set(err, ERROR_RANGE, "one dose is in \"%s\", the other in \"%s\": they cannot be compared",
                         first->unit, second->unit);
    struct volume *merged = merge(first, true, err), *other = NULL;
    if (merged)
        merged = in_domain(comparison, merged, choice, set, err);
    if (!merged)
        return false;
    if (choice->is_gamma) {
        if ((other = merge(second, false, err)))
            comparison->values = gamma_index(merged, other, &choice->gamma, &comparison->gamma, err);
    } else if (subtract(comparison, merged, second, choice->gamma.threshold, err))
        memcpy(comparison->unit, first->unit, sizeof comparison->unit);
    volume_unref(merged);
    if (other)
        volume_unref(other);
    return comparison->values;
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return memcmp(&((const struct comparison_recipe *)a)->choice, &((const struct comparison_recipe *)b)->choice,
                  sizeof(struct dose_comparison_choice)) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    struct dose_comparison *comparison = (struct dose_comparison *)base;
    if (comparison->values)
        volume_unref(comparison->values);
    free(comparison);
}

static const struct derive_kind kind = { sizeof(struct comparison_recipe), is_equal, build, destroy };

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct dose_comparison_choice *choice = &((const struct comparison_recipe *)base)->choice;
    struct dose_field *first = dose_field_get(derive, &choice->first, err),
                      *second = first ? dose_field_get(derive, &choice->second, err) : NULL;
    struct dose_comparison *comparison = second ? mem_array(1, sizeof *comparison, UINT64_MAX, err) : NULL;
    (void)way;
    if (comparison) {
        derive_result_init(&comparison->base, &kind, 0);
        if (fill(comparison, first, second, choice, &derive_plan(derive)->regions, err))
            comparison->base.n_bytes = sizeof *comparison + grid_n_voxels(&comparison->values->grid) * sizeof(float);
        else {
            destroy(&comparison->base);
            comparison = NULL;
        }
    }
    if (first)
        derive_result_unref(&first->base);
    if (second)
        derive_result_unref(&second->base);
    return comparison ? &comparison->base : NULL;
}

struct dose_comparison *dose_comparison_get(struct derive *derive, const struct dose_comparison_choice *choice,
                                            struct error *err)
{
    const struct comparison_recipe recipe = { { &kind, { SUBJECT_DOSE, choice->first.parts[0].dose, 0 } }, *choice };
    return (struct dose_comparison *)derive_get(derive, &recipe.base, NULL, err);
}
