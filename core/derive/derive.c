/* The store of derived results: one cache whose keys are recipes. */
#include "core/derive/derive.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct derive {
    const struct plan *plan;
    struct once_cache *cache; /* by recipe */
};

/* ---- recipes and results, for the cache ------------------------------------------------------------------------- */

static bool recipe_is_equal(const void *left, const void *right)
{
    const struct derive_recipe *a = left, *b = right;
    return a->kind == b->kind && subject_equal(a->subject, b->subject) &&
           (!a->kind->is_equal || a->kind->is_equal(a, b));
}

static void result_ref(void *result)
{
    atomic_fetch_add(&((struct derive_result *)result)->references, 1);
}

static void result_unref(void *result)
{
    derive_result_unref(result);
}

static uint64_t result_bytes(const void *result)
{
    return ((const struct derive_result *)result)->n_bytes;
}

static const struct once_cache_type cache_type = { recipe_is_equal, result_ref, result_unref, result_bytes,
                                                   derive_is_refusal };

static struct once_key key_of(const struct derive_recipe *recipe)
{
    return (struct once_key){ recipe, recipe->kind->recipe_size, subject_hash(recipe->subject) };
}

void derive_result_init(struct derive_result *result, const struct derive_kind *kind, uint64_t n_bytes)
{
    result->kind = kind;
    result->n_bytes = n_bytes;
    atomic_init(&result->references, 1);
}

void derive_result_unref(struct derive_result *result)
{
    if (result && atomic_fetch_sub(&result->references, 1) == 1)
        result->kind->destroy(result);
}

/* ---- the store -------------------------------------------------------------------------------------------------- */

struct derive *derive_create(const struct plan *plan)
{
    struct derive *derive = mem_new(sizeof *derive);
    derive->plan = plan;
    derive->cache = once_cache_create(&cache_type, DERIVE_BUDGET_BYTES);
    return derive;
}

void derive_destroy(struct derive *derive)
{
    if (!derive)
        return;
    once_cache_destroy(derive->cache);
    free(derive);
}

const struct plan *derive_plan(const struct derive *derive)
{
    return derive->plan;
}

struct building {
    struct derive *derive;
    const struct derive_recipe *recipe;
    const void *way;
};

static void *build(void *context, struct error *err)
{
    const struct building *building = context;
    return building->recipe->kind->build(building->derive, building->recipe, building->way, err);
}

struct derive_result *derive_get(struct derive *derive, const struct derive_recipe *recipe, const void *way,
                                 struct error *err)
{
    struct once_key key = key_of(recipe);
    struct building building = { derive, recipe, way };
    return once_cache_get(derive->cache, &key, build, &building, err);
}

void derive_offer(struct derive *derive, const struct derive_recipe *recipe, struct derive_result *result)
{
    struct once_key key = key_of(recipe);
    once_cache_offer(derive->cache, &key, result);
}

bool derive_has(struct derive *derive, const struct derive_recipe *recipe)
{
    struct once_key key = key_of(recipe);
    return once_cache_has(derive->cache, &key);
}

bool derive_is_ready(struct derive *derive, const struct derive_recipe *recipe)
{
    struct once_key key = key_of(recipe);
    return once_cache_is_ready(derive->cache, &key);
}

bool derive_is_refusal(enum error_code code)
{
    return code == ERROR_UNSUPPORTED || code == ERROR_LIMIT || code == ERROR_RANGE || code == ERROR_FORMAT;
}

bool derive_is_refused(struct derive *derive, const struct derive_recipe *recipe, struct error *why)
{
    struct once_key key = key_of(recipe);
    return once_cache_is_refused(derive->cache, &key, why);
}

bool derive_has_refusals(struct derive *derive)
{
    return once_cache_has_refusals(derive->cache);
}

void derive_drop_alike(struct derive *derive, const struct derive_recipe *recipe,
                       bool (*is_alike)(const void *a, const void *b))
{
    struct once_key key = key_of(recipe);
    once_cache_drop_alike(derive->cache, &key, is_alike);
}

void derive_set_budget(struct derive *derive, uint64_t n_bytes)
{
    once_cache_set_budget(derive->cache, n_bytes);
}

void derive_usage(struct derive *derive, struct once_cache_usage *usage)
{
    once_cache_usage(derive->cache, usage);
}
