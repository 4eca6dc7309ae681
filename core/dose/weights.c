/* Factors of dose components in physical and weighted sums. */
#include "core/dose/weights.h"

#include <math.h>
#include <stdio.h>

bool dose_is_summand(enum dose_quantity quantity)
{
    return quantity == DOSE_BORON || quantity == DOSE_NITROGEN || quantity == DOSE_FAST || quantity == DOSE_GAMMA ||
           quantity == DOSE_OTHER;
}

const struct dose_component *dose_component_of(const struct dose *dose, enum dose_quantity quantity)
{
    for (size_t i = 0; i < dose->n_components; i++)
        if (dose->components[i].quantity == quantity)
            return &dose->components[i];
    return NULL;
}

bool dose_is_summed(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity)
{
    return shown != DOSE_SHOWN_QUANTITY || (quantity == DOSE_TOTAL && !dose_component_of(dose, DOSE_TOTAL));
}

uint32_t dose_missing_summands(const struct dose *dose)
{
    static const enum dose_quantity needed[] = { DOSE_BORON, DOSE_NITROGEN, DOSE_FAST, DOSE_GAMMA };
    uint32_t missing = 0;
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
        if (!dose_component_of(dose, needed[i]))
            missing |= 1u << needed[i];
    return missing;
}

static bool is_boron_per_ppm(const struct dose *dose)
{
    const struct dose_component *boron = dose_component_of(dose, DOSE_BORON);
    return boron && boron->is_per_ppm;
}

bool dose_depends_on_tissue(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity)
{
    if (shown != DOSE_SHOWN_QUANTITY)
        return true;
    return is_boron_per_ppm(dose) && (quantity == DOSE_BORON || dose_is_summed(dose, shown, quantity));
}

/* Factor from the file's value to the dose at the concentration in the tissue. */
static double physical_factor(const struct dose_component *component, const struct tissue_weights *weights,
                              double blood_ppm)
{
    if (!component->is_per_ppm)
        return 1;
    return component->quantity == DOSE_BORON ? weights->boron_ratio * blood_ppm : blood_ppm;
}

double dose_weight_of(enum dose_quantity quantity, const struct tissue_weights *weights)
{
    switch (quantity) {
    case DOSE_BORON: return weights->cbe;
    case DOSE_NITROGEN: return weights->nitrogen;
    case DOSE_FAST: return weights->fast;
    case DOSE_GAMMA: return weights->gamma;
    case DOSE_OTHER: return weights->other;
    default: return NAN;
    }
}

struct dose_factors dose_factors_of(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity,
                                    const struct tissue_weights *weights, double blood_ppm)
{
    struct dose_factors factors = { { 0 } };
    bool is_sum = dose_is_summed(dose, shown, quantity);
    for (size_t i = 0; i < dose->n_components; i++) {
        const struct dose_component *component = &dose->components[i];
        if (is_sum ? !dose_is_summand(component->quantity) : component->quantity != quantity)
            continue;
        factors.of[component->quantity] =
            physical_factor(component, weights, blood_ppm) *
            (shown == DOSE_SHOWN_WEIGHTED ? dose_weight_of(component->quantity, weights) : 1);
    }
    return factors;
}

void dose_shown_unit(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity,
                     char unit[DOSE_UNIT_SIZE])
{
    if (shown == DOSE_SHOWN_QUANTITY)
        dose_unit_of(dose, quantity, unit);
    else
        snprintf(unit, DOSE_UNIT_SIZE, "%.14s%s", dose->unit,
                 !dose->unit[0]                 ? ""
                 : shown == DOSE_SHOWN_WEIGHTED ? "(w)"
                                                : "(IsoE)");
}
