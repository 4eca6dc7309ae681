/* Words for parts that are used though they do not fit. */
#include "core/annotate/describe_fits.h"

#include <stdio.h>
#include <string.h>

#include "core/annotate/describe_dose.h"

struct listing {
    struct annotations *annotations;
    const struct snapshot *snapshot;
    size_t n;
};

static void add_use(struct listing *listing, struct fit_part thing, const struct fit_use *use)
{
    char why[FIT_WHY_SIZE];
    if (use->state != FIT_USED_BY_WORD || listing->n + ANNOTATION_MAX_CLAUSES + 1 > DESCRIBE_FITS_MAX_ITEMS)
        return;
    fit_use_sentence(&listing->snapshot->fits, thing, use, why);
    annotation_add_sentence(listing->annotations, ANNOTATION_MISSING, why);
    const char *by = use->acceptance->by;
    (void)snprintf(annotation_add(listing->annotations, ANNOTATION_MISSING)->text, ANNOTATION_TEXT_SIZE,
                   "Accepted by %.160s.", by[0] ? by : "a person");
    listing->n += ANNOTATION_MAX_CLAUSES + 1;
}

static void add_doses(struct listing *listing)
{
    const struct snapshot *snapshot = listing->snapshot;
    const struct scene_dose_style *style = &snapshot->scene.dose;
    if (snapshot->has_dose_choice && dose_is_described(snapshot)) {
        add_use(listing, (struct fit_part){ FIT_DOSE, (size_t)snapshot->dose }, &snapshot->fits.doses[snapshot->dose]);
        for (size_t i = 0; i < style->n_sum; i++) {
            int dose = dose_index_of(snapshot->plan, style->sum[i].id);
            if (dose < 0 || dose == snapshot->dose)
                continue;
            struct fit_use use = dose_part_use(snapshot, (size_t)dose, style->sum[i].value.factor);
            add_use(listing, (struct fit_part){ FIT_DOSE, (size_t)dose }, &use);
        }
        int second = style->compare.id[0] ? dose_index_of(snapshot->plan, style->compare.id) : -1;
        if (second >= 0 && second != snapshot->dose && style->compare.mode != SCENE_DOSE_COMPARISON_NONE) {
            struct fit_use use = dose_compared_use(snapshot, (size_t)second);
            add_use(listing, (struct fit_part){ FIT_DOSE, (size_t)second }, &use);
        }
    }
}

static void add_regions(struct listing *listing)
{
    const struct snapshot *snapshot = listing->snapshot;
    for (size_t source = 0; source <= snapshot->plan->n_region_origins; source++)
        for (size_t r = 0; r < snapshot->plan->regions.n_regions; r++) {
            struct fit_part part = fit_part_of_region(snapshot->plan, r);
            if (part.index != source || !snapshot->styles[r].visible)
                continue;
            add_use(listing, part, &snapshot->fits.regions[source]);
            break;
        }
}

void fits_describe(struct annotations *annotations, const struct snapshot *snapshot)
{
    struct listing listing = { annotations, snapshot, 0 };
    if (snapshot->fits.acceptances.n == 0)
        return;
    if (snapshot->blend >= 0)
        add_use(&listing, (struct fit_part){ FIT_IMAGE, (size_t)snapshot->blend },
                &snapshot->fits.beside[snapshot->blend]);
    add_doses(&listing);
    add_regions(&listing);
    for (size_t i = 0; i < snapshot->plan->n_beams; i++)
        add_use(&listing, (struct fit_part){ FIT_BEAM, i }, &snapshot->fits.beams[i]);
    if (snapshot->scene.tracks.visible)
        add_use(&listing, (struct fit_part){ FIT_TRACKS, 0 }, &snapshot->fits.tracks);
}
