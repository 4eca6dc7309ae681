/* Judges pairs of parts of a plan. */
#include "core/plan/fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/plan/fit_facts.h"
#include "core/plan/identity.h"

static const struct part_origin no_origin = { .patient = -1, .treatment_plan = -1 };

const char *fit_relation_word(enum fit_relation relation)
{
    static const char *const words[FIT_N_RELATIONS] = { "same", "registered", "unstated", "absent", "per",
                                                        "unit", "plan",       "apart",    "frame",  "patient" };
    return words[relation];
}

enum fit_needs fit_needs_of(enum fit_relation relation)
{
    if (relation <= FIT_UNSTATED)
        return FIT_NEEDS_NOTHING;
    return relation == FIT_PATIENT || relation == FIT_UNIT || relation == FIT_PER ? FIT_NEEDS_NEVER
                                                                                  : FIT_NEEDS_ACCEPTANCE;
}

const char *fit_needs_word(enum fit_needs needs)
{
    static const char *const words[] = { "nothing", "acceptance", "never" };
    return words[needs];
}

enum fit_needs fit_pair_needs(const struct fit *fit)
{
    enum fit_needs needs = FIT_NEEDS_NOTHING;
    for (int r = FIT_ABSENT; r < FIT_N_RELATIONS; r++)
        if (fit->reasons >> r & 1 && fit_needs_of((enum fit_relation)r) > needs)
            needs = fit_needs_of((enum fit_relation)r);
    return needs;
}

struct fit_part fit_part_of_region(const struct plan *plan, size_t region)
{
    size_t origin = plan->regions.regions[region].origin;
    return (struct fit_part){ FIT_REGIONS, origin <= plan->n_region_origins ? origin : 0 };
}

/* ---- whose a part is -------------------------------------------------------------------------------------------- */

const struct part_origin *fit_origin_of(const struct plan *plan, struct fit_part part)
{
    switch (part.kind) {
    case FIT_IMAGE: return &plan->image_origins[part.index];
    case FIT_DOSE: return &plan->dose_origins[part.index];
    case FIT_BEAM: return &plan->beam_origins[part.index];
    case FIT_TRACKS: return &plan->tracks_origin;
    case FIT_REGIONS: return part.index > 0 ? &plan->region_origins[part.index - 1] : &no_origin;
    case FIT_N_KINDS: break;
    }
    return &no_origin;
}

/* NULL: none, or not here. */
const struct treatment_plan *fit_treatment_plan_of(const struct plan *plan, const struct part_origin *origin)
{
    return origin->treatment_plan >= 0 && (size_t)origin->treatment_plan < plan->n_treatment_plans
               ? &plan->treatment_plans[origin->treatment_plan]
               : NULL;
}

static int patient_of(const struct plan *plan, const struct part_origin *origin)
{
    const struct treatment_plan *treatment = fit_treatment_plan_of(plan, origin);
    int patient = origin->patient >= 0 && (size_t)origin->patient < plan->n_patients ? origin->patient
                  : treatment                                                        ? treatment->patient
                                                                                     : -1;
    return patient >= 0 && (size_t)patient < plan->n_patients ? patient : -1;
}

static const char *plan_uid_of(const struct plan *plan, const struct part_origin *origin)
{
    const struct treatment_plan *treatment = fit_treatment_plan_of(plan, origin);
    return treatment && treatment->uid[0] ? treatment->uid : origin->plan_uid;
}

static const char *structs_uid_of(const struct plan *plan, struct fit_part part)
{
    const struct part_origin *origin = fit_origin_of(plan, part);
    const struct treatment_plan *treatment = fit_treatment_plan_of(plan, origin);
    if (part.kind == FIT_REGIONS || !treatment || !treatment->structs_uid[0])
        return origin->structs_uid;
    return treatment->structs_uid;
}

static bool has_structs(const struct plan *plan, const char *uid)
{
    for (size_t i = 0; i < plan->n_region_origins; i++)
        if (strcmp(plan->region_origins[i].structs_uid, uid) == 0)
            return true;
    return false;
}

bool fit_is_of_other(const struct plan *plan, struct fit_part part)
{
    int patient = patient_of(plan, fit_origin_of(plan, part)), shown = plan_shown_patient(plan);
    return patient >= 0 && shown >= 0 && patient != shown;
}

int fit_first_image(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_images; i++)
        if (!fit_is_of_other(plan, (struct fit_part){ FIT_IMAGE, i }))
            return (int)i;
    return -1;
}

