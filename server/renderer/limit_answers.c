/* Answers to questions that hold a dose to limits: a region's coverage, and the scene's constraints. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/derive/dose_histogram.h"
#include "core/dose/dvh_metrics.h"
#include "core/scene/dose_coverage_choice.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"

/* ---- coverage --------------------------------------------------------------------------------------------------- */

/* The scene's coverage, with what the question says instead. */
static bool merge_coverage(const struct packet_coverage *packet, struct scene_dose_coverage *coverage,
                           const struct plan *plan, struct problem *problem)
{
    if (packet->region[0]) {
        if (!region_find(&plan->regions, packet->region))
            return problem_set(problem, PROBLEM_NOT_FOUND, "/region", "", "the plan has no region \"%.64s\"",
                               packet->region);
        snprintf(coverage->region, sizeof coverage->region, "%.63s", packet->region);
    }
    if (packet->has_low || packet->has_high) {
        coverage->has_low = packet->has_low;
        coverage->has_high = packet->has_high;
        coverage->low = packet->low;
        coverage->high = packet->high;
    }
    if (packet->unit[0] && strcmp(packet->unit, "percent") != 0 && strcmp(packet->unit, "dose") != 0)
        return problem_set(problem, PROBLEM_VALIDATION, "/unit", "enum", "\"%.40s\" is not percent or dose",
                           packet->unit);
    if (packet->unit[0])
        coverage->unit = strcmp(packet->unit, "dose") == 0 ? SCENE_DOSE_UNIT_DOSE : SCENE_DOSE_UNIT_PERCENT;
    return true;
}

static void add_coverage(cJSON *json, const struct snapshot *snapshot, const struct dose_scale *scale)
{
    struct dose_coverage_choice choice;
    struct dose_coverage *coverage = NULL;
    struct error why = scale->why;
    bool has_choice = scale->field && dose_coverage_choice_of(snapshot, scale, &choice, &why);
    if (has_choice)
        coverage = dose_coverage_get(snapshot->derived, &choice, &why);
    const struct region *region = has_choice ? &snapshot->plan->regions.regions[choice.region] : NULL;
    double cm3 = coverage ? grid_voxel_mm3(&coverage->labels->grid) / 1e3 : NAN;
    json_add_text(json, "region", region ? region->id : NULL);
    json_add_finite(json, "low", has_choice ? choice.low : NAN);
    json_add_finite(json, "high", has_choice ? choice.high : NAN);
    bool is_partial = coverage && dvh_is_partial(&(struct dvh){ .n = (double)(coverage->n_region - coverage->n_without),
                                                                .n_missing = (double)coverage->n_without });
    dose_add_population(json, snapshot, has_choice ? &choice.dose : &(struct dose_choice){ .n_parts = 0 },
                        snapshot->scene.dose.coverage.tissue, scene_population(snapshot->plan, &snapshot->scene));
    json_add_finite(json, "volume_cm3", coverage ? coverage->volume_cm3 : NAN);
    json_add_finite(json, "share", coverage && !is_partial ? coverage->least_share : NAN);
    json_add_finite(json, "share_least", coverage ? coverage->least_share : NAN);
    json_add_finite(json, "share_most", coverage ? coverage->most_share : NAN);
    json_add_finite(json, "region_cm3", coverage ? (double)coverage->n_region * cm3 : NAN);
    json_add_finite(json, "missing_cm3", coverage ? (double)coverage->n_without * cm3 : NAN);
    reason_add_json(json, "coverage_reason", coverage ? NULL : why.text);
    cJSON_AddStringToObject(json, "method",
                            "Univels of the population, with the weights of the region; the dose at a univel's centre, "
                            "trilinear in the dose's own grid; low <= value < high. share is a part of all of them.");
    if (coverage)
        derive_result_unref(&coverage->base);
}

/* Answers the dose's basis and {region, low, high (in the unit), volume_cm3, share, region_cm3, missing_cm3,
 * coverage_reason, method} */
cJSON *answer_coverage(struct question *question, struct derive *derived, struct problem *problem)
{
    struct dose_scale scale;
    (void)derived;
    if (!dose_is_there(question->snapshot, problem))
        return NULL;
    struct snapshot *snapshot = dose_snapshot_of(question->snapshot, NULL, problem);
    cJSON *json = NULL;
    if (snapshot &&
        merge_coverage(&question->packet.coverage, &snapshot->scene.dose.coverage, snapshot->plan, problem)) {
        json = cJSON_CreateObject();
        (void)dose_scale_of(snapshot, &scale);
        dose_add_basis(json, snapshot, &scale);
        add_coverage(json, snapshot, &scale);
        dose_scale_finish(&scale);
    }
    free(snapshot);
    return json;
}

/* ---- constraints ------------------------------------------------------------------------------------------------ */

const char *dose_metric_unit(const struct dvh_metric *metric, const char *dose_unit)
{
    switch (metric->kind) {
    case DVH_VOLUME_PERCENT: return "%";
    case DVH_VOLUME_CC: return "cm3";
    case DVH_HOMOGENEITY: return "";
    default: return dose_unit;
    }
}

static bool is_met(const struct scene_constraint *constraint, double value)
{
    return constraint->side == SCENE_LIMIT_SIDE_AT_MOST ? value <= constraint->limit : value >= constraint->limit;
}

