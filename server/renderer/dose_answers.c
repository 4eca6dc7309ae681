/* Answers to questions about the dose that a scene shows: its scale, and its values at a point. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/plan/beam_doses.h"
#include "core/scene/dose_scale.h"
#include "core/scene/scene_probe.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/document.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"
#include "wire_gen.h"

static void add_quantities(cJSON *json, const char *name, uint32_t bits)
{
    cJSON *list = cJSON_AddArrayToObject(json, name);
    for (int i = 0; i < DOSE_N_QUANTITIES; i++)
        if (bits >> i & 1)
            cJSON_AddItemToArray(list, cJSON_CreateString(dose_quantity_word((enum dose_quantity)i)));
}

static cJSON *weights_object(const struct scene_tissue_weights *weights, double blood_ppm)
{
    cJSON *json = cJSON_CreateObject();
    json_add_finite(json, "boron_ratio", weights->boron_ratio);
    json_add_finite(json, "boron_ppm", weights->boron_ratio * blood_ppm);
    json_add_finite(json, "cbe", weights->cbe);
    json_add_finite(json, "nitrogen", weights->nitrogen);
    json_add_finite(json, "fast", weights->fast);
    json_add_finite(json, "gamma", weights->gamma);
    json_add_finite(json, "other", weights->other);
    return json;
}

void dose_add_accepted(cJSON *json, const struct fit_use *use)
{
    cJSON *accepted = use->acceptance ? cJSON_CreateObject() : cJSON_CreateNull();
    if (use->acceptance) {
        cJSON_AddStringToObject(accepted, "by", use->acceptance->by);
        cJSON_AddStringToObject(accepted, "words", use->acceptance->words);
    }
    cJSON_AddItemToObject(json, "accepted", accepted);
}

/* Whether the dose belongs to the image: {fit, fit_reason, accepted}. */
static void add_fit(cJSON *json, const struct snapshot *snapshot, size_t dose)
{
    char why[FIT_WHY_SIZE];
    const struct fit_use *use = &snapshot->fits.doses[dose];
    struct fit_words words;
    fit_describe(snapshot->plan, (struct fit_part){ FIT_DOSE, dose }, use->with, use->relation,
                 use->state == FIT_USED_BY_WORD, why, &words);
    cJSON_AddStringToObject(json, "fit", fit_relation_word(use->relation));
    cJSON_AddStringToObject(json, "fit_reason", why);
    fit_words_add_json(json, "fit_reason", &words);
    dose_add_accepted(json, use);
}

static void add_parts(cJSON *json, const struct snapshot *snapshot)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    cJSON *parts = cJSON_AddArrayToObject(json, "parts");
    for (size_t i = 0; i <= style->n_sum; i++) {
        double factor = i == 0 ? style->factor : style->sum[i - 1].value.factor;
        int dose = i == 0 ? snapshot->dose : dose_index_of(snapshot->plan, style->sum[i - 1].id);
        if (i > 0 && dose == snapshot->dose) /* chosen by a view of a scene that adds it: it counts once */
            continue;
        cJSON *part = cJSON_CreateObject();
        struct fit_use use = dose < 0 ? (struct fit_use){ .state = FIT_NOT_USED }
                             : i == 0 ? snapshot->fits.doses[dose]
                                      : dose_part_use(snapshot, (size_t)dose, factor);
        char why[FIT_WHY_SIZE] = "the plan has no such dose";
        if (dose >= 0)
            fit_use_sentence(&snapshot->fits, (struct fit_part){ FIT_DOSE, (size_t)dose }, &use, why);
        cJSON_AddStringToObject(part, "id", i == 0 ? snapshot->plan->doses[snapshot->dose].id : style->sum[i - 1].id);
        json_add_finite(part, "factor", factor);
        cJSON_AddBoolToObject(part, "used", fit_is_used(&use));
        reason_add_json(part, "reason", fit_is_used(&use) ? NULL : why);
        dose_add_accepted(part, &use);
        cJSON_AddItemToArray(parts, part);
    }
}

