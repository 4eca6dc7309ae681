#pragma once
/* The store of what is computed from a plan for a scene. A recipe (a plain struct that names all inputs) leads to an
 * immutable, reference-counted result, which is built once, by the first caller, and kept within one budget of memory
 * over all kinds of result. Knows no kind by name: a kind is one file of its own, which exports its functions and calls
 * derive_get with its `struct derive_kind`. Kinds now: region_shape.h, coarse_reduction.h,
 * shape_slabs.h, volume_bricks.h, dose_field.h, dose_coverage.h, isodose_shape.h, coverage_shape.h. */
#include "core/base/once_cache.h"
#include "core/derive/subject.h"

struct derive;

/* The first member of every recipe. */
struct derive_recipe {
    const struct derive_kind *kind;
    struct subject subject;
};

/* The first member of every result. Frozen but for its counter. */
struct derive_result {
    const struct derive_kind *kind;
    uint64_t n_bytes; /* memory that dropping the result frees; 0: too small to count, never dropped */
    _Atomic int references;
};

struct derive_kind {
    size_t recipe_size; /* size of the kind's recipe struct */
    /* True if two recipes of this kind and of one subject have equal other inputs. NULL: there are no other inputs. */
    bool (*is_equal)(const struct derive_recipe *a, const struct derive_recipe *b);
    /* Builds the result, begun with derive_result_init; NULL on failure. Any thread, no lock held; may ask the store
     * for other results, as long as no two builds wait for each other. way: as given to derive_get. */
    struct derive_result *(*build)(struct derive *derive, const struct derive_recipe *recipe, const void *way,
                                   struct error *err);
    void (*destroy)(struct derive_result *result); /* after the last reference is dropped */
};

#define DERIVE_BUDGET_BYTES ((uint64_t)1 << 30) /* the default budget */

/* Creates a store for a plan, which is borrowed, outlives the store and is frozen from then on. */
struct derive *derive_create(const struct plan *plan);
void derive_destroy(struct derive *derive);
const struct plan *derive_plan(const struct derive *derive);

/* One reference, the creator's. n_bytes as in derive_result. */
void derive_result_init(struct derive_result *result, const struct derive_kind *kind, uint64_t n_bytes);
void derive_result_unref(struct derive_result *result);

/* Returns the result of a recipe: the kept one, or a new one. The first caller builds it; other callers of the same
 * recipe wait. When the kept results exceed the budget, the least recently used are dropped; a reference keeps its
 * result alive.
 *
 *   way      how to build, handed to the kind's build: what makes it faster and changes nothing of the result (threads,
 *            a mask that is there already). May be NULL if the kind allows it
 *   returns  one reference, the caller's; NULL on failure
 *   errors   those of the kind's build. A refusal (derive_is_refusal) is remembered and given again without a build;
 *            after any other failure the next caller builds again
 *   thread   any */
NODISCARD struct derive_result *derive_get(struct derive *derive, const struct derive_recipe *recipe, const void *way,
                                           struct error *err);
/* Keeps a result that was built on the way to another one, unless the store has one for the recipe. Adds a reference.
 */
void derive_offer(struct derive *derive, const struct derive_recipe *recipe, struct derive_result *result);
/* True if the result is kept, is being built, or was refused. It may be dropped before the next request. */
bool derive_has(struct derive *derive, const struct derive_recipe *recipe);

/* True if the result is kept or was refused: derive_get would not build or wait now. */
bool derive_is_ready(struct derive *derive, const struct derive_recipe *recipe);

/* True if a build that failed with this code fails each time: by what the plan is, or by a written limit. */
bool derive_is_refusal(enum error_code code);
/* True if the recipe was refused before; fills why. Builds nothing. ONCE_CACHE_MAX_REFUSALS are remembered. */
bool derive_is_refused(struct derive *derive, const struct derive_recipe *recipe, struct error *why);
bool derive_has_refusals(struct derive *derive);

/* For a recipe whose values people drag, after derive_get: of the results whose recipes are alike its own, keeps the
 * ONCE_CACHE_ALIKE last used. is_alike: of two recipes of any kind and of equal size; true if they differ in nothing
 * but such values. */
void derive_drop_alike(struct derive *derive, const struct derive_recipe *recipe,
                       bool (*is_alike)(const void *a, const void *b));

/* Drops at once what exceeds the new budget. */
void derive_set_budget(struct derive *derive, uint64_t n_bytes);
void derive_usage(struct derive *derive, struct once_cache_usage *usage);
