/* Cuts closed shapes by planes and keeps the outlines. */
#include "core/render/visible/cap_cache.h"

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/derive/shape_slabs.h"
#include "core/render/visible/kept.h"

/* Limits of the cache: 48 MiB of lines. */
enum { MAX_ENTRIES = 1024, MAX_LINES = 1 << 20 };
/* With fewer triangles a search of all of them takes no time. */
enum { MIN_INDEXED_TRIANGLES = 4096 };
/* More than single precision rounds coordinates by: farther away the plane surely misses a shape. */
static const double rounding_mm = 1e-2;

struct entry {
    struct kept kept;
    struct cut_lines lines;
    struct shape_want want;
    struct plane plane;
    int n_uses;
};

struct cap_cache {
    struct kept *first;
};

struct cap_cache *cap_cache_create(void)
{
    return mem_new(sizeof(struct cap_cache));
}

static void entry_destroy(struct kept *kept)
{
    struct entry *entry = (struct entry *)kept;
    assert(entry->n_uses == 0);
    cut_lines_finish(&entry->lines);
    free(entry);
}

static bool entry_is_used(const struct kept *kept)
{
    return ((const struct entry *)kept)->n_uses > 0;
}

static size_t entry_n_lines(const struct kept *kept)
{
    return ((const struct entry *)kept)->lines.n;
}

static const struct kept_type entries = { entry_destroy, entry_is_used, entry_n_lines, MAX_ENTRIES, MAX_LINES };

void cap_cache_forget(struct cap_cache *cache, const struct plan *plan)
{
    kept_forget(&cache->first, &entries, plan);
}

void cap_cache_destroy(struct cap_cache *cache)
{
    if (!cache)
        return;
    cap_cache_forget(cache, NULL);
    free(cache);
}

void cap_cache_trim(struct cap_cache *cache)
{
    kept_trim(&cache->first, &entries);
}

void cap_cache_release(const struct cut_lines *lines)
{
    struct entry *entry = (struct entry *)(void *)((char *)lines - offsetof(struct entry, lines));
    entry->n_uses--;
}

static bool is_same(const struct entry *a, const struct plan *plan, const struct shape_want *want,
                    const struct plane *plane)
{
    return a->kept.plan == plan && subject_equal(a->want.subject, want->subject) && a->want.detail == want->detail &&
           shape_key_equal(&a->want.key, &want->key) && plane_equal(&a->plane, plane);
}

static bool cut_shape(struct entry *entry, struct derive *derived, const struct shape *shape, bool is_full,
                      struct error *err)
{
    struct plane_reach reach = plane_reach(&entry->plane, &shape->bounds_lps_mm);
    if (!shape->mesh || reach.low_mm > rounding_mm || reach.high_mm < -rounding_mm)
        return true;
    int axis = cut_axis(&entry->plane);
    struct shape_slabs *slabs = NULL;
    if (axis >= 0 && is_full && shape->mesh->n_triangles >= MIN_INDEXED_TRIANGLES) {
        slabs = shape_slabs_get(derived, &entry->want, shape, axis, err);
        if (!slabs)
            return false;
    }
    bool is_good = cut_mesh(shape->mesh, slabs ? slabs->slabs : NULL, &entry->plane, &entry->lines, err);
    derive_result_unref(slabs ? &slabs->base : NULL);
    return is_good;
}

static bool fill(struct entry *entry, struct derive *derived, struct error *err)
{
    struct error why = { 0 };
    struct shape_facts facts = { 0 };
    struct shape *shape = derive_shape(derived, &entry->want, &facts, &why);
    bool is_good = shape ? cut_shape(entry, derived, shape, facts.reduction == 1, &why) : derive_is_refusal(why.code);
    shape_unref(shape);
    if (!is_good && err)
        *err = why;
    return is_good;
}

const struct cut_lines *cap_cache_lines(struct cap_cache *cache, struct derive *derived, const struct shape_want *want,
                                        const struct plane *plane, struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    for (struct kept **at = &cache->first; *at; at = &(*at)->next) {
        struct entry *entry = (struct entry *)*at;
        if (!is_same(entry, plan, want, plane))
            continue;
        kept_use_again(&cache->first, at);
        entry->n_uses++;
        return &entry->lines;
    }
    struct entry *made = mem_new(sizeof *made);
    *made = (struct entry){ .kept.plan = plan, .want = *want, .plane = *plane };
    if (!fill(made, derived, err)) {
        entry_destroy(&made->kept);
        return NULL;
    }
    kept_put_first(&cache->first, &made->kept);
    made->n_uses++;
    return &made->lines;
}