bool dose_is_counted(const struct snapshot *snapshot, size_t region, struct error *why)
{
    const struct scene_fits *fits = &snapshot->fits;
    if (snapshot->plan->regions.regions[region].n_voxels == 0)
        return error_set(why, ERROR_NOT_FOUND, "the region has no univels");
    if (fit_is_used(region_use(fits, region)))
        return true;
    char sentence[FIT_WHY_SIZE];
    fit_use_sentence(fits, fit_part_of_region(snapshot->plan, region), region_use(fits, region), sentence);
    return error_set(why, ERROR_STATE, "%s", sentence);
}

/* The figure's bounds; false with why: nothing can be said. */
static bool find_figure(const struct snapshot *snapshot, const struct scene_constraint *constraint,
                        const struct dose_asked *asked, const struct dvh_metric *metric, struct dvh *dvh, double *least,
                        double *most, struct error *why)
{
    const struct region_set *set = &snapshot->plan->regions;
    const struct region *region = region_find(set, constraint->region);
    if (!region)
        return error_set(why, ERROR_NOT_FOUND, "no region is chosen");
    if (!dose_is_counted(snapshot, (size_t)(region - set->regions), why))
        return false;
    if (!dose_histogram_get(snapshot->derived, &asked->choice, (size_t)(region - set->regions),
                            scene_population(snapshot->plan, &snapshot->scene), DOSE_BY_REGION, 1, dvh, why))
        return false;
    dvh_metric_range(dvh, metric, least, most);
    if (!(dvh->n > 0))
        return error_set(why, ERROR_NOT_FOUND, "the dose has no value in the region");
    if (isnan(*least) || isnan(*most))
        return error_set(why, ERROR_RANGE, "the region is smaller than that");
    return is_met(constraint, *least) == is_met(constraint, *most) ||
           error_set(why, ERROR_NOT_FOUND, "%.3g %% of the region have no dose",
                     100 * dvh->n_missing / (dvh->n + dvh->n_missing));
}

/* Fills tissue, basis, population, value, its bounds, unit, met and, where nothing can be said, why. */
static void add_verdict(cJSON *json, const struct snapshot *snapshot, const struct scene_constraint *constraint)
{
    struct dose_asked asked = { .unit = "" };
    struct dvh_metric metric = { 0 };
    struct dvh dvh = { 0 };
    struct error why = { 0 };
    double least = NAN, most = NAN;
    bool is_known =
        dvh_metric_parse(constraint->metric, &metric, &why) &&
        dose_asked_in(snapshot, (size_t)snapshot->dose, constraint->quantity, constraint->tissue, &asked, &why) &&
        find_figure(snapshot, constraint, &asked, &metric, &dvh, &least, &most, &why);
    cJSON_AddItemToObject(json, "tissue",
                          constraint->tissue[0] ? cJSON_CreateString(constraint->tissue) : cJSON_CreateNull());
    dose_add_population(json, snapshot, &asked.choice, constraint->tissue,
                        scene_population(snapshot->plan, &snapshot->scene));
    json_add_finite(json, "value", least == most ? least : NAN);
    json_add_finite(json, "least", least);
    json_add_finite(json, "most", most);
    cJSON_AddStringToObject(json, "unit", dose_metric_unit(&metric, asked.unit));
    cJSON_AddItemToObject(json, "met", is_known ? cJSON_CreateBool(is_met(constraint, least)) : cJSON_CreateNull());
    reason_add_json(json, "reason", is_known ? NULL : why.text);
    json_add_finite(json, "volume_cm3", (dvh.n + dvh.n_missing) * dvh.univel_cm3);
    json_add_finite(json, "missing_cm3", dvh.n_missing * dvh.univel_cm3);
    dvh_finish(&dvh);
}

/* Answers the dose's basis and {method, constraints: [{id, region, quantity, metric, side, limit, tissue, basis,
 * population, value, least, most, unit, met, reason, volume_cm3, missing_cm3}]} */
cJSON *answer_constraints(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct scene *scene = &snapshot->scene;
    struct dose_scale scale;
    (void)derived;
    if (!dose_is_there(snapshot, problem))
        return NULL;
    cJSON *json = cJSON_CreateObject();
    (void)dose_scale_of(snapshot, &scale);
    dose_add_basis(json, snapshot, &scale);
    dose_add_weights(json, snapshot);
    dose_scale_finish(&scale);
    cJSON_AddStringToObject(
        json, "method",
        "Univels of the population, each with the dose at its centre and the weights of its region, or "
        "those chosen in the limit; how the dose is drawn changes nothing. met is null where "
        "univels without a dose, 0.1 % of the region and more, could decide.");
    cJSON *list = cJSON_AddArrayToObject(json, "constraints");
    for (size_t i = 0; i < scene->n_constraints; i++) {
        const struct scene_constraint *constraint = &scene->constraints[i].value;
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "id", scene->constraints[i].id);
        cJSON_AddStringToObject(row, "region", constraint->region);
        cJSON_AddStringToObject(row, "quantity", dose_quantity_scene_word(constraint->quantity));
        cJSON_AddStringToObject(row, "metric", constraint->metric);
        cJSON_AddStringToObject(row, "side", scene_limit_side_words.words[constraint->side]);
        json_add_finite(row, "limit", constraint->limit);
        add_verdict(row, snapshot, constraint);
        cJSON_AddItemToArray(list, row);
    }
    return json;
}