void dose_add_weights(cJSON *json, const struct snapshot *snapshot)
{
    const struct region_set *set = &snapshot->plan->regions;
    cJSON *list = cJSON_AddArrayToObject(json, "weights");
    for (size_t r = 0; r < set->n_regions; r++) {
        const struct scene_tissue_weights *weights = scene_weights_of(snapshot->plan, &snapshot->scene, r);
        if (!weights || !fit_is_used(region_use(&snapshot->fits, r)))
            continue;
        cJSON *row = weights_object(weights, snapshot->scene.dose.blood_ppm);
        cJSON_AddStringToObject(row, "region", set->regions[r].id);
        cJSON_AddItemToArray(list, row);
    }
}

static void add_reference(cJSON *json, const struct snapshot *snapshot, const struct dose_scale *scale)
{
    cJSON *reference = cJSON_AddObjectToObject(json, "reference");
    cJSON_AddStringToObject(reference, "kind",
                            scene_dose_reference_kind_words.words[snapshot->scene.dose.reference.kind]);
    cJSON_AddStringToObject(reference, "words", scale->words);
    json_add_finite(reference, "value", scale->reference);
    reason_add_json(reference, "reason", scale->why_no_reference.code ? scale->why_no_reference.text : NULL);
}

static void add_levels(cJSON *json, const struct snapshot *snapshot, const struct dose_scale *scale)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    cJSON *levels = cJSON_AddArrayToObject(json, "levels");
    for (size_t i = 0; i < style->n_levels; i++) {
        cJSON *level = cJSON_CreateObject();
        double value = dose_level_value(scale, style->levels[i].value.unit, style->levels[i].value.value);
        cJSON_AddStringToObject(level, "id", style->levels[i].id);
        json_add_finite(level, "value", value);
        json_add_finite(level, "percent", 100 * value / scale->reference);
        cJSON_AddItemToArray(levels, level);
    }
}

/* The number of the beams whose doses the scene adds, where these are all of the treatment plan, once each; else 0. */
static size_t n_beams_summed(const struct snapshot *snapshot)
{
    const struct plan *plan = snapshot->plan;
    const struct dose_choice *choice = &snapshot->dose_choice;
    size_t doses[PLAN_MAX_DOSES], n_found = 0,
                                  n = plan_beam_doses(plan, plan->dose_origins[snapshot->dose].treatment_plan, doses);
    if (!snapshot->has_dose_choice || n < 2 || choice->n_parts != n)
        return 0;
    for (size_t p = 0; p < n; p++)
        for (size_t i = 0; i < n; i++)
            n_found += choice->parts[p].dose == doses[i] && fabs(choice->parts[p].factor - 1) < 1e-9;
    return n_found == n ? n : 0;
}

static const char *shown_name(const struct snapshot *snapshot, char name[DOSE_STATED_NAME_SIZE])
{
    size_t n = n_beams_summed(snapshot), n_parts = snapshot->has_dose_choice ? snapshot->dose_choice.n_parts : 1;
    if (n == 0 && n_parts < 2)
        return snapshot->plan->doses[snapshot->dose].name;
    if (n > 0)
        snprintf(name, DOSE_STATED_NAME_SIZE, "Sum of the doses of all %zu beams", n);
    else
        snprintf(name, DOSE_STATED_NAME_SIZE, "Sum of %zu doses", n_parts);
    return name;
}

/* "beam 1 of 2" of a dose of one beam; "" of the sum of all. */
static const char *shown_per(const struct snapshot *snapshot, char per[FIT_PER_SIZE])
{
    const struct part_origin *origin = &snapshot->plan->dose_origins[snapshot->dose];
    if (n_beams_summed(snapshot) > 0)
        return "";
    if (origin->beam == 0 || origin->treatment_plan < 0 || snapshot->dose_choice.n_parts > 1)
        return snapshot->plan->doses[snapshot->dose].per;
    snprintf(per, FIT_PER_SIZE, "beam %zu of %zu", origin->beam,
             snapshot->plan->treatment_plans[origin->treatment_plan].n_beams);
    return per;
}

