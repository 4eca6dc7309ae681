#include "core/derive/dose_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

struct error_recipe {
    struct derive_recipe base;
    struct dose_choice choice;
};

struct working {
    const struct dose *dose;
    const struct dose_choice *choice;
    const struct dose_field *field;
    struct dose_factors factors[DOSE_MAX_ROWS];
    bool is_summed;
    float *percent;
};

static bool is_in(const struct working *working, enum dose_quantity quantity)
{
    return working->is_summed ? dose_is_summand(quantity) : quantity == working->choice->quantity;
}

static double percent_at(const struct working *working, struct vec3 point)
{
    uint8_t row = dose_field_row(working->field, point);
    double sum = 0, squares = 0, shown;
    if (row == DOSE_NO_ROW || !dose_field_value(working->field, point, &shown))
        return NAN;
    for (size_t c = 0; c < working->dose->n_components; c++) {
        const struct dose_component *component = &working->dose->components[c];
        double factor = working->factors[row].of[component->quantity], value, error;
        if (!is_in(working, component->quantity) || factor == 0)
            continue;
        if (!component->error || !volume_sample(component->values, point, &value) ||
            !volume_sample(component->error, point, &error))
            return NAN;
        sum += factor * value;
        squares += factor * error * factor * error;
    }
    return sum > 0 ? 100 * sqrt(squares) / sum : NAN;
}

static void work_some(void *context, int part, int n_parts)
{
    const struct working *working = context;
    const struct grid *grid = &working->field->grid;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++)
                working->percent[i + grid->size[0] * (j + (size_t)grid->size[1] * k)] =
                    (float)percent_at(working, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)));
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return memcmp(&((const struct error_recipe *)a)->choice, &((const struct error_recipe *)b)->choice,
                  sizeof(struct dose_choice)) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    volume_unref(((struct dose_error *)base)->percent);
    free(base);
}

static const struct derive_kind kind = { sizeof(struct error_recipe), is_equal, build, destroy };

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct dose_choice *choice = &((const struct error_recipe *)base)->choice;
    const struct dose *dose = &derive_plan(derive)->doses[choice->parts[0].dose];
    struct dose_field *field = dose_field_get(derive, choice, err);
    struct volume *percent = field ? volume_create_unset(&field->grid, VOXEL_F32, err) : NULL;
    struct dose_error *error = percent ? mem_array(1, sizeof *error, UINT64_MAX, err) : NULL;
    struct working *working = error ? mem_new(sizeof *working) : NULL;
    (void)way;
    if (working) {
        *working = (struct working){ .dose = dose, .choice = choice, .field = field, .percent = percent->voxels };
        working->is_summed = dose_is_summed(dose, choice->shown, choice->quantity);
        for (size_t r = 0; r < choice->n_rows; r++)
            working->factors[r] = dose_factors_of(dose, choice->shown, choice->quantity, &choice->rows[r],
                                                  choice->blood_ppm + choice->parts[0].more_ppm);
        parallel_run(parallel_cores(), work_some, working);
        volume_measure(percent);
        derive_result_init(&error->base, &kind, sizeof *error + grid_n_voxels(&percent->grid) * sizeof(float));
        error->percent = percent;
    } else if (percent)
        volume_unref(percent);
    free(working);
    if (field)
        derive_result_unref(&field->base);
    return error ? &error->base : NULL;
}

struct dose_error *dose_error_get(struct derive *derive, const struct dose_choice *choice, struct error *err)
{
    const struct error_recipe recipe = { { &kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } }, *choice };
    const struct dose *dose = &derive_plan(derive)->doses[choice->parts[0].dose];
    bool has_any = false;
    for (size_t c = 0; c < dose->n_components; c++)
        has_any |= dose->components[c].error != NULL;
    if (choice->n_parts > 1 || choice->shown == DOSE_SHOWN_ISOEFFECTIVE)
        (void)error_set(err, ERROR_UNSUPPORTED, "the statistical error of a sum of doses is not known");
    else if (!has_any)
        (void)error_set(err, ERROR_NOT_FOUND, "the files give no statistical error of dose \"%s\"", dose->id);
    else
        return (struct dose_error *)derive_get(derive, &recipe.base, NULL, err);
    return NULL;
}
