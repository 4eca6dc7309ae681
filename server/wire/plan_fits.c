/* Writes which parts of a plan fit each other. */
#include "server/wire/plan_fits.h"

#include "server/wire/sentence_json.h"

static void add_pair(cJSON *fits, const struct plan *plan, struct fit_part thing, struct fit_part with)
{
    bool is_alone = thing.kind == with.kind && thing.index == with.index;
    struct fit fit = is_alone ? fit_alone(plan, thing) : fit_of(plan, thing, with);
    enum fit_needs needs = fit_pair_needs(&fit);
    char word[FIT_PART_SIZE], why[FIT_WHY_SIZE];
    struct fit_words words;
    if (with.kind == FIT_DOSE && needs == FIT_NEEDS_NOTHING)
        return;
    cJSON *object = cJSON_CreateObject(), *reasons = cJSON_CreateArray();
    fit_part_write(plan, thing, word);
    json_add(object, "thing", cJSON_CreateString(word));
    fit_part_write(plan, with, word);
    json_add(object, "with", cJSON_CreateString(word));
    json_add(object, "relation", cJSON_CreateString(fit_relation_word(fit.relation)));
    for (int r = FIT_N_RELATIONS - 1; r >= 0; r--)
        if (fit.reasons >> r & 1)
            json_append(reasons, cJSON_CreateString(fit_relation_word((enum fit_relation)r)));
    json_add(object, "reasons", reasons);
    fit_describe(plan, thing, with, fit.relation, false, why, &words);
    json_add(object, "reason", cJSON_CreateString(why));
    fit_words_add_json(object, "reason", &words);
    json_add(object, "needs", cJSON_CreateString(fit_needs_word(needs)));
    json_append(fits, object);
}

/* True if the plan has regions of this source. */
static bool has_regions(const struct plan *plan, size_t source)
{
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        if (fit_part_of_region(plan, r).index == source)
            return true;
    return false;
}

static void add_pairs(cJSON *fits, const struct plan *plan, struct fit_part with)
{
    for (size_t i = 0; with.kind == FIT_IMAGE && i < plan->n_images; i++)
        if (i != with.index)
            add_pair(fits, plan, (struct fit_part){ FIT_IMAGE, i }, with);
    for (size_t i = 0; i < plan->n_doses; i++)
        if (with.kind != FIT_DOSE || i != with.index || plan->n_images == 0)
            add_pair(fits, plan, (struct fit_part){ FIT_DOSE, i }, with);
    for (size_t i = 0; i < plan->n_beams; i++)
        add_pair(fits, plan, (struct fit_part){ FIT_BEAM, i }, with);
    for (size_t i = 0; i <= plan->n_region_origins; i++)
        if (has_regions(plan, i))
            add_pair(fits, plan, (struct fit_part){ FIT_REGIONS, i }, with);
    if (plan->tracks.n_segments)
        add_pair(fits, plan, (struct fit_part){ FIT_TRACKS, 0 }, with);
}

cJSON *plan_fits_array(const struct plan *plan)
{
    cJSON *fits = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_images; i++)
        add_pairs(fits, plan, (struct fit_part){ FIT_IMAGE, i });
    for (size_t i = 0; i < plan->n_doses; i++)
        add_pairs(fits, plan, (struct fit_part){ FIT_DOSE, i });
    return fits;
}
