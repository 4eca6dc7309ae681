#pragma once
/* Which parts of a plan a scene uses together: the judgement of each pair (core/plan/fit.h) and what people accepted.
 * Decided once for a snapshot; everything that draws, computes, exports or captions a combination reads it from there.
 * Any thread. */
#include "core/plan/fit.h"
#include "scene.h" /* generated from proto/scene.json */

enum { ACCEPTANCES_MAX = 64, ACCEPTANCE_BY_SIZE = 164, ACCEPTANCE_WORDS_SIZE = 1204 };
/* A person's word that two parts are used together though they do not fit. Not a part of the scene. */
struct acceptance {
    char thing[FIT_PART_SIZE], with[FIT_PART_SIZE]; /* fit_part_write */
    char by[ACCEPTANCE_BY_SIZE], words[ACCEPTANCE_WORDS_SIZE];
};
struct acceptances {
    struct acceptance *items; /* owned */
    size_t n;
};
void acceptances_finish(struct acceptances *acceptances);
NODISCARD bool acceptances_copy(const struct acceptances *from, struct acceptances *to, struct error *err);

enum fit_state { FIT_USED, FIT_NOT_USED, FIT_USED_BY_WORD };
const char *fit_state_word(enum fit_state state); /* "used", "not-used", "by-word" */
struct fit_use {
    enum fit_state state;
    enum fit_relation relation;          /* the worst of the reasons; of a part that is used what joins the two */
    struct fit_part with;                /* the other part of that pair */
    const struct acceptance *acceptance; /* FIT_USED_BY_WORD: points into the scene's acceptances */
};
static inline bool fit_is_used(const struct fit_use *use)
{
    return use->state != FIT_NOT_USED;
}

/* The parts of a plan that a scene uses. */
struct scene_fits {
    const struct plan *plan; /* borrowed */
    struct acceptances acceptances;
    int image, blend, dose;                 /* as the scene names them; -1: none */
    struct fit_use images[PLAN_MAX_IMAGES]; /* as the shown image: of another patient or not */
    struct fit_use beside[PLAN_MAX_IMAGES]; /* beside the shown image: blended, read at a point */
    struct fit_use doses[PLAN_MAX_DOSES];   /* shown with the image */
    struct fit_use beams[PLAN_MAX_BEAMS];
    struct fit_use tracks;
    struct fit_use *regions; /* owned; [n_region_origins + 1], by index of FIT_REGIONS */
    struct region_set used;  /* the plan's regions; those that are not used are empty: no univels, label 0, no name */
    bool has_unused_regions; /* used.regions is owned, else the plan's */
};
/* Decides for a scene that shows, blends and doses these parts (indices, or -1). acceptances: NULL: none; copied.
 * scene_fits_finish afterwards, on failure too.
 *   errors  ERROR_MEMORY */
NODISCARD bool scene_fits_of(const struct plan *plan, int image, int blend, int dose,
                             const struct acceptances *acceptances, struct scene_fits *fits, struct error *err);
void scene_fits_finish(struct scene_fits *fits);

static inline const struct fit_use *region_use(const struct scene_fits *fits, size_t region)
{
    return &fits->regions[fit_part_of_region(fits->plan, region).index];
}

/* The unit of count that a dose is per once it is multiplied by factor: a whole number above 1 of a dose per fraction
 * makes it one of the whole plan. */
const char *dose_per_counted(const struct dose *dose, double factor, char word[FIT_PER_SIZE]);
/* How two doses are put together. */
enum dose_join {
    DOSE_JOIN_SUM,    /* added: of one treatment plan, else a person's word */
    DOSE_JOIN_GIVEN,  /* added, brought to one output of the source before */
    DOSE_JOIN_COMPARE /* beside each other: of any treatment plan of the same patient and frame */
};
/* Whether a second dose is used with the first one. factor: how many times each counts. */
struct fit_use dose_join_of(const struct scene_fits *fits, size_t second, double second_factor, size_t first,
                            double first_factor, enum dose_join join);
/* The sentence of a use. */
void fit_use_sentence(const struct scene_fits *fits, struct fit_part thing, const struct fit_use *use,
                      char why[FIT_WHY_SIZE]);