/* Adds the basis that every read-out of a dose states beside its numbers. snapshot->dose >= 0. */
void dose_add_basis(cJSON *json, const struct snapshot *snapshot, const struct dose_scale *scale)
{
    const struct dose *dose = &snapshot->plan->doses[snapshot->dose];
    const struct scene_dose_style *style = &snapshot->scene.dose;
    char unit[DOSE_UNIT_SIZE], per[FIT_PER_SIZE];
    bool is_whole = strcmp(dose_per_counted(dose, style->factor, per), fit_per(dose, per)) != 0;
    dose_shown_unit(dose,
                    style->quantity == SCENE_DOSE_QUANTITY_WEIGHTED       ? DOSE_SHOWN_WEIGHTED
                    : style->quantity == SCENE_DOSE_QUANTITY_ISOEFFECTIVE ? DOSE_SHOWN_ISOEFFECTIVE
                                                                          : DOSE_SHOWN_QUANTITY,
                    snapshot->dose_choice.quantity, unit);
    cJSON_AddStringToObject(json, "id", dose->id);
    char name[DOSE_STATED_NAME_SIZE], of[FIT_PER_SIZE];
    cJSON_AddStringToObject(json, "name", shown_name(snapshot, name));
    cJSON_AddStringToObject(json, "per", is_whole ? "plan" : shown_per(snapshot, of)); /* counted fractions: the plan */
    cJSON_AddStringToObject(json, "quantity", scene_dose_quantity_words.words[style->quantity]);
    cJSON_AddStringToObject(json, "unit", unit);
    reason_add_json(json, "reason", scale->field ? NULL : scale->why.text);
    add_fit(json, snapshot, (size_t)snapshot->dose);
    add_quantities(json, "missing", scale->field ? scale->field->missing : 0);
    add_parts(json, snapshot);
    cJSON_AddItemToObject(json, "tissue", style->tissue[0] ? cJSON_CreateString(style->tissue) : cJSON_CreateNull());
    json_add_finite(json, "blood_ppm", style->blood_ppm);
    cJSON_AddStringToObject(json, "weights_name", style->weights_name);
    add_reference(json, snapshot, scale);
}

bool dose_is_there(const struct snapshot *snapshot, struct problem *problem)
{
    return snapshot->dose >= 0 || problem_set(problem, PROBLEM_NOT_FOUND, "", "", "the plan has no dose");
}

/* Frees the scale when memory ran out, with a problem. */
static bool is_whole(struct dose_scale *scale, struct problem *problem)
{
    struct error err = { 0 };
    if (dose_scale_is_whole(scale, &err))
        return true;
    dose_scale_finish(scale);
    return problem_from_error(problem, &err);
}

bool dose_asked_of(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity,
                   struct dose_asked *asked, struct error *why)
{
    return dose_asked_in(snapshot, dose, quantity, snapshot->scene.dose.tissue, asked, why);
}

bool dose_asked_in(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity, const char *tissue,
                   struct dose_asked *asked, struct error *why)
{
    asked->dose = dose;
    if (!(dose == (size_t)snapshot->dose ? dose_choice_in(snapshot, dose, quantity, tissue, &asked->choice, why)
                                         : dose_choice_compared(snapshot, dose, quantity, tissue, &asked->choice, why)))
        return false;
    dose_shown_unit(&snapshot->plan->doses[asked->choice.unit_of], asked->choice.shown, asked->choice.quantity,
                    asked->unit);
    return true;
}

struct snapshot *dose_snapshot_of(const struct snapshot *snapshot, const char *word, struct problem *problem)
{
    struct snapshot *copy = mem_new(sizeof *copy);
    *copy = *snapshot;
    if (!word || !word[0])
        return copy;
    struct dose_asked asked;
    if (!dose_quantity_from_scene_word(word, &copy->scene.dose.quantity)) {
        (void)problem_set(problem, PROBLEM_VALIDATION, "/quantity", "enum", "\"%.40s\" is no quantity", word);
        free(copy);
        return NULL;
    }
    copy->dose_why = (struct error){ 0 };
    copy->has_dose_choice = dose_asked_of(copy, (size_t)copy->dose, copy->scene.dose.quantity, &asked, &copy->dose_why);
    copy->dose_choice = asked.choice;
    return copy;
}

