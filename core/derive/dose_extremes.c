/* Takes the largest and the mean value of each region from its histogram. */
#include "core/derive/dose_extremes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/derive/dose_histogram.h"

struct extremes_recipe {
    struct derive_recipe base;
    struct dose_choice choice;
};

static bool read_region(struct dose_extremes *extremes, struct derive *derive, const struct dose_choice *choice,
                        size_t region, struct error *err)
{
    struct dvh dvh;
    if (!dose_histogram_get(derive, choice, region, population_usual(&derive_plan(derive)->regions), DOSE_BY_TISSUE, 1,
                            &dvh, err))
        return false;
    if (dvh.n > 0) {
        extremes->high[region] = dvh.high;
        extremes->mean[region] = dvh.sum / dvh.n;
        extremes->body_high = isnan(extremes->body_high) ? dvh.high : fmax(extremes->body_high, dvh.high);
    }
    dvh_finish(&dvh);
    return true;
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return memcmp(&((const struct extremes_recipe *)a)->choice, &((const struct extremes_recipe *)b)->choice,
                  sizeof(struct dose_choice)) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    free(base);
}

static const struct derive_kind kind = { sizeof(struct extremes_recipe), is_equal, build, destroy };

static void read_grid(struct dose_extremes *extremes, const struct dose_field *field)
{
    const float *values = field->rows[0]->voxels;
    size_t n = grid_n_voxels(&field->rows[0]->grid);
    for (size_t i = 0; i < n; i++)
        if (values[i] - values[i] == 0 && !(values[i] <= extremes->body_high)) /* of NAN too */
            extremes->body_high = values[i];
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    struct dose_field *field = dose_field_get(derive, &((const struct extremes_recipe *)base)->choice, err);
    struct dose_extremes *extremes = field ? mem_array(1, sizeof *extremes, UINT64_MAX, err) : NULL;
    (void)way;
    bool is_good = extremes != NULL;
    if (is_good) {
        derive_result_init(&extremes->base, &kind, sizeof *extremes);
        extremes->body_high = NAN;
        for (size_t r = 0; r < REGION_MAX; r++)
            extremes->high[r] = extremes->mean[r] = NAN;
        const struct dose_choice *choice = &((const struct extremes_recipe *)base)->choice;
        size_t n_used = 0;
        for (size_t r = 0; is_good && r < set->n_regions; r++)
            if (!dose_leaves_out(choice, r)) {
                is_good = read_region(extremes, derive, choice, r, err);
                n_used++;
            }
        if (n_used == 0)
            read_grid(extremes, field);
    }
    if (field)
        derive_result_unref(&field->base);
    if (is_good)
        return &extremes->base;
    free(extremes);
    return NULL;
}

struct dose_extremes *dose_extremes_get(struct derive *derive, const struct dose_choice *choice, struct error *err)
{
    const struct extremes_recipe recipe = { { &kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } }, *choice };
    return (struct dose_extremes *)derive_get(derive, &recipe.base, NULL, err);
}
