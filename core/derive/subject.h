#pragma once
/* A subject: the part of a plan that is drawn or derived from, as its kind and its index. Caches, visibility, picking,
 * statistics and export name parts of a plan by it. */
#include "core/plan/plan.h"

enum subject_kind {
    SUBJECT_PLAN, /* the whole plan: for results that belong to no single part */
    SUBJECT_REGION,
    SUBJECT_IMAGE,       /* index: of the plan's images */
    SUBJECT_LABEL_LAYER, /* index: of the layers of its regions */
    SUBJECT_DOSE,        /* index: of its doses */
    SUBJECT_ISODOSE,     /* index: of the levels of a scene's dose */
    SUBJECT_BEAM,        /* index: of its beams; key 1: the draft of the scene, index 0 */
    SUBJECT_TRACKS       /* its tracks; index: of the segment, where one is meant */
};

struct subject {
    enum subject_kind kind;
    size_t index; /* in the plan's list of that kind; 0 for the plan */
    uint64_t key; /* tells subjects of equal kind and index apart; 0 for plan and region */
};

static inline struct subject subject_plan(void)
{
    return (struct subject){ SUBJECT_PLAN, 0, 0 };
}

static inline struct subject subject_region(size_t region)
{
    return (struct subject){ SUBJECT_REGION, region, 0 };
}

bool subject_equal(struct subject a, struct subject b);
uint64_t subject_hash(struct subject subject); /* equal for equal subjects */
/* True if the plan has this part. */
bool subject_exists(const struct plan *plan, struct subject subject);
/* The id that people and URLs use. The subject exists; borrowed from the plan. */
const char *subject_id(const struct plan *plan, struct subject subject);
