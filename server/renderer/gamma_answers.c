/* Answers the question how two doses compare: gamma index and difference. */
#include <math.h>
#include <stdio.h>

#include "core/scene/dose_compare.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"
#include "wire_gen.h"

static void add_gamma(cJSON *json, const struct dose_comparison *comparison, double most)
{
    const struct gamma_facts *facts = comparison ? &comparison->gamma : NULL;
    bool has_any = facts && facts->n > 0;
    json_add_finite(json, "voxels", facts ? (double)facts->n : NAN);
    json_add_finite(json, "passed", facts ? (double)facts->n_passed : NAN);
    json_add_finite(json, "pass_percent", has_any ? 100 * (double)facts->n_passed / (double)facts->n : NAN);
    json_add_finite(json, "mean", has_any ? facts->mean : NAN);
    json_add_finite(json, "max", has_any ? facts->max : NAN);
    cJSON *left_out = cJSON_AddObjectToObject(json, "left_out");
    json_add_finite(left_out, "outside", comparison ? (double)comparison->n_outside : NAN);
    json_add_finite(left_out, "below", facts ? (double)facts->n_below : NAN);
    json_add_finite(left_out, "without", facts ? (double)facts->n_without : NAN);
    cJSON *histogram = cJSON_AddObjectToObject(json, "histogram");
    json_add_finite(histogram, "width", most / GAMMA_BINS);
    cJSON *counts = cJSON_AddArrayToObject(histogram, "counts");
    for (size_t i = 0; facts && i < GAMMA_BINS; i++)
        cJSON_AddItemToArray(counts, cJSON_CreateNumber((double)facts->bins[i]));
}

static void add_difference(cJSON *json, const struct dose_comparison *comparison)
{
    cJSON *difference = cJSON_AddObjectToObject(json, "difference");
    json_add_text(difference, "unit", comparison ? comparison->unit : NULL);
    json_add_finite(difference, "voxels", comparison ? (double)comparison->n : NAN);
    json_add_finite(difference, "without", comparison ? (double)comparison->n_without : NAN);
    json_add_finite(difference, "mean", comparison ? comparison->mean : NAN);
    json_add_finite(difference, "root_mean_square", comparison ? comparison->root_mean_square : NAN);
    json_add_finite(difference, "low", comparison ? comparison->low : NAN);
    json_add_finite(difference, "high", comparison ? comparison->high : NAN);
}

/* {kind, words, voxels, all_voxels} of the difference, which the gamma index shares. */
static void add_domain(cJSON *json, const struct snapshot *snapshot, const struct dose_comparison_choice *choice,
                       const struct dose_comparison *comparison)
{
    char words[REGION_NAME_SIZE + 32] = "the whole grid of the first dose";
    cJSON *domain = cJSON_AddObjectToObject(json, "domain");
    if (choice->is_in_body)
        body_words(&snapshot->plan->regions, &choice->body, words);
    cJSON_AddStringToObject(domain, "kind", choice->is_in_body ? "body" : "grid");
    cJSON_AddStringToObject(domain, "words", words);
    json_add_finite(domain, "voxels", comparison ? (double)(comparison->n_domain - comparison->n_below) : NAN);
    json_add_finite(domain, "all_voxels", comparison ? (double)comparison->n_domain : NAN);
}

static void add_method(cJSON *json, const struct scene_dose_compare *asked, bool is_in_body, const char *reference)
{
    bool is_local = asked->normalization == SCENE_GAMMA_NORMALIZATION_LOCAL;
    char text[512];
    snprintf(text, sizeof text,
             "Gamma index (Low et al. 1998), %s: %g %% of %s, %g mm; at the voxels of the first dose %sof at least %g "
             "%% of the reference (%s), the difference likewise; the second dose tri-linear between its voxels.",
             is_local ? "local" : "global", asked->dose_percent, is_local ? "the first dose at the voxel" : reference,
             asked->distance_mm, is_in_body ? "in the body " : "", asked->threshold_percent, reference);
    cJSON_AddStringToObject(json, "method", text);
}

/* Answers the dose's basis and {weights, second, dose_percent, distance_mm, normalization, threshold, voxels, passed,
 * pass_percent, mean, max, left_out, histogram, difference, method, comparison_reason} */
cJSON *answer_gamma(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct scene_dose_compare *asked = &snapshot->scene.dose.compare;
    struct dose_comparison_choice index = { 0 }, difference = { 0 };
    struct dose_comparison *comparisons[2] = { NULL, NULL };
    struct dose_scale scale;
    struct error why = { 0 };
    if (!dose_is_there(snapshot, problem))
        return NULL;
    (void)dose_scale_of(snapshot, &scale);
    if (dose_compare_of(snapshot, &scale, false, &difference, &why) &&
        (comparisons[1] = dose_comparison_get(derived, &difference, &why)) &&
        dose_compare_of(snapshot, &scale, true, &index, &why))
        comparisons[0] = dose_comparison_get(derived, &index, &why);
    cJSON *json = NULL;
    if (why.code == ERROR_MEMORY)
        (void)problem_set(problem, PROBLEM_MEMORY, "", "", "%s", why.text);
    else {
        json = cJSON_CreateObject();
        dose_add_basis(json, snapshot, &scale);
        dose_add_weights(json, snapshot);
        json_add_text(json, "second", asked->id[0] ? asked->id : NULL);
        json_add_finite(json, "dose_percent", asked->dose_percent);
        json_add_finite(json, "distance_mm", asked->distance_mm);
        cJSON_AddStringToObject(json, "normalization", scene_gamma_normalization_words.words[asked->normalization]);
        json_add_finite(json, "threshold", scale.reference * asked->threshold_percent / 100);
        add_domain(json, snapshot, &difference, comparisons[1]);
        add_gamma(json, comparisons[0], index.gamma.most);
        add_difference(json, comparisons[1]);
        add_method(json, asked, difference.is_in_body, scale.words);
        reason_add_json(json, "comparison_reason", why.code ? why.text : NULL);
    }
    for (int i = 0; i < 2; i++)
        if (comparisons[i])
            derive_result_unref(&comparisons[i]->base);
    dose_scale_finish(&scale);
    return json;
}