struct snapshot *dose_snapshot_in(const struct snapshot *snapshot, const char *word, const char *tissue,
                                  struct problem *problem)
{
    struct snapshot *copy = dose_snapshot_of(snapshot, word, problem);
    struct dose_asked asked;
    if (!copy)
        return NULL;
    if (tissue[0] && !region_find(&copy->plan->regions, tissue)) {
        (void)problem_set(problem, PROBLEM_NOT_FOUND, "/tissue", "", "the plan has no region \"%.64s\"", tissue);
        free(copy);
        return NULL;
    }
    if (strcmp(copy->scene.dose.tissue, tissue) == 0)
        return copy;
    snprintf(copy->scene.dose.tissue, sizeof copy->scene.dose.tissue, "%s", tissue);
    copy->dose_why = (struct error){ 0 };
    copy->has_dose_choice = dose_asked_of(copy, (size_t)copy->dose, copy->scene.dose.quantity, &asked, &copy->dose_why);
    copy->dose_choice = asked.choice;
    return copy;
}

void dose_add_population(cJSON *json, const struct snapshot *snapshot, const struct dose_choice *choice,
                         const char *tissue, enum region_population population)
{
    char words[96];
    json_add_text(json, "basis", dose_basis_words(snapshot->plan, choice, tissue, words));
    cJSON_AddStringToObject(json, "population", population == POPULATION_OWN ? "own" : "whole");
}

/* {id, name, per, quantity, unit, drawn, reason, fit, fit_reason, accepted, missing, parts: [{id, factor, used, ...}],
 * tissue, blood_ppm, weights_name, reference: {kind, words, value, reason}, weights: [{region, ...}], levels: [{id,
 * value, percent}], resampled} */
cJSON *answer_dose(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    struct dose_scale scale;
    (void)derived;
    if (!dose_is_there(snapshot, problem))
        return NULL;
    bool is_drawn = dose_scale_of(snapshot, &scale);
    if (!is_whole(&scale, problem))
        return NULL;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddBoolToObject(json, "drawn", is_drawn);
    dose_add_basis(json, snapshot, &scale);
    dose_add_weights(json, snapshot);
    add_levels(json, snapshot, &scale);
    cJSON_AddBoolToObject(json, "resampled", scale.field && scale.field->is_resampled);
    dose_scale_finish(&scale);
    return json;
}

/* The value of a quantity of the scene's dose at a point, and the row of weights it has there. NAN with why: none. */
static double value_at(const struct snapshot *snapshot, enum scene_dose_quantity quantity, struct vec3 point,
                       const char **why)
{
    struct dose_choice choice;
    struct error err = { 0 };
    double value = NAN;
    *why = NULL;
    if (!dose_choice_of(snapshot, (size_t)snapshot->dose, quantity, &choice, &err)) {
        *why = err.code == ERROR_STATE ? "the dose is not used" : "not in this dose";
        return NAN;
    }
    struct dose_field *field = dose_field_get(snapshot->derived, &choice, &err);
    uint32_t at[3];
    if (!field)
        *why = "not computed";
    else if (!volume_voxel_at(field->rows[0], point, at))
        *why = "outside the dose grid";
    else if (dose_field_row(field, point) == DOSE_NO_ROW)
        *why = "in no tissue with weights";
    else if (!dose_field_value(field, point, &value))
        *why = "no value in the dose's file here";
    if (field)
        derive_result_unref(&field->base);
    return *why ? NAN : value;
}

/* The innermost region at the point whose weights hold there; -1: none. */
static int tissue_at(const struct snapshot *snapshot, const struct plan_probe *probe)
{
    const struct region_set *set = &snapshot->plan->regions;
    if (snapshot->scene.dose.tissue[0]) {
        const struct region *region = region_find(set, snapshot->scene.dose.tissue);
        return region ? (int)(region - set->regions) : -1;
    }
    for (size_t i = 0; i < probe->n_regions; i++)
        if (scene_weights_of(snapshot->plan, &snapshot->scene, probe->regions[i]))
            return (int)probe->regions[i];
    return -1;
}