/* ---- where a part lies ------------------------------------------------------------------------------------------ */

static bool boxes_meet(const struct box3 *a, const struct box3 *b)
{
    return a->low.x < b->high.x && b->low.x < a->high.x && a->low.y < b->high.y && b->low.y < a->high.y &&
           a->low.z < b->high.z && b->low.z < a->high.z;
}

/* The box around a region's univels. */
static struct box3 region_box(const struct region_set *set, const struct region *region)
{
    struct box3 box = box3_empty();
    for (int corner = 0; corner < 8; corner++)
        box3_add(&box, affine_point(&set->layers[region->layer]->grid.lps_mm_from_ijk,
                                    vec3(corner & 1 ? region->high_ijk[0] + 0.5 : region->low_ijk[0] - 0.5,
                                         corner & 2 ? region->high_ijk[1] + 0.5 : region->low_ijk[1] - 0.5,
                                         corner & 4 ? region->high_ijk[2] + 0.5 : region->low_ijk[2] - 0.5)));
    return box;
}

/* True if a box meets a region of the source (-1: of any), or the source has none. */
static bool meets_regions(const struct plan *plan, const struct box3 *box, int source)
{
    bool is_any = false;
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        if (plan->regions.regions[r].n_voxels == 0 ||
            (source >= 0 && fit_part_of_region(plan, r).index != (size_t)source))
            continue;
        struct box3 region = region_box(&plan->regions, &plan->regions.regions[r]);
        is_any = true;
        if (boxes_meet(box, &region))
            return true;
    }
    return !is_any;
}

static bool dose_meets_regions(const struct plan *plan, size_t dose)
{
    for (size_t c = 0; c < plan->doses[dose].n_components; c++) {
        struct box3 box = grid_bounds_lps_mm(&plan->doses[dose].components[c].values->grid);
        if (!meets_regions(plan, &box, -1))
            return false;
    }
    return true;
}

static bool meets(const struct plan *plan, const struct box3 *box, struct fit_part with)
{
    if (with.kind == FIT_IMAGE && plan->images[with.index].volume) {
        struct box3 image = grid_bounds_lps_mm(&plan->images[with.index].volume->grid);
        return boxes_meet(box, &image);
    }
    if (with.kind == FIT_REGIONS)
        return meets_regions(plan, box, (int)with.index);
    for (size_t c = 0; with.kind == FIT_DOSE && c < plan->doses[with.index].n_components; c++) {
        struct box3 dose = grid_bounds_lps_mm(&plan->doses[with.index].components[c].values->grid);
        if (!boxes_meet(box, &dose))
            return false;
    }
    return true; /* a beam and tracks have no grid */
}

static bool is_apart(const struct plan *plan, struct fit_part thing, struct fit_part with)
{
    if (thing.kind == FIT_DOSE)
        for (size_t c = 0; c < plan->doses[thing.index].n_components; c++) {
            struct box3 box = grid_bounds_lps_mm(&plan->doses[thing.index].components[c].values->grid);
            if (!meets(plan, &box, with))
                return true;
        }
    else if (with.kind == FIT_DOSE)
        return is_apart(plan, with, thing);
    else if (thing.kind == FIT_IMAGE && plan->images[thing.index].volume) {
        struct box3 box = grid_bounds_lps_mm(&plan->images[thing.index].volume->grid);
        return !meets(plan, &box, with);
    } else if (with.kind == FIT_IMAGE)
        return is_apart(plan, with, thing);
    return false;
}

/* True if plan.json states that a part's frame is the image's (is_same), or that it is not. */
static bool is_stated(const struct plan *plan, struct fit_part part, bool is_same)
{
    const struct part_origin *origin = fit_origin_of(plan, part);
    if (is_same ? origin->is_stated_same : origin->is_stated_other)
        return true;
    return part.kind == FIT_DOSE && !origin->frame_uid[0] && plan->doses[part.index].has_frame &&
           plan->doses[part.index].frame == (is_same ? DOSE_FRAME_SAME : DOSE_FRAME_DIFFERS);
}

/* FIT_SAME, FIT_REGISTERED, FIT_UNSTATED or FIT_FRAME. What plan.json says of a dose is about the image. */
static enum fit_relation frames_of(const struct plan *plan, struct fit_part thing, struct fit_part with)
{
    const struct part_origin *a = fit_origin_of(plan, thing), *b = fit_origin_of(plan, with);
    if (is_stated(plan, thing, false) != is_stated(plan, with, false))
        return FIT_FRAME;
    if (is_stated(plan, thing, true) && (with.kind == FIT_IMAGE || is_stated(plan, with, true)))
        return FIT_SAME;
    if (!a->frame_uid[0] || !b->frame_uid[0])
        return FIT_UNSTATED;
    if (strcmp(a->frame_uid, b->frame_uid) != 0)
        return FIT_FRAME;
    return a->is_registered != b->is_registered ? FIT_REGISTERED : FIT_SAME;
}

