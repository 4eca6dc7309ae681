/* Chooses quantity, weights, levels and reference that a new room starts with. */
#include "core/scene/first_dose.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "core/base/mem.h"
#include "core/dose/weights.h"
#include "core/plan/beam_doses.h"
#include "core/plan/fit.h"
#include "core/region/target.h"
#include "dose_presets.h" /* generated from proto/dose_presets.json */

static const struct plan_level thesis_levels[] = {
    { 95, { 255, 0, 0 } },   { 90, { 0, 255, 0 } },   { 80, { 0, 0, 255 } },
    { 70, { 255, 255, 0 } }, { 60, { 255, 0, 255 } }, { 50, { 0, 255, 255 } },
};

static void first_levels(const struct plan_preferences *preferences, struct scene_dose_style *style)
{
    const struct plan_level *levels = preferences->n_levels ? preferences->levels : thesis_levels;
    style->n_levels = preferences->n_levels ? preferences->n_levels : sizeof thesis_levels / sizeof *thesis_levels;
    style->levels = mem_new(style->n_levels * sizeof *style->levels); /* at most PLAN_MAX_LEVELS */
    for (size_t i = 0; i < style->n_levels; i++) {
        struct scene_dose_level_entry *entry = &style->levels[i];
        snprintf(entry->id, sizeof entry->id, "level-%zu", i + 1);
        entry->value = scene_dose_level_default;
        entry->value.value = levels[i].percent;
        entry->value.color_rgb = (uint32_t)levels[i].rgb[0] << 16 | (uint32_t)levels[i].rgb[1] << 8 | levels[i].rgb[2];
    }
}

static double known_or(double value, double otherwise)
{
    return isfinite(value) ? value : otherwise;
}

static bool has_tissue_data(const struct region *region)
{
    return isfinite(region->boron_ratio) || isfinite(region->cbe_boron) || isfinite(region->rbe_nitrogen) ||
           isfinite(region->rbe_fast) || isfinite(region->rbe_gamma);
}

/* Weights of a region whose file has tissue data; what it leaves out is 1. */
static struct scene_tissue_weights file_weights(const struct region *region)
{
    struct scene_tissue_weights weights = scene_tissue_weights_default;
    weights.boron_ratio = known_or(region->boron_ratio, 1);
    weights.cbe = known_or(region->cbe_boron, 1);
    weights.nitrogen = known_or(region->rbe_nitrogen, 1);
    weights.fast = known_or(region->rbe_fast, 1);
    weights.gamma = known_or(region->rbe_gamma, 1);
    return weights;
}

/* True if one of the words begins a word of the name; all but ASCII letters separates words. */
static bool name_has_word(const char *name, const struct tissue_preset *tissue)
{
    for (const char *at = name; *at; at++) {
        bool begins = isalpha((unsigned char)*at) && (at == name || !isalpha((unsigned char)at[-1]));
        for (size_t i = 0; begins && i < tissue->n_words; i++)
            if (strncasecmp(at, tissue->words[i], strlen(tissue->words[i])) == 0)
                return true;
    }
    return tissue->n_words == 0;
}

/* Weights of a region by the first kind of tissue of a preset that its name tells; targets by type are tumour. */
static struct scene_tissue_weights preset_weights(const struct region *region, const struct weights_preset *preset)
{
    const struct tissue_preset *tissue = preset->tissues;
    while (!(tissue == preset->tissues && region_is_target(region)) && !name_has_word(region->name, tissue))
        tissue++; /* the last kind is for every name */
    struct scene_tissue_weights weights = scene_tissue_weights_default;
    weights.boron_ratio = tissue->boron_ratio;
    weights.cbe = tissue->cbe;
    weights.nitrogen = tissue->nitrogen;
    weights.fast = tissue->fast;
    weights.gamma = tissue->gamma;
    weights.other = tissue->other;
    snprintf(weights.isoeffective, sizeof weights.isoeffective, "%s", tissue->isoeffective);
    return weights;
}

static bool has_summands(const struct plan *plan)
{
    for (size_t d = 0; d < plan->n_doses; d++)
        for (size_t c = 0; c < plan->doses[d].n_components; c++)
            if (dose_is_summand(plan->doses[d].components[c].quantity))
                return true;
    return false;
}

/* Weights of the files where any region has them, else the first preset's as an example; none in a plan without
 * components. */
static void first_weights(const struct plan *plan, struct scene_dose_style *style)
{
    const struct region_set *set = &plan->regions;
    bool is_from_file = false;
    for (size_t i = 0; i < set->n_regions; i++)
        is_from_file |= has_tissue_data(&set->regions[i]) && !fit_is_of_other(plan, fit_part_of_region(plan, i));
    if (set->n_regions == 0 || !has_summands(plan))
        return;
    style->weights = mem_new(set->n_regions * sizeof *style->weights); /* at most REGION_MAX */
    for (size_t i = 0; i < set->n_regions; i++) {
        const struct region *region = &set->regions[i];
        if (is_from_file && !has_tissue_data(region))
            continue;
        struct scene_tissue_weights_entry *entry = &style->weights[style->n_weights++];
        memcpy(entry->id, region->id, sizeof entry->id);
        entry->value = is_from_file ? file_weights(region) : preset_weights(region, &weights_presets[0]);
    }
    snprintf(style->weights_name, sizeof style->weights_name, "%s",
             is_from_file ? "from the plan's files" : weights_presets[0].name);
}

/* Adds the doses of the other beams, where the first dose is of one beam and each beam of its plan has one. */
static void first_sum(const struct plan *plan, struct scene_dose_style *style)
{
    size_t doses[PLAN_MAX_DOSES];
    const size_t n =
        plan->dose_origins[0].beam > 0 ? plan_beam_doses(plan, plan->dose_origins[0].treatment_plan, doses) : 0;
    if (n < 2)
        return;
    style->sum = mem_new((n - 1) * sizeof *style->sum); /* at most PLAN_MAX_DOSES */
    for (size_t i = 0; i < n; i++) {
        if (doses[i] == 0)
            continue;
        struct scene_dose_part_entry *entry = &style->sum[style->n_sum++];
        memcpy(entry->id, plan->doses[doses[i]].id, sizeof entry->id);
        entry->value = scene_dose_part_default;
    }
}

void scene_first_dose(const struct plan *plan, struct scene_dose_style *style)
{
    first_levels(&plan->preferences, style);
    first_weights(plan, style);
    if (plan->n_doses == 0)
        return;
    first_sum(plan, style);
    const struct dose *dose = &plan->doses[0];
    const struct dose_component *boron = dose_component_of(dose, DOSE_BORON);
    enum dose_quantity quantity = DOSE_TOTAL;
    if (boron && style->n_weights > 0 && (boron->is_per_ppm || !dose_component_of(dose, DOSE_TOTAL)))
        style->quantity = SCENE_DOSE_QUANTITY_WEIGHTED;
    else if (!dose_component_of(dose, DOSE_TOTAL) && dose_component_of(dose, DOSE_WEIGHTED_TOTAL)) {
        style->quantity = SCENE_DOSE_QUANTITY_WEIGHTED_TOTAL;
        quantity = DOSE_WEIGHTED_TOTAL;
    }
    if (style->quantity != SCENE_DOSE_QUANTITY_WEIGHTED && style->n_sum == 0 && dose->reference[quantity] > 0)
        style->reference.kind = SCENE_DOSE_REFERENCE_KIND_FILE;
}