/* NAN: the quantity is no summand, or weights is NULL: the tissue has none. */
static double weight_in(const struct scene_tissue_weights *weights, enum dose_quantity quantity)
{
    if (!weights)
        return NAN;
    struct tissue_weights of = tissue_weights_of(weights);
    return dose_weight_of(quantity, &of);
}

/* Statistical error of a component's value at a point, as a part of it; NAN: the files give none. */
static double error_share(const struct dose_component *component, struct vec3 point)
{
    double value, error;
    return component->error && volume_sample(component->values, point, &value) && value > 0 &&
                   volume_sample(component->error, point, &error)
               ? error / value
               : NAN;
}

/* Error of the shown value as a share of it. A sum's components count as independent; one without an error makes it
 * unknown. */
static double shown_error_share(const struct snapshot *snapshot, struct vec3 point,
                                const struct scene_tissue_weights *weights)
{
    const struct dose *dose = &snapshot->plan->doses[snapshot->dose];
    const struct dose_choice *choice = &snapshot->dose_choice;
    double sum = 0, squares = 0;
    if (!snapshot->has_dose_choice || choice->n_parts > 1 || choice->shown == DOSE_SHOWN_ISOEFFECTIVE)
        return NAN;
    if (!dose_is_summed(dose, choice->shown, choice->quantity)) {
        const struct dose_component *component = dose_component_of(dose, choice->quantity);
        return component ? error_share(component, point) : NAN;
    }
    for (size_t c = 0; c < dose->n_components; c++) {
        const struct dose_component *component = &dose->components[c];
        const char *why;
        enum scene_dose_quantity quantity;
        if (!dose_is_summand(component->quantity) ||
            !dose_quantity_from_scene_word(dose_quantity_word(component->quantity), &quantity))
            continue;
        double weight = choice->shown == DOSE_SHOWN_WEIGHTED ? weight_in(weights, component->quantity) : 1,
               value = value_at(snapshot, quantity, point, &why) * weight;
        sum += value;
        squares += value > 0 || isnan(value) ? pow(value * error_share(component, point), 2) : 0;
    }
    return sqrt(squares) / sum;
}

/* Every quantity of the dose at the point: as it is in the tissue, without and with its weight. */
static void add_components(cJSON *json, const struct snapshot *snapshot, struct vec3 point,
                           const struct scene_tissue_weights *weights)
{
    const struct dose *dose = &snapshot->plan->doses[snapshot->dose];
    cJSON *list = cJSON_AddArrayToObject(json, "components");
    for (size_t c = 0; c < dose->n_components; c++) {
        const struct dose_component *component = &dose->components[c];
        enum scene_dose_quantity quantity;
        char unit[DOSE_UNIT_SIZE];
        const char *why = NULL;
        if (!dose_quantity_from_scene_word(dose_quantity_word(component->quantity), &quantity))
            continue;
        cJSON *item = cJSON_CreateObject();
        double value = value_at(snapshot, quantity, point, &why), weight = weight_in(weights, component->quantity);
        dose_unit_of(dose, component->quantity, unit);
        cJSON_AddStringToObject(item, "quantity", dose_quantity_word(component->quantity));
        json_add_finite(item, "value", value);
        cJSON_AddStringToObject(item, "unit", unit);
        reason_add_json(item, "reason", why);
        bool is_boron = component->quantity == DOSE_BORON && component->is_per_ppm;
        json_add_finite(item, "boron_ppm",
                        component->is_per_ppm
                            ? snapshot->scene.dose.blood_ppm * (is_boron ? weights ? weights->boron_ratio : NAN : 1)
                        : component->has_boron_ppm ? component->boron_ppm
                                                   : NAN);
        json_add_finite(item, "weight", weight);
        json_add_finite(item, "weighted", value * weight);
        json_add_finite(item, "error_percent", isnan(value) ? NAN : 100 * error_share(component, point));
        cJSON_AddItemToArray(list, item);
    }
}

