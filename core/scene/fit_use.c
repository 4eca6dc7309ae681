/* Decides which parts of a plan a scene uses together. */
#include "core/scene/fit_use.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

const char *fit_state_word(enum fit_state state)
{
    static const char *const words[] = { "used", "not-used", "by-word" };
    return words[state];
}

void acceptances_finish(struct acceptances *acceptances)
{
    free(acceptances->items);
    *acceptances = (struct acceptances){ 0 };
}

bool acceptances_copy(const struct acceptances *from, struct acceptances *to, struct error *err)
{
    *to = (struct acceptances){ 0 };
    if (!from || from->n == 0)
        return true;
    to->items = mem_array(from->n, sizeof *to->items, UINT64_MAX, err);
    if (!to->items)
        return false;
    memcpy(to->items, from->items, from->n * sizeof *to->items);
    to->n = from->n;
    return true;
}

/* That of the pair, whichever of the two it names first. */
static const struct acceptance *acceptance_of(const struct scene_fits *fits, struct fit_part thing,
                                              struct fit_part with)
{
    char words[2][FIT_PART_SIZE];
    if (fits->acceptances.n == 0)
        return NULL;
    fit_part_write(fits->plan, thing, words[0]);
    fit_part_write(fits->plan, with, words[1]);
    for (size_t i = 0; i < fits->acceptances.n; i++) {
        const struct acceptance *item = &fits->acceptances.items[i];
        if ((strcmp(item->thing, words[0]) == 0 && strcmp(item->with, words[1]) == 0) ||
            (strcmp(item->thing, words[1]) == 0 && strcmp(item->with, words[0]) == 0))
            return item;
    }
    return NULL;
}

/* The use that follows from a pair, once the reasons that do not count here are taken out. */
static struct fit_use use_of(const struct scene_fits *fits, struct fit_part thing, struct fit_part with, struct fit fit)
{
    struct fit_use use = { .relation = fit.relation, .with = with };
    if (fit.reasons == 0) {
        use.relation = fit.relation <= FIT_UNSTATED ? fit.relation : FIT_SAME;
        return use;
    }
    for (int r = FIT_ABSENT; r < FIT_N_RELATIONS; r++)
        if (fit.reasons >> r & 1)
            use.relation = (enum fit_relation)r;
    enum fit_needs needs = fit_pair_needs(&fit);
    use.acceptance = needs == FIT_NEEDS_ACCEPTANCE ? acceptance_of(fits, thing, with) : NULL;
    use.state = use.acceptance ? FIT_USED_BY_WORD : FIT_NOT_USED;
    if (needs == FIT_NEEDS_NEVER && fit_needs_of(use.relation) != FIT_NEEDS_NEVER)
        for (int r = FIT_ABSENT; r < FIT_N_RELATIONS; r++) /* what keeps a person from accepting it is said */
            if (fit.reasons >> r & 1 && fit_needs_of((enum fit_relation)r) == FIT_NEEDS_NEVER)
                use.relation = (enum fit_relation)r;
    return use;
}

/* Returns of two uses of one part the one that hinders, else the one by a person's word, else the worse relation. */
static struct fit_use worse_of(struct fit_use a, struct fit_use b)
{
    static const int ranks[] = { [FIT_USED] = 0, [FIT_USED_BY_WORD] = 1, [FIT_NOT_USED] = 2 };
    if (ranks[a.state] != ranks[b.state])
        return ranks[a.state] > ranks[b.state] ? a : b;
    return b.relation > a.relation ? b : a;
}

/* True if the place of a part is known in the frame of the shown image: by the files, or by a person's word. */
static bool is_placed(const struct fit_use *use)
{
    return fit_is_used(use) && use->with.kind == FIT_IMAGE && use->relation != FIT_UNSTATED;
}

/* A part without image to lie on is used, but for another patient's. */
static struct fit_use alone(const struct scene_fits *fits, struct fit_part thing)
{
    return use_of(fits, thing, thing, fit_alone(fits->plan, thing));
}

/* True if the places of two parts are known in the frame of the shown image, or a person's word joins them. */
static bool is_joined(const struct fit_use *a, const struct fit_use *dose)
{
    return (is_placed(a) && is_placed(dose)) || (dose->state == FIT_USED_BY_WORD && dose->relation >= FIT_APART);
}

/* With the shown image, and with the shown dose if that is used: its treatment plan and structure set, and where one
 * of the two is not known to lie in the image's frame also the frames. */
static struct fit_use use_in_scene(const struct scene_fits *fits, struct fit_part thing)
{
    struct fit_part image = { FIT_IMAGE, (size_t)(fits->image < 0 ? 0 : fits->image) };
    struct fit_use use =
        fits->image < 0 ? alone(fits, thing) : use_of(fits, thing, image, fit_of(fits->plan, thing, image));
    if (fits->dose < 0 || thing.kind == FIT_DOSE || !fit_is_used(&fits->doses[fits->dose]))
        return use;
    struct fit_part dose = { FIT_DOSE, (size_t)fits->dose };
    struct fit fit = fit_of(fits->plan, thing, dose);
    fit.reasons &= ~(1U << FIT_APART);
    if (is_joined(&use, &fits->doses[fits->dose]))
        fit.reasons &= ~(1U << FIT_FRAME);
    return fit.reasons ? worse_of(use, use_of(fits, thing, dose, fit)) : use;
}

