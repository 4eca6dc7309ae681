#pragma once
/* Inside core/load: the fields of a plan as bytes. One function says what they are, for writing and for reading, so the
 * two cannot differ; whoever adds a field to a struct of the plan adds it there and raises PLAN_CACHE_FORMAT. */
#include "core/plan/plan.h"

enum {
    PLAN_CACHE_FORMAT = 3,
    FIELDS_MAX_VOLUMES = PLAN_MAX_IMAGES + REGION_MAX_LAYERS + PLAN_MAX_DOSES * (DOSE_N_QUANTITIES + 1)
};

struct fields {
    bool is_reading, is_bad; /* bad: cut short, or a value that no plan has */
    uint8_t *data;           /* writing: grows; reading: borrowed */
    size_t size, at, capacity;
    struct volume
        *volumes[FIELDS_MAX_VOLUMES]; /* in order of their fields; borrowed from the plan; reading: without voxels */
    size_t n_volumes;
};

void fields_bytes(struct fields *fields, void *value, size_t size);
void fields_u64(struct fields *fields, uint64_t *value);
void fields_text(struct fields *fields, char *text, size_t size);

/* All of the plan but id, shapes, load_us and the voxels. Reading: volumes are created without voxels (voxels NULL),
 * and everything is checked: counts, indices, enums, numbers that must be finite. What was read stays in the plan when
 * it is bad: plan_destroy it. */
void fields_plan(struct fields *fields, struct plan *plan);
