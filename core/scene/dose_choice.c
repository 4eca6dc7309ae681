/* Turns a scene's dose into the recipe of its field. */
#include "core/scene/dose_choice.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/scene/snapshot.h"
#include "dose_presets.h" /* generated from proto/dose_presets.json */

/* Indexed by the scene's quantity; the two that are computed have no quantity of the files. */
static const struct {
    const char *word;
    enum dose_shown shown;
    enum dose_quantity quantity;
} quantities[] = {
    [SCENE_DOSE_QUANTITY_WEIGHTED] = { "weighted", DOSE_SHOWN_WEIGHTED, DOSE_TOTAL },
    [SCENE_DOSE_QUANTITY_TOTAL] = { "total", DOSE_SHOWN_QUANTITY, DOSE_TOTAL },
    [SCENE_DOSE_QUANTITY_BORON] = { "boron", DOSE_SHOWN_QUANTITY, DOSE_BORON },
    [SCENE_DOSE_QUANTITY_NITROGEN] = { "nitrogen", DOSE_SHOWN_QUANTITY, DOSE_NITROGEN },
    [SCENE_DOSE_QUANTITY_FAST] = { "fast", DOSE_SHOWN_QUANTITY, DOSE_FAST },
    [SCENE_DOSE_QUANTITY_GAMMA] = { "gamma", DOSE_SHOWN_QUANTITY, DOSE_GAMMA },
    [SCENE_DOSE_QUANTITY_OTHER] = { "other", DOSE_SHOWN_QUANTITY, DOSE_OTHER },
    [SCENE_DOSE_QUANTITY_FAST_FLUENCE] = { "fast-fluence", DOSE_SHOWN_QUANTITY, DOSE_FAST_FLUENCE },
    [SCENE_DOSE_QUANTITY_EPITHERMAL_FLUENCE] = { "epithermal-fluence", DOSE_SHOWN_QUANTITY, DOSE_EPITHERMAL_FLUENCE },
    [SCENE_DOSE_QUANTITY_THERMAL_FLUENCE] = { "thermal-fluence", DOSE_SHOWN_QUANTITY, DOSE_THERMAL_FLUENCE },
    [SCENE_DOSE_QUANTITY_BLOOD_BORON] = { "blood-boron", DOSE_SHOWN_QUANTITY, DOSE_BLOOD_BORON },
    [SCENE_DOSE_QUANTITY_WEIGHTED_TOTAL] = { "weighted-total", DOSE_SHOWN_QUANTITY, DOSE_WEIGHTED_TOTAL },
    [SCENE_DOSE_QUANTITY_ISOEFFECTIVE] = { "isoeffective", DOSE_SHOWN_ISOEFFECTIVE, DOSE_TOTAL },
};
enum { N_QUANTITIES = sizeof quantities / sizeof *quantities };

const char *dose_quantity_scene_word(enum scene_dose_quantity quantity)
{
    return quantities[quantity].word;
}

bool dose_quantity_from_scene_word(const char *word, enum scene_dose_quantity *quantity)
{
    for (int i = 0; i < N_QUANTITIES; i++)
        if (strcmp(quantities[i].word, word) == 0) {
            *quantity = (enum scene_dose_quantity)i;
            return true;
        }
    return false;
}

int dose_index_of(const struct plan *plan, const char *id)
{
    for (size_t i = 0; i < plan->n_doses; i++)
        if (strcmp(plan->doses[i].id, id) == 0)
            return (int)i;
    return -1;
}

int scene_dose_index(const struct plan *plan, const struct scene *scene)
{
    return scene->dose.id[0] ? dose_index_of(plan, scene->dose.id) : plan->n_doses ? 0 : -1;
}

const struct scene_tissue_weights *scene_weights_of(const struct plan *plan, const struct scene *scene, size_t region)
{
    for (int at = (int)region; at >= 0; at = plan->regions.regions[at].parent)
        for (size_t i = 0; i < scene->dose.n_weights; i++)
            if (strcmp(scene->dose.weights[i].id, plan->regions.regions[at].id) == 0)
                return &scene->dose.weights[i].value;
    return NULL;
}

struct tissue_weights tissue_weights_of(const struct scene_tissue_weights *row)
{
    return (struct tissue_weights){ row->boron_ratio, row->cbe, row->nitrogen, row->fast, row->gamma, row->other };
}

/* Finds or adds a row. False with a sentence: there are DOSE_MAX_ROWS others, or the parameters are not known.
 * *index: DOSE_NO_ROW: the tissue has no isoeffective dose. */
