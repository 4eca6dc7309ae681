#pragma once
/* Opens a plan folder. The one entry to core/load for loading; beside it stand cache.h, summary.h and write_plan.h.
 * Knows no sockets and no scene. */
#include <stdatomic.h>

#include "core/load/cache.h"
#include "core/plan/plan.h"

/* Progress of plan_load. step is called on the caller's thread, some 50 times a second; phase is a fragment of a
 * sentence
 * ("reading ct.nii.gz"), percent goes from 0 to 100 and never falls. */
struct plan_progress {
    void (*step)(void *context, const char *phase, double percent);
    void *context;
    atomic_bool *cancel; /* when it turns true loading fails with ERROR_CANCELLED; may be NULL */
};

/* All zero: no progress, no limit, no cache. */
struct plan_load_options {
    struct plan_progress progress;
    uint64_t max_bytes;       /* refuse a plan whose estimate is above, before a voxel is read; 0: no limit */
    const char *cache_folder; /* where plan_cache_store may have kept the plan; NULL: no cache */
    struct plan_sources **
        sources; /* receives the files the plan was made from, for plan_cache_store; the caller calls
                  * plan_sources_destroy. Set to NULL without a cache folder or with too many files. NULL: not wanted */
};
#define PLAN_ESTIMATE_FACTOR 1.5 /* the estimate may be too large or too small by this factor */

/* Opens a plan folder as its plan.json says; without plan.json its files are recognised.
 *   options NULL: all zero
 *   errors  ERROR_NOT_FOUND, ERROR_FORMAT, ERROR_UNSUPPORTED, ERROR_LIMIT, ERROR_MEMORY, ERROR_IO, ERROR_CANCELLED;
 *           the text names file, position, what was found, what was expected. Never a part of a plan.
 *   thread  any, one call a plan */
NODISCARD struct plan *plan_load(const char *folder, const char *id, const struct plan_load_options *options,
                                 struct error *err);
