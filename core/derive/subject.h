#pragma once
/* What of a plan is drawn or derived: its kind, and which one of that kind. Caches, visibility, picking, statistics and
 * export name things by a subject. */
#include "core/plan/plan.h"

enum subject_kind {
    SUBJECT_PLAN, /* all of it: what is derived of no single part */
    SUBJECT_REGION,
    SUBJECT_IMAGE,       /* index: of the plan's images */
    SUBJECT_LABEL_LAYER, /* index: of the layers of its regions */
    SUBJECT_DOSE         /* index: of its doses */
};

struct subject {
    enum subject_kind kind;
    size_t index; /* region: its index in the plan; else 0 */
    uint64_t key; /* what else tells two of a kind apart; plan, region: 0 */
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
/* True if the plan has it. */
bool subject_exists(const struct plan *plan, struct subject subject);
/* The id that people and URLs use. The subject exists; borrowed from the plan. */
const char *subject_id(const struct plan *plan, struct subject subject);
