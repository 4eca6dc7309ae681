#pragma once
/* Writes and reads the fields of a plan as bytes, for cache.c. The same functions write and read, so that the two
 * cannot differ. Whoever adds a field to a struct of the plan adds it here and raises PLAN_CACHE_FORMAT. */
#include "core/plan/plan.h"

enum {
    PLAN_CACHE_FORMAT = 13,
    FIELDS_MAX_VOLUMES = PLAN_MAX_IMAGES + REGION_MAX_LAYERS + PLAN_MAX_DOSES * (2 * DOSE_N_QUANTITIES + 1)
};

struct fields {
    bool is_reading, is_bad; /* is_bad: the bytes end early or hold a value that no plan has; or lacks_memory */
    bool lacks_memory;       /* writing: there was none for the bytes */
    uint8_t *data;           /* writing: grows; reading: borrowed */
    size_t size, at, capacity;
    struct volume *volumes[FIELDS_MAX_VOLUMES]; /* in the order of their fields; borrowed from the plan; when reading:
                                                   without voxels */
    size_t n_volumes;
};

void fields_bytes(struct fields *fields, void *value, size_t size);
void fields_u64(struct fields *fields, uint64_t *value);
void fields_text(struct fields *fields, char *text, size_t size);

/* Writes or reads everything of the plan but id, load_us and the voxels. Reading creates volumes with voxels
 * NULL and checks counts, indices, enums and numbers that must be finite. After is_bad the plan holds what was read so
 * far; the caller releases it. */
void fields_plan(struct fields *fields, struct plan *plan);