/* Copies the regions, if some are not used, and makes those empty. */
static bool set_used_regions(struct scene_fits *fits, struct error *err)
{
    const struct region_set *set = &fits->plan->regions;
    bool is_any = false;
    fits->used = *set;
    for (size_t r = 0; r < set->n_regions; r++)
        is_any |= !fit_is_used(region_use(fits, r));
    if (!is_any)
        return true;
    fits->used.regions = mem_array(set->n_regions, sizeof *set->regions, UINT64_MAX, err);
    fits->has_unused_regions = fits->used.regions != NULL;
    if (!fits->has_unused_regions)
        return false;
    memcpy(fits->used.regions, set->regions, set->n_regions * sizeof *set->regions);
    for (size_t r = 0; r < set->n_regions; r++) {
        struct region *region = &fits->used.regions[r];
        if (fit_is_used(region_use(fits, r)))
            continue;
        region->n_voxels = 0;
        region->volume_cm3 = 0;
        region->label = 0;
        region->name[0] = 0;
        region->is_target = false;
    }
    return true;
}

bool scene_fits_of(const struct plan *plan, int image, int blend, int dose, const struct acceptances *acceptances,
                   struct scene_fits *fits, struct error *err)
{
    *fits = (struct scene_fits){ .plan = plan, .image = image, .blend = blend, .dose = dose };
    fits->regions = mem_array(plan->n_region_origins + 1, sizeof *fits->regions, UINT64_MAX, err);
    if (!fits->regions || !acceptances_copy(acceptances, &fits->acceptances, err))
        return false;
    for (size_t i = 0; i < plan->n_images; i++)
        fits->images[i] = alone(fits, (struct fit_part){ FIT_IMAGE, i });
    for (size_t i = 0; i < plan->n_doses; i++)
        fits->doses[i] = use_in_scene(fits, (struct fit_part){ FIT_DOSE, i });
    for (size_t i = 0; i < plan->n_images; i++)
        fits->beside[i] =
            i == (size_t)fits->image ? fits->images[i] : use_in_scene(fits, (struct fit_part){ FIT_IMAGE, i });
    for (size_t i = 0; i < plan->n_beams; i++)
        fits->beams[i] = use_in_scene(fits, (struct fit_part){ FIT_BEAM, i });
    fits->tracks = use_in_scene(fits, (struct fit_part){ FIT_TRACKS, 0 });
    for (size_t i = 0; i <= plan->n_region_origins; i++)
        fits->regions[i] = use_in_scene(fits, (struct fit_part){ FIT_REGIONS, i });
    return set_used_regions(fits, err);
}

void scene_fits_finish(struct scene_fits *fits)
{
    acceptances_finish(&fits->acceptances);
    free(fits->regions);
    fits->regions = NULL;
    if (fits->has_unused_regions)
        free(fits->used.regions);
    fits->has_unused_regions = false;
}

const char *dose_per_counted(const struct dose *dose, double factor, char word[FIT_PER_SIZE])
{
    bool is_whole = factor > 1.5 && fabs(factor - round(factor)) < 1e-9;
    return strcmp(fit_per(dose, word), "fraction") == 0 && is_whole ? "plan" : word;
}

struct fit_use dose_join_of(const struct scene_fits *fits, size_t second, double second_factor, size_t first,
                            double first_factor, enum dose_join join)
{
    const struct fit_part parts[2] = { { FIT_DOSE, second }, { FIT_DOSE, first } };
    const struct dose *doses[2] = { &fits->plan->doses[second], &fits->plan->doses[first] };
    struct fit fit = fit_of(fits->plan, parts[0], parts[1]);
    char pers[2][FIT_PER_SIZE];
    if (strcmp(dose_per_counted(doses[0], second_factor, pers[0]), dose_per_counted(doses[1], first_factor, pers[1])) ==
            0 ||
        join == DOSE_JOIN_GIVEN)
        fit.reasons &= ~(1U << FIT_PER);
    if (join == DOSE_JOIN_COMPARE)
        fit.reasons &= ~(1U << FIT_PLAN);
    if (is_joined(&fits->doses[first], &fits->doses[second]) || is_joined(&fits->doses[second], &fits->doses[first]))
        fit.reasons &= ~(1U << FIT_FRAME | 1U << FIT_APART);
    fit.reasons &= ~(1U << FIT_ABSENT); /* a matter of each dose with the image */
    return worse_of(fits->doses[second], use_of(fits, parts[0], parts[1], fit));
}

void fit_use_sentence(const struct scene_fits *fits, struct fit_part thing, const struct fit_use *use,
                      char why[FIT_WHY_SIZE])
{
    if (use->state == FIT_USED_BY_WORD)
        fit_accepted_sentence(fits->plan, thing, use->with, use->relation, why);
    else
        fit_sentence(fits->plan, thing, use->with, use->relation, why);
}
