/* Answers which parts of the plan a scene uses together. */
#include <string.h>

#include "core/scene/snapshot.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"

static void add_use(cJSON *parts, const struct scene_fits *fits, struct fit_part thing, const struct fit_use *use)
{
    char word[FIT_PART_SIZE], why[FIT_WHY_SIZE];
    struct fit_words words;
    bool is_alone = thing.kind == use->with.kind && thing.index == use->with.index;
    struct fit fit = is_alone ? fit_alone(fits->plan, thing) : fit_of(fits->plan, thing, use->with);
    cJSON *object = cJSON_CreateObject();
    fit_part_write(fits->plan, thing, word);
    cJSON_AddStringToObject(object, "thing", word);
    fit_part_write(fits->plan, use->with, word);
    cJSON_AddStringToObject(object, "with", word);
    cJSON_AddStringToObject(object, "state", fit_state_word(use->state));
    cJSON_AddStringToObject(object, "relation", fit_relation_word(use->relation));
    fit_describe(fits->plan, thing, use->with, use->relation, use->state == FIT_USED_BY_WORD, why, &words);
    cJSON_AddStringToObject(object, "reason", why);
    fit_words_add_json(object, "reason", &words);
    cJSON_AddStringToObject(object, "needs",
                            fit_needs_word(use->state == FIT_USED ? FIT_NEEDS_NOTHING
                                           : fit_needs_of(use->relation) == FIT_NEEDS_NEVER ||
                                                   fit_pair_needs(&fit) == FIT_NEEDS_NEVER
                                               ? FIT_NEEDS_NEVER
                                               : FIT_NEEDS_ACCEPTANCE));
    json_add_text(object, "by", use->acceptance ? use->acceptance->by : NULL);
    json_add_text(object, "words", use->acceptance ? use->acceptance->words : NULL);
    cJSON_AddItemToArray(parts, object);
}

/* The doses that are added to the one shown, and the one that it is compared with. */
static void add_joined(cJSON *parts, const struct snapshot *snapshot)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    for (size_t i = 0; i < style->n_sum; i++) {
        int dose = dose_index_of(snapshot->plan, style->sum[i].id);
        if (dose < 0 || dose == snapshot->dose)
            continue;
        struct fit_use use = dose_part_use(snapshot, (size_t)dose, style->sum[i].value.factor);
        add_use(parts, &snapshot->fits, (struct fit_part){ FIT_DOSE, (size_t)dose }, &use);
    }
    int second = style->compare.id[0] ? dose_index_of(snapshot->plan, style->compare.id) : -1;
    if (second >= 0 && second != snapshot->dose) {
        struct fit_use use = dose_compared_use(snapshot, (size_t)second);
        add_use(parts, &snapshot->fits, (struct fit_part){ FIT_DOSE, (size_t)second }, &use);
    }
}

/* {image, blend, dose, parts: [{thing, with, state, relation, reason, needs, by, words}]} */
cJSON *answer_fits(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct scene_fits *fits = &snapshot->fits;
    const struct plan *plan = snapshot->plan;
    (void)derived;
    (void)problem;
    cJSON *json = cJSON_CreateObject();
    json_add_text(json, "image", snapshot->image >= 0 ? plan->images[snapshot->image].id : NULL);
    json_add_text(json, "blend", fits->blend >= 0 ? plan->images[fits->blend].id : NULL);
    json_add_text(json, "dose", snapshot->dose >= 0 ? plan->doses[snapshot->dose].id : NULL);
    cJSON *parts = cJSON_AddArrayToObject(json, "parts");
    for (size_t i = 0; i < plan->n_images; i++)
        add_use(parts, fits, (struct fit_part){ FIT_IMAGE, i }, &fits->beside[i]);
    for (size_t i = 0; i < plan->n_doses; i++)
        add_use(parts, fits, (struct fit_part){ FIT_DOSE, i }, &fits->doses[i]);
    for (size_t i = 0; i < plan->n_beams; i++)
        add_use(parts, fits, (struct fit_part){ FIT_BEAM, i }, &fits->beams[i]);
    for (size_t i = 0; i <= plan->n_region_origins; i++) {
        bool has_regions = false;
        for (size_t r = 0; r < plan->regions.n_regions && !has_regions; r++)
            has_regions = fit_part_of_region(plan, r).index == i;
        if (has_regions)
            add_use(parts, fits, (struct fit_part){ FIT_REGIONS, i }, &fits->regions[i]);
    }
    if (plan->tracks.n_segments)
        add_use(parts, fits, (struct fit_part){ FIT_TRACKS, 0 }, &fits->tracks);
    if (snapshot->dose >= 0)
        add_joined(parts, snapshot);
    return json;
}