static bool add_row(struct dose_choice *choice, const struct scene_tissue_weights *row, uint8_t *index,
                    struct error *why)
{
    struct tissue_weights weights = tissue_weights_of(row);
    uint32_t model = 0;
    *index = DOSE_NO_ROW;
    if (choice->shown != DOSE_SHOWN_WEIGHTED) /* of physical doses only the concentration differs between tissues */
        weights = (struct tissue_weights){ row->boron_ratio, 1, 1, 1, 1, 1 };
    if (choice->shown == DOSE_SHOWN_ISOEFFECTIVE) {
        if (!row->isoeffective[0])
            return true;
        while (model < n_isoeffective_sets && strcmp(isoeffective_sets[model].name, row->isoeffective) != 0)
            model++;
        if (model == n_isoeffective_sets)
            return error_set(why, ERROR_NOT_FOUND, "there are no parameters \"%.40s\" of the isoeffective dose",
                             row->isoeffective);
    }
    size_t i = 0;
    while (i < choice->n_rows &&
           !(memcmp(&choice->rows[i], &weights, sizeof weights) == 0 && choice->models[i] == model))
        i++;
    if (i == DOSE_MAX_ROWS)
        return error_set(why, ERROR_LIMIT, "more than %d different sets of weights", DOSE_MAX_ROWS);
    choice->rows[i] = weights;
    choice->models[i] = model;
    choice->n_rows = i < choice->n_rows ? choice->n_rows : i + 1;
    *index = (uint8_t)i;
    return true;
}

static bool add_rows(const struct snapshot *snapshot, const char *tissue, struct dose_choice *choice, struct error *why)
{
    const struct plan *plan = snapshot->plan;
    const struct scene *scene = &snapshot->scene;
    bool is_on_tissue = false;
    for (size_t p = 0; p < choice->n_parts; p++)
        is_on_tissue |= dose_depends_on_tissue(&plan->doses[choice->parts[p].dose], choice->shown, choice->quantity);
    memset(choice->row_of_region, DOSE_NO_ROW, sizeof choice->row_of_region);
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        if (!fit_is_used(region_use(&snapshot->fits, r)))
            choice->left_out[r / 8] |= (uint8_t)(1 << r % 8);
    if (!is_on_tissue) {
        choice->is_everywhere = true;
        choice->n_rows = 1;
        choice->rows[0] = (struct tissue_weights){ 1, 1, 1, 1, 1, 1 };
        return true;
    }
    if (tissue[0]) {
        const struct region *region = region_find(&plan->regions, tissue);
        const struct scene_tissue_weights *row =
            region ? scene_weights_of(plan, scene, (size_t)(region - plan->regions.regions)) : NULL;
        if (!row)
            return error_set(why, ERROR_NOT_FOUND, "\"%.64s\" has no weights that could hold everywhere", tissue);
        uint8_t index;
        choice->is_everywhere = true;
        return add_row(choice, row, &index, why) &&
               (index != DOSE_NO_ROW ||
                error_set(why, ERROR_NOT_FOUND, "\"%.64s\" has no parameters of this dose", tissue));
    }
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        const struct scene_tissue_weights *row =
            fit_is_used(region_use(&snapshot->fits, r)) ? scene_weights_of(plan, scene, r) : NULL;
        if (row && !add_row(choice, row, &choice->row_of_region[r], why))
            return false;
    }
    if (choice->n_rows == 0)
        return error_set(why, ERROR_NOT_FOUND,
                         choice->shown == DOSE_SHOWN_ISOEFFECTIVE ? "no tissue has parameters of the isoeffective dose"
                                                                  : "no tissue has weights");
    return true;
}

/* Adds a part that has the quantity. */
static bool add_part(const struct plan *plan, struct dose_choice *choice, size_t dose, double factor, struct error *why)
{
    const struct dose *part = &plan->doses[dose];
    bool has_it = dose_component_of(part, choice->quantity) != NULL;
    if (dose_is_summed(part, choice->shown, choice->quantity)) {
        has_it = false;
        for (size_t c = 0; c < part->n_components; c++)
            has_it |= dose_is_summand(part->components[c].quantity);
        if (!has_it)
            return error_set(why, ERROR_NOT_FOUND, "dose \"%s\" has no physical components to sum", part->id);
    }
    if (!has_it)
        return error_set(why, ERROR_NOT_FOUND, "dose \"%s\" has no %s", part->id, dose_quantity_word(choice->quantity));
    for (size_t p = 0; p < choice->n_parts; p++)
        if (choice->parts[p].dose == dose)
            return true; /* the dose shown counts once */
    choice->parts[choice->n_parts].dose = dose;
    choice->parts[choice->n_parts++].factor = factor;
    return true;
}

