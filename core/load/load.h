#pragma once
/* A plan folder becomes a plan. The only header of core/load that leads in; knows no sockets and no scene. */
#include <stdatomic.h>

#include "core/load/cache.h"
#include "core/plan/plan.h"

/* Called from the loading thread as work goes on; phase is a short sentence fragment ("reading ct.nii.gz"), percent
 * 0..100. */
struct plan_progress {
    void (*step)(void *context, const char *phase, double percent);
    void *context;
    atomic_bool *cancel; /* may be NULL; when it turns true loading fails with ERROR_CANCELLED */
};

/* How a plan is opened; all zero: quietly and without a limit. */
struct plan_load_options {
    struct plan_progress progress;
    uint64_t max_bytes;       /* refuse a plan that will take more, before a voxel is read; 0: no limit */
    const char *cache_folder; /* where plan_cache_store may have kept it; NULL: nowhere */
    struct plan_sources *
        *sources; /* with a cache folder: becomes the files the plan was made from, for plan_cache_store, or NULL when
                   * there are too many to watch; the caller's: plan_sources_destroy. NULL: not wanted */
};
#define PLAN_ESTIMATE_FACTOR 1.5 /* how far the estimate compared with max_bytes may be off, either way */

/* Opens a plan folder: plan.json when there is one, else by what lies in it.
 *   options NULL: all zero
 *   errors  ERROR_NOT_FOUND, ERROR_FORMAT, ERROR_UNSUPPORTED, ERROR_LIMIT, ERROR_MEMORY, ERROR_IO, ERROR_CANCELLED;
 *           the text names file, position, what was found, what was expected. Never half a plan.
 *   thread  any, one call a plan */
NODISCARD struct plan *plan_load(const char *folder, const char *id, const struct plan_load_options *options,
                                 struct error *err);
