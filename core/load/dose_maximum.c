/* Finds the largest value of each dose inside the patient. */
#include "core/load/dose_maximum.h"

#include <math.h>

#include "core/plan/fit.h"

/* True by region: of the dose's patient and frame. */
static void find_belonging(const struct plan *plan, size_t dose, bool belongs[REGION_MAX])
{
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        struct fit fit = fit_of(plan, fit_part_of_region(plan, r), (struct fit_part){ FIT_DOSE, dose });
        belongs[r] = !(fit.reasons & (1U << FIT_FRAME | 1U << FIT_PATIENT));
    }
}

static bool is_in_region(const struct region_set *set, const bool *belongs, struct vec3 point_lps_mm)
{
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        uint32_t at[3];
        if (!volume_voxel_at(set->layers[layer], point_lps_mm, at))
            continue;
        uint16_t label = volume_label(set->layers[layer], at[0], at[1], at[2]);
        for (size_t r = 0; label != 0 && r < set->n_regions;
             r++) /* a label that is no region is the filling around the patient */
            if (set->regions[r].layer == layer && set->regions[r].label == label && belongs[r])
                return true;
    }
    return false;
}

static bool is_valid(const struct volume *mask, struct vec3 point_lps_mm)
{
    uint32_t at[3];
    return !mask || (volume_voxel_at(mask, point_lps_mm, at) && volume_label(mask, at[0], at[1], at[2]) != 0);
}

static void measure(const struct plan *plan, struct dose *dose, const struct dose_component *component,
                    const bool *belongs)
{
    const struct volume *values = component->values;
    const uint32_t *size = values->grid.size;
    double high = 0;
    if (grid_n_voxels(&values->grid) > PLAN_BODY_MAX_VOXELS)
        return;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++) {
                double value = volume_value(values, i, j, k);
                if (!(value > high)) /* tested first because it is quick */
                    continue;
                struct vec3 point = affine_point(&values->grid.lps_mm_from_ijk, vec3(i, j, k));
                if (is_in_region(&plan->regions, belongs, point) && is_valid(dose->mask, point))
                    high = value;
            }
    dose->body_high[component->quantity] = high;
}

static void note_absurd(struct plan *plan, const struct dose *dose)
{
    size_t n = 0;
    const struct dose_component *worst = NULL;
    double most = 0;
    for (size_t c = 0; c < dose->n_components; c++) {
        double body = dose->body_high[dose->components[c].quantity];
        double times = body > 0 ? dose->components[c].values->high / body : 0;
        n += times > PLAN_ABSURD_TIMES;
        if (times > most) {
            most = times;
            worst = &dose->components[c];
        }
    }
    if (n > 0)
        report_add(
            &plan->report, REPORT_WARNING, "dose.absurd-outside", dose->id,
            "%zu of %zu quantities reach over %d times their largest value inside the regions somewhere outside them; %s goes up to "
            "%.3g, inside to %.3g. Only values inside should set a scale.",
            n, dose->n_components, PLAN_ABSURD_TIMES, dose_quantity_word(worst->quantity), worst->values->high,
            dose->body_high[worst->quantity]);
}

void plan_measure_body(struct plan *plan)
{
    for (size_t d = 0; d < plan->n_doses && plan->regions.n_regions > 0; d++) {
        bool belongs[REGION_MAX];
        find_belonging(plan, d, belongs);
        for (size_t c = 0; c < plan->doses[d].n_components; c++)
            measure(plan, &plan->doses[d], &plan->doses[d].components[c], belongs);
        note_absurd(plan, &plan->doses[d]);
    }
}