/* Fills all but the parts that are added. */
static bool begin_choice(const struct snapshot *snapshot, size_t dose, double factor, enum scene_dose_quantity quantity,
                         struct dose_choice *choice, struct error *why)
{
    const struct scene *scene = &snapshot->scene;
    memset(choice, 0, sizeof *choice);
    choice->shown = quantities[quantity].shown;
    choice->quantity = quantities[quantity].quantity;
    choice->blood_ppm = scene->dose.blood_ppm;
    choice->irradiation_min = choice->shown == DOSE_SHOWN_ISOEFFECTIVE ? scene->dose.irradiation_min : 0;
    choice->unit_of = dose;
    return add_part(snapshot->plan, choice, dose, factor, why);
}

static bool end_choice(const struct snapshot *snapshot, const char *tissue, struct dose_choice *choice,
                       struct error *why)
{
    if (!add_rows(snapshot, tissue, choice, why))
        return false;
    bool has_boron = false;
    for (size_t p = 0; p < choice->n_parts; p++) {
        const struct dose *part = &snapshot->plan->doses[choice->parts[p].dose];
        for (size_t c = 0; c < part->n_components; c++)
            has_boron |= part->components[c].is_per_ppm && (dose_is_summed(part, choice->shown, choice->quantity)
                                                                ? part->components[c].quantity == DOSE_BORON
                                                                : part->components[c].quantity == choice->quantity);
    }
    if (has_boron)
        return true;
    choice->blood_ppm = 0; /* what does not depend on it is one and the same field */
    for (size_t p = 0; p < choice->n_parts; p++)
        choice->parts[p].more_ppm = 0;
    return true;
}

/* Contours of a structure set are each a whole region. */
static enum region_population usual_population(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_region_origins; i++)
        if (plan->region_origins[i].structs_uid[0])
            return POPULATION_WHOLE;
    return population_usual(&plan->regions);
}

enum region_population scene_population(const struct plan *plan, const struct scene *scene)
{
    switch (scene->dose.population) {
    case SCENE_DOSE_POPULATION_OWN: return POPULATION_OWN;
    case SCENE_DOSE_POPULATION_WHOLE: return POPULATION_WHOLE;
    case SCENE_DOSE_POPULATION_USUAL: break;
    }
    return usual_population(plan);
}

bool population_from_word(const struct plan *plan, const char *word, enum region_population *population)
{
    bool is_own = strcmp(word, "own") == 0, is_whole = strcmp(word, "whole") == 0;
    *population = is_own ? POPULATION_OWN : is_whole ? POPULATION_WHOLE : usual_population(plan);
    return is_own || is_whole || !word[0] || strcmp(word, "usual") == 0;
}

const char *dose_basis_words(const struct plan *plan, const struct dose_choice *choice, const char *tissue,
                             char words[96])
{
    bool is_on_tissue = false;
    for (size_t p = 0; p < choice->n_parts; p++)
        is_on_tissue |= dose_depends_on_tissue(&plan->doses[choice->parts[p].dose], choice->shown, choice->quantity);
    if (!is_on_tissue)
        return NULL;
    const struct region *region = tissue[0] ? region_find(&plan->regions, tissue) : NULL;
    if (region)
        snprintf(words, 96, "weights of %.80s", region->name);
    else
        snprintf(words, 96, "each region's own weights");
    return words;
}

static bool refuse(const struct snapshot *snapshot, size_t dose, const struct fit_use *use, struct error *why)
{
    char sentence[FIT_WHY_SIZE];
    fit_use_sentence(&snapshot->fits, (struct fit_part){ FIT_DOSE, dose }, use, sentence);
    return error_set(why, ERROR_STATE, "%s", sentence);
}

struct fit_use dose_part_use(const struct snapshot *snapshot, size_t dose, double factor)
{
    return dose_join_of(&snapshot->fits, dose, factor, (size_t)snapshot->dose, snapshot->scene.dose.factor,
                        DOSE_JOIN_SUM);
}

bool dose_choice_of(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity,
                    struct dose_choice *choice, struct error *why)
{
    return dose_choice_in(snapshot, dose, quantity, snapshot->scene.dose.tissue, choice, why);
}