/* ---- two doses -------------------------------------------------------------------------------------------------- */

bool fit_unit_factor(const char *from, const char *to, double *factor)
{
    static const struct {
        const char *word;
        double gy;
    } units[] = { { "Gy", 1 }, { "cGy", 0.01 }, { "mGy", 0.001 } };
    double sides[2] = { NAN, NAN };
    *factor = 1;
    if (!from[0] || !to[0])
        return false;
    if (strcmp(from, to) == 0)
        return true;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        sides[0] = strcmp(from, units[i].word) == 0 ? units[i].gy : sides[0];
        sides[1] = strcmp(to, units[i].word) == 0 ? units[i].gy : sides[1];
    }
    *factor = sides[0] < sides[1] ? 1 / round(sides[1] / sides[0]) : round(sides[0] / sides[1]);
    return isfinite(*factor);
}

const char *fit_per(const struct dose *dose, char word[FIT_PER_SIZE])
{
    static const char *const fillers[] = { "per ", "the ", "a ", "one ", "whole ", "entire " };
    static const char *const shorts[][2] = { { "min", "minute" }, { "fx", "fraction" } };
    char low[FIT_PER_SIZE];
    const char *rest = low;
    size_t n = 0;
    for (const char *at = dose->per; *at && n + 1 < sizeof low; at++)
        if (*at != ' ' || (n > 0 && low[n - 1] != ' '))
            low[n++] = *at >= 'A' && *at <= 'Z' ? (char)(*at + 'a' - 'A') : *at;
    low[n > 0 && low[n - 1] == ' ' ? n - 1 : n] = 0;
    for (size_t i = 0; i < sizeof fillers / sizeof *fillers; i++)
        if (strncmp(rest, fillers[i], strlen(fillers[i])) == 0)
            rest += strlen(fillers[i]);
    for (size_t i = 0; i < sizeof shorts / sizeof *shorts; i++)
        rest = strcmp(rest, shorts[i][0]) == 0 ? shorts[i][1] : rest;
    snprintf(word, FIT_PER_SIZE, "%s", rest);
    return word;
}

/* True if a dose has weighted values alone, so that nothing of it is physical. */
bool fit_is_weighted_alone(const struct dose *dose)
{
    for (size_t c = 0; c < dose->n_components; c++)
        if (dose->components[c].quantity != DOSE_WEIGHTED_TOTAL)
            return false;
    return dose->n_components > 0;
}

static bool has_weighted(const struct dose *dose)
{
    for (size_t c = 0; c < dose->n_components; c++)
        if (dose->components[c].quantity == DOSE_WEIGHTED_TOTAL)
            return true;
    return false;
}

static uint32_t dose_reasons(const struct dose *a, const struct dose *b)
{
    char pers[2][FIT_PER_SIZE];
    uint32_t reasons = 0;
    double factor;
    if (!fit_unit_factor(a->unit, b->unit, &factor) || (fit_is_weighted_alone(a) && !has_weighted(b)) ||
        (fit_is_weighted_alone(b) && !has_weighted(a)))
        reasons |= 1U << FIT_UNIT;
    if (strcmp(fit_per(a, pers[0]), fit_per(b, pers[1])) != 0)
        reasons |= 1U << FIT_PER;
    return reasons;
}

/* ---- the pair --------------------------------------------------------------------------------------------------- */

/* True if a dose refers to a treatment plan that is not among those of the folder, or to a structure set that is not
 * among those of the folder. A folder without any of them holds nothing that the dose could be mistaken to belong to.
 */
static bool refers_to_absent(const struct plan *plan, const struct part_origin *origin)
{
    if (fit_treatment_plan_of(plan, origin))
        return false;
    if (origin->plan_uid[0] && plan->n_treatment_plans > 0)
        return true;
    bool has_any = false;
    for (size_t i = 0; i < plan->n_region_origins; i++)
        has_any |= plan->region_origins[i].structs_uid[0] != 0;
    return has_any && origin->structs_uid[0] && !has_structs(plan, origin->structs_uid);
}

