#pragma once
/* The gate: may two parts of a plan be combined? Judges a pair by what the files say of patient, frame of reference,
 * treatment plan, structure set, unit, what a dose is per, and by the grids. Parts of another patient than the one that
 * is shown (core/plan/identity.h) are never used. Knows no scene and no acceptance:
 * core/scene/fit_use.h does. Any thread. */
#include "core/plan/plan.h"

enum fit_kind {
    FIT_IMAGE,
    FIT_REGIONS, /* the regions of one source: index 1.. of plan->region_origins + 1; 0: of no known source */
    FIT_DOSE,
    FIT_BEAM,
    FIT_TRACKS, /* index 0 */
    FIT_N_KINDS
};
struct fit_part {
    enum fit_kind kind;
    size_t index;
};
struct fit_part fit_part_of_region(const struct plan *plan, size_t region);

/* A greater relation is worse. */
enum fit_relation {
    FIT_SAME,       /* one frame of reference, or plan.json says so */
    FIT_REGISTERED, /* a registration of the folder brought one into the other's frame */
    FIT_UNSTATED,   /* the files do not say whether they share a frame: used, with a note */
    FIT_ABSENT,     /* a dose refers to a treatment plan or structure set that is not here */
    FIT_PER,        /* of two doses: per something else */
    FIT_UNIT,       /* of two doses: an unknown unit, units that do not convert, physical with weighted */
    FIT_PLAN,       /* of another treatment plan or structure set */
    FIT_APART,      /* the grids do not meet */
    FIT_FRAME,      /* another frame of reference */
    FIT_PATIENT,    /* another patient */
    FIT_N_RELATIONS
};
/* "same", "registered", "unstated", "absent", "per", "unit", "plan", "apart", "frame", "patient" */
const char *fit_relation_word(enum fit_relation relation);

enum fit_needs { FIT_NEEDS_NOTHING, FIT_NEEDS_ACCEPTANCE, FIT_NEEDS_NEVER };
enum fit_needs fit_needs_of(enum fit_relation relation);
const char *fit_needs_word(enum fit_needs needs); /* "nothing", "acceptance", "never" */

enum { FIT_WHY_SIZE = 480 };
struct fit {
    enum fit_relation relation; /* the worst */
    uint32_t reasons;           /* bits 1 << enum fit_relation of all that hold, from FIT_ABSENT on */
};
struct fit fit_of(const struct plan *plan, struct fit_part thing, struct fit_part with);
/* For a part of a plan of which no image is used: whose it is, and for a dose whether it meets the regions. The pair is
 * the part with itself. */
struct fit fit_alone(const struct plan *plan, struct fit_part thing);
/* Need of the whole pair: never, if one of its reasons is never accepted. */
enum fit_needs fit_pair_needs(const struct fit *fit);
/* One sentence, or two: thing, verb, the other part, colon, the fact, then what it may mean. */
void fit_sentence(const struct plan *plan, struct fit_part thing, struct fit_part with, enum fit_relation relation,
                  char why[FIT_WHY_SIZE]);
/* The sentence for a pair that is used though it does not fit. */
void fit_accepted_sentence(const struct plan *plan, struct fit_part thing, struct fit_part with,
                           enum fit_relation relation, char why[FIT_WHY_SIZE]);

/* True if a part is of another patient than the one that is shown: never drawn, counted or written. */
bool fit_is_of_other(const struct plan *plan, struct fit_part part);
/* The first image that is not of another patient; -1: none. */
int fit_first_image(const struct plan *plan);

/* "dose:ID", "image:ID", "beam:ID", "regions:NUMBER", "tracks": the name of a part in documents and acceptances. */
enum { FIT_PART_SIZE = 80 };
void fit_part_write(const struct plan *plan, struct fit_part part, char text[FIT_PART_SIZE]);
bool fit_part_read(const struct plan *plan, const char *text, struct fit_part *part);

/* The factor that brings a value from one unit to another: Gy, cGy and mGy. False: they do not convert, or one is
 * unknown. */
bool fit_unit_factor(const char *from, const char *to, double *factor);
/* The unit of count that a dose is per, in one spelling: "plan" of "PLAN", "per plan" and "the whole plan". */
enum { FIT_PER_SIZE = 80 };
const char *fit_per(const struct dose *dose, char word[FIT_PER_SIZE]);
