#pragma once
/* A cache of results that threads share. Each result is built once: the first caller for a key builds, without a lock
 * held, and other callers for the same key wait. Results are kept within a budget of memory, least recently used
 * dropped first. The module knows neither what a key means nor what a result is. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

/* How keys are compared and results are held. Called with the cache's lock held, so they must not call the cache. */
struct once_cache_type {
    bool (*is_equal)(const void *a, const void *b); /* two keys of equal hash and size */
    void (*ref)(void *result);                      /* adds a reference */
    void (*unref)(void *result);                    /* drops a reference; frees with the last one */
    uint64_t (*n_bytes)(const void *result); /* memory that dropping it frees; 0: it is never dropped for the budget */
    bool (*is_final)(enum error_code code); /* true: a build that failed with this code would fail again; NULL: never */
};

struct once_key {
    const void *bytes; /* borrowed; the cache keeps a copy */
    size_t n_bytes;
    uint64_t hash; /* equal for equal keys */
};

struct once_cache_usage {
    size_t n_results;
    uint64_t n_bytes, budget_bytes;
};

enum { ONCE_CACHE_MAX_REFUSALS = 1024 };

struct once_cache;

/* type: borrowed, outlives the cache. Destroying drops the cache's own references; no thread may be inside a call. */
struct once_cache *once_cache_create(const struct once_cache_type *type, uint64_t budget_bytes);
void once_cache_destroy(struct once_cache *cache);

/* One reference, the caller's; NULL on failure. */
typedef void *once_cache_build(void *context, struct error *err);

/* The result of a key, built by build(context) if the cache does not hold it.
 *
 *   returns  one reference, the caller's; NULL on failure
 *   errors   those of build. A failure is not kept: each thread that waited builds in turn, as memory may come back. A
 *            final failure (is_final) is kept as a refusal: asked for again, the same error comes without a build
 *   thread   any. build may ask the cache for other keys, as long as no two builds wait for each other
 *
 * The newest result is kept even if it alone exceeds the budget: else two threads that ask for two keys in turn would
 * build for ever. */
NODISCARD void *once_cache_get(struct once_cache *cache, const struct once_key *key, once_cache_build *build,
                               void *context, struct error *err);
/* Keeps a result that was built outside once_cache_get, unless the key has one. Adds a reference of its own. */
void once_cache_offer(struct once_cache *cache, const struct once_key *key, void *result);
/* True if the key's result is kept, is being built, or is refused. It may be dropped before the next request. */
bool once_cache_has(struct once_cache *cache, const struct once_key *key);
/* True if the key's result is kept or refused: once_cache_get would not build or wait now. */
bool once_cache_is_ready(struct once_cache *cache, const struct once_key *key);
/* True if the key's build failed for good; fills why. At most ONCE_CACHE_MAX_REFUSALS are remembered: one more forgets
 * them all. */
bool once_cache_is_refused(struct once_cache *cache, const struct once_key *key, struct error *why);
bool once_cache_has_refusals(struct once_cache *cache);

/* Drops results that the key's takes the place of, as when a value is dragged: of those with the key's hash and size
 * whose keys are alike, the ONCE_CACHE_ALIKE last used are kept, the key's own among them. is_alike: called with the
 * lock held. */
enum { ONCE_CACHE_ALIKE = 2 };
void once_cache_drop_alike(struct once_cache *cache, const struct once_key *key,
                           bool (*is_alike)(const void *a, const void *b));
/* Drops at once what exceeds the new budget. */
void once_cache_set_budget(struct once_cache *cache, uint64_t budget_bytes);
void once_cache_usage(struct once_cache *cache, struct once_cache_usage *usage);