struct fit fit_of(const struct plan *plan, struct fit_part thing, struct fit_part with)
{
    const struct part_origin *a = fit_origin_of(plan, thing), *b = fit_origin_of(plan, with);
    int patients[2] = { patient_of(plan, a), patient_of(plan, b) };
    enum fit_relation frames = frames_of(plan, thing, with);
    struct fit fit = { frames, frames == FIT_FRAME ? 1U << FIT_FRAME : 0 };

    if ((patients[0] >= 0 && patients[1] >= 0 && patients[0] != patients[1]) || fit_is_of_other(plan, thing) ||
        fit_is_of_other(plan, with))
        fit.reasons |= 1U << FIT_PATIENT;
    bool is_regions_with_dose =
        (thing.kind == FIT_REGIONS && with.kind == FIT_DOSE) || (thing.kind == FIT_DOSE && with.kind == FIT_REGIONS);
    if (!is_regions_with_dose && is_apart(plan, thing, with)) /* regions may lie outside a dose: they have none there */
        fit.reasons |= 1U << FIT_APART;
    if (thing.kind != FIT_IMAGE && with.kind == FIT_DOSE) {
        const char *uids[2] = { plan_uid_of(plan, a), plan_uid_of(plan, b) },
                   *structs[2] = { structs_uid_of(plan, thing), structs_uid_of(plan, with) };
        if (uids[0][0] && uids[1][0] && strcmp(uids[0], uids[1]) != 0)
            fit.reasons |= 1U << FIT_PLAN;
        if (thing.kind == FIT_REGIONS && structs[0][0] && structs[1][0] && strcmp(structs[0], structs[1]) != 0)
            fit.reasons |= 1U << FIT_PLAN;
        if (thing.kind == FIT_DOSE)
            fit.reasons |= dose_reasons(&plan->doses[thing.index], &plan->doses[with.index]);
    }
    if (thing.kind == FIT_DOSE && refers_to_absent(plan, a))
        fit.reasons |= 1U << FIT_ABSENT;
    for (int r = FIT_ABSENT; r < FIT_N_RELATIONS; r++)
        if (fit.reasons >> r & 1)
            fit.relation = (enum fit_relation)r;
    return fit;
}

struct fit fit_alone(const struct plan *plan, struct fit_part thing)
{
    struct fit fit = fit_of(plan, thing, thing);
    fit.reasons &= 1U << FIT_PATIENT | 1U << FIT_ABSENT;
    fit.relation = frames_of(plan, thing, thing);
    if (is_stated(plan, thing, false))
        fit.reasons |= 1U << FIT_FRAME;
    if (thing.kind == FIT_DOSE && !dose_meets_regions(plan, thing.index))
        fit.reasons |= 1U << FIT_APART;
    for (int r = FIT_ABSENT; r < FIT_N_RELATIONS; r++)
        if (fit.reasons >> r & 1)
            fit.relation = (enum fit_relation)r;
    return fit;
}

/* ---- names of parts --------------------------------------------------------------------------------------------- */

static const char *const kind_words[FIT_N_KINDS] = { "image", "regions", "dose", "beam", "tracks" };

static const char *id_of(const struct plan *plan, enum fit_kind kind, size_t index)
{
    return kind == FIT_IMAGE  ? plan->images[index].id
           : kind == FIT_DOSE ? plan->doses[index].id
                              : plan->beams[index].id;
}

void fit_part_write(const struct plan *plan, struct fit_part part, char text[FIT_PART_SIZE])
{
    if (part.kind == FIT_TRACKS)
        snprintf(text, FIT_PART_SIZE, "tracks");
    else if (part.kind == FIT_REGIONS)
        snprintf(text, FIT_PART_SIZE, "regions:%zu", part.index);
    else
        snprintf(text, FIT_PART_SIZE, "%s:%s", kind_words[part.kind], id_of(plan, part.kind, part.index));
}

bool fit_part_read(const struct plan *plan, const char *text, struct fit_part *part)
{
    const size_t n[FIT_N_KINDS] = { plan->n_images, plan->n_region_origins + 1, plan->n_doses, plan->n_beams, 1 };
    char name[FIT_PART_SIZE];
    for (int kind = 0; kind < FIT_N_KINDS; kind++)
        for (size_t i = 0; strncmp(text, kind_words[kind], strlen(kind_words[kind])) == 0 && i < n[kind]; i++) {
            *part = (struct fit_part){ (enum fit_kind)kind, i };
            fit_part_write(plan, *part, name);
            if (strcmp(name, text) == 0)
                return true;
        }
    return false;
}