static void add_place(cJSON *json, const struct plan *plan, const struct plan_probe *probe)
{
    cJSON *regions = cJSON_AddArrayToObject(json, "regions"), *images = cJSON_AddArrayToObject(json, "images");
    for (size_t i = 0; i < probe->n_regions; i++)
        cJSON_AddItemToArray(regions, cJSON_CreateString(plan->regions.regions[probe->regions[i]].id));
    for (size_t i = 0; i < plan->n_images; i++) {
        if (!probe->has_image[i])
            continue;
        cJSON *image = cJSON_CreateObject();
        cJSON_AddStringToObject(image, "id", plan->images[i].id);
        json_add_finite(image, "value", probe->image_value[i]);
        cJSON_AddStringToObject(image, "unit", plan->images[i].unit);
        cJSON_AddItemToArray(images, image);
    }
}

/* {point_lps_mm, regions, images, id, name, per, quantity, unit, ..., value, percent, value_reason, weighted_by,
 * weights, components: [{quantity, value, unit, reason, boron_ppm, weight, weighted}], totals: [{quantity, value, unit,
 * reason}]}
 */
cJSON *answer_dose_probe(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct plan *plan = snapshot->plan;
    const struct vec3 at = question->packet.dose_probe.point_lps_mm;
    struct dose_scale scale;
    struct plan_probe probe;
    const char *why = NULL;
    (void)derived;
    if (!dose_is_there(snapshot, problem))
        return NULL;
    (void)dose_scale_of(snapshot, &scale);
    if (!is_whole(&scale, problem))
        return NULL;
    scene_probe(snapshot, at, &probe);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddItemToObject(json, "point_lps_mm", cJSON_CreateDoubleArray((double[3]){ at.x, at.y, at.z }, 3));
    add_place(json, plan, &probe);
    dose_add_basis(json, snapshot, &scale);
    double value = value_at(snapshot, snapshot->scene.dose.quantity, at, &why);
    json_add_finite(json, "value", value);
    json_add_finite(json, "percent", 100 * value / scale.reference);
    reason_add_json(json, "value_reason", why);
    int tissue = tissue_at(snapshot, &probe);
    const struct scene_tissue_weights *weights =
        tissue >= 0 ? scene_weights_of(plan, &snapshot->scene, (size_t)tissue) : NULL;
    json_add_text(json, "weighted_by", weights ? plan->regions.regions[tissue].id : NULL);
    cJSON_AddItemToObject(json, "weights",
                          weights ? weights_object(weights, snapshot->scene.dose.blood_ppm) : cJSON_CreateNull());
    json_add_finite(json, "error_percent", 100 * shown_error_share(snapshot, at, weights));
    add_components(json, snapshot, at, weights);
    static const enum scene_dose_quantity totals[] = { SCENE_DOSE_QUANTITY_WEIGHTED, SCENE_DOSE_QUANTITY_TOTAL,
                                                       SCENE_DOSE_QUANTITY_ISOEFFECTIVE };
    cJSON *list = cJSON_AddArrayToObject(json, "totals");
    for (size_t i = 0; i < sizeof totals / sizeof *totals; i++) {
        struct dose_choice choice;
        struct error err = { 0 };
        char unit[DOSE_UNIT_SIZE];
        if (!dose_choice_of(snapshot, (size_t)snapshot->dose, totals[i], &choice, &err))
            continue;
        cJSON *item = cJSON_CreateObject();
        dose_shown_unit(&plan->doses[snapshot->dose], choice.shown, choice.quantity, unit);
        cJSON_AddStringToObject(item, "quantity", scene_dose_quantity_words.words[totals[i]]);
        json_add_finite(item, "value", value_at(snapshot, totals[i], at, &why));
        cJSON_AddStringToObject(item, "unit", unit);
        reason_add_json(item, "reason", why);
        cJSON_AddItemToArray(list, item);
    }
    dose_scale_finish(&scale);
    return json;
}