bool dose_choice_in(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity, const char *tissue,
                    struct dose_choice *choice, struct error *why)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    memset(choice, 0, sizeof *choice);
    if (!fit_is_used(&snapshot->fits.doses[dose]))
        return refuse(snapshot, dose, &snapshot->fits.doses[dose], why);
    if (!begin_choice(snapshot, dose, style->factor, quantity, choice, why))
        return false;
    for (size_t i = 0; (int)dose == snapshot->dose && i < style->n_sum; i++) {
        int part = dose_index_of(snapshot->plan, style->sum[i].id);
        double factor = style->sum[i].value.factor;
        if (part < 0 || part == snapshot->dose) /* the dose shown counts once */
            continue;
        struct fit_use use = dose_part_use(snapshot, (size_t)part, factor);
        if (fit_is_used(&use) && !add_part(snapshot->plan, choice, (size_t)part, factor, why))
            return false;
    }
    return end_choice(snapshot, tissue, choice, why);
}

/* How many times a dose counts beside the one shown: as often, unless the factor is what makes that one of the whole
 * plan, as the second already is. */
static double factor_beside(const struct snapshot *snapshot, size_t second)
{
    const struct dose *first = &snapshot->plan->doses[snapshot->dose], *other = &snapshot->plan->doses[second];
    char pers[2][FIT_PER_SIZE];
    return strcmp(fit_per(first, pers[0]), fit_per(other, pers[1])) == 0 ? snapshot->scene.dose.factor : 1;
}

struct fit_use dose_compared_use(const struct snapshot *snapshot, size_t second)
{
    return dose_join_of(&snapshot->fits, second, factor_beside(snapshot, second), (size_t)snapshot->dose,
                        snapshot->scene.dose.factor, DOSE_JOIN_COMPARE);
}

bool dose_choice_compared(const struct snapshot *snapshot, size_t second, enum scene_dose_quantity quantity,
                          const char *tissue, struct dose_choice *choice, struct error *why)
{
    memset(choice, 0, sizeof *choice);
    if (snapshot->dose < 0 || !fit_is_used(&snapshot->fits.doses[snapshot->dose]))
        return error_set(why, ERROR_NOT_FOUND, "there is no first dose to compare with");
    struct fit_use use = dose_compared_use(snapshot, second);
    if (!fit_is_used(&use))
        return refuse(snapshot, second, &use, why);
    if (!begin_choice(snapshot, second, factor_beside(snapshot, second), quantity, choice, why))
        return false;
    choice->unit_of = (size_t)snapshot->dose;
    return end_choice(snapshot, tissue, choice, why);
}

/* False: the quantity holds boron of a concentration that nothing here changes, and that is not ppm. */
static bool follows_ppm(const struct dose *dose, const struct dose_choice *choice, double ppm)
{
    bool is_summed = dose_is_summed(dose, choice->shown, choice->quantity);
    for (size_t c = 0; c < dose->n_components; c++) {
        const struct dose_component *component = &dose->components[c];
        bool is_in = is_summed ? dose_is_summand(component->quantity) : component->quantity == choice->quantity;
        bool holds_boron = component->quantity == DOSE_BORON || component->quantity == DOSE_BLOOD_BORON ||
                           component->quantity == DOSE_TOTAL || component->quantity == DOSE_WEIGHTED_TOTAL;
        bool is_the_same = component->has_boron_ppm && fabs(component->boron_ppm - ppm) <= 1e-6 * ppm;
        if (is_in && holds_boron && !component->is_per_ppm && !is_the_same)
            return false;
    }
    return true;
}

bool dose_choice_given(const struct snapshot *snapshot, const struct dose_given *given, size_t n,
                       enum scene_dose_quantity quantity, const char *tissue, struct dose_choice *choice,
                       struct error *why)
{
    for (size_t i = 0; i < n; i++) {
        const struct dose *dose = &snapshot->plan->doses[given[i].dose];
        struct fit_use use = i == 0 ? snapshot->fits.doses[given[0].dose]
                                    : dose_join_of(&snapshot->fits, given[i].dose, given[i].factor, given[0].dose,
                                                   given[0].factor, DOSE_JOIN_GIVEN);
        if (!fit_is_used(&use))
            return refuse(snapshot, given[i].dose, &use, why);
        if (!(i == 0 ? begin_choice(snapshot, given[0].dose, given[0].factor, quantity, choice, why)
                     : add_part(snapshot->plan, choice, given[i].dose, given[i].factor, why)))
            return false;
        choice->blood_ppm = given[0].blood_ppm;
        choice->parts[choice->n_parts - 1].more_ppm = given[i].blood_ppm - given[0].blood_ppm;
        if (given[i].is_measured && !follows_ppm(dose, choice, given[i].blood_ppm))
            return error_set(why, ERROR_STATE,
                             "dose \"%s\" does not give boron per ppm: a measured concentration cannot be used with it",
                             dose->id);
    }
    return end_choice(snapshot, tissue, choice, why);
}
