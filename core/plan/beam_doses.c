/* Finds the doses of single beams that add up to a treatment plan. */
#include "core/plan/beam_doses.h"

#include <string.h>

#include "core/dose/weights.h"
#include "core/plan/fit.h"

static bool has_same_quantities(const struct dose *a, const struct dose *b)
{
    if (a->n_components != b->n_components)
        return false;
    for (size_t c = 0; c < a->n_components; c++) {
        const struct dose_component *other = dose_component_of(b, a->components[c].quantity);
        if (!other || other->is_per_ppm != a->components[c].is_per_ppm)
            return false;
    }
    return true;
}

static bool may_be_added(const struct plan *plan, size_t a, size_t b)
{
    const struct fit fit = fit_of(plan, (struct fit_part){ FIT_DOSE, a }, (struct fit_part){ FIT_DOSE, b });
    return (fit.reasons & ~(1U << FIT_ABSENT)) == 0 && has_same_quantities(&plan->doses[a], &plan->doses[b]);
}

size_t plan_beam_doses(const struct plan *plan, int treatment_plan, size_t doses[PLAN_MAX_DOSES])
{
    const size_t n = treatment_plan >= 0 ? plan->treatment_plans[treatment_plan].n_beams : 0;
    bool is_found[PLAN_MAX_DOSES] = { false };
    size_t n_found = 0;
    if (n == 0 || n > PLAN_MAX_DOSES)
        return 0;
    for (size_t d = 0; d < plan->n_doses; d++) {
        const struct part_origin *origin = &plan->dose_origins[d];
        char per[FIT_PER_SIZE];
        if (origin->treatment_plan != treatment_plan || origin->beam == 0 || origin->beam > n ||
            strcmp(fit_per(&plan->doses[d], per), "beam") != 0)
            continue;
        if (is_found[origin->beam - 1])
            return 0;
        is_found[origin->beam - 1] = true;
        doses[origin->beam - 1] = d;
        n_found++;
    }
    for (size_t i = 1; n_found == n && i < n; i++)
        if (!may_be_added(plan, doses[i], doses[0]))
            return 0;
    return n_found == n ? n : 0;
}
