/* Makes the masks of many regions from few sweeps over the labels: the wishes are cut into runs, one sweep each. */
#include "core/derive/region_masks.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/once_cache.h"

/* The masks of wishes first to first + n - 1. */
struct run {
    _Atomic int references;
    size_t first, n;
    _Atomic(struct mask *) masks[]; /* [n]; NULL: taken */
};

struct region_masks {
    const struct plan *plan;
    size_t n;
    struct mask_wish *wishes; /* [n] */
    size_t *run_of;           /* [n]: for each wish, the first wish of its run */
    struct once_cache *runs;  /* by their first wish */
};

/* ---- runs, for the cache ---------------------------------------------------------------------------------------- */

static bool key_is_equal(const void *a, const void *b)
{
    return *(const size_t *)a == *(const size_t *)b;
}

static void run_ref(void *run)
{
    atomic_fetch_add(&((struct run *)run)->references, 1);
}

static void run_unref(void *argument)
{
    struct run *run = argument;
    if (atomic_fetch_sub(&run->references, 1) != 1)
        return;
    for (size_t i = 0; i < run->n; i++)
        mask_destroy(atomic_load(&run->masks[i]));
    free(run);
}

static uint64_t run_bytes(const void *run)
{
    (void)run;
    return 0; /* kept until region_masks_destroy */
}

static const struct once_cache_type runs_type = { key_is_equal, run_ref, run_unref, run_bytes, NULL };

/* ---- cutting into runs ------------------------------------------------------------------------------------------ */

static uint64_t bytes_of(const struct plan *plan, const struct mask_wish *wish)
{
    const struct region_set *set = &plan->regions;
    const uint32_t *size = set->layers[set->regions[wish->region].layer]->grid.size;
    return (uint64_t)((size[0] + 63) / 64) * sizeof(uint64_t) * size[1] * size[2];
}

struct region_masks *region_masks_create(const struct plan *plan, const struct mask_wish *wishes, size_t n,
                                         uint64_t most_bytes)
{
    struct region_masks *masks = mem_new(sizeof *masks);
    uint64_t n_bytes = 0;
    masks->plan = plan;
    masks->n = n;
    masks->wishes = mem_new((n + 1) * sizeof *wishes); /* a wish a region of the plan */
    masks->run_of = mem_new((n + 1) * sizeof *masks->run_of);
    memcpy(masks->wishes, wishes, n * sizeof *wishes);
    for (size_t w = 0, first = 0; w < n; w++) {
        n_bytes += bytes_of(plan, &wishes[w]);
        if (w > first && n_bytes > most_bytes) {
            first = w;
            n_bytes = bytes_of(plan, &wishes[w]);
        }
        masks->run_of[w] = first;
    }
    masks->runs = once_cache_create(&runs_type, UINT64_MAX);
    return masks;
}

void region_masks_destroy(struct region_masks *masks)
{
    if (!masks)
        return;
    once_cache_destroy(masks->runs);
    free(masks->wishes);
    free(masks->run_of);
    free(masks);
}

/* ---- sweeping --------------------------------------------------------------------------------------------------- */

struct sweep {
    const struct region_masks *masks;
    size_t first;
};

static void *make_run(void *context, struct error *err)
{
    const struct sweep *sweep = context;
    const struct region_masks *masks = sweep->masks;
    size_t n = 0;
    while (sweep->first + n < masks->n && masks->run_of[sweep->first + n] == sweep->first)
        n++;
    struct run *run = mem_new(sizeof *run + n * sizeof run->masks[0]);
    struct mask **made = mem_new(n * sizeof *made);
    bool is_made = mask_sweep(&masks->plan->regions, masks->wishes + sweep->first, n, 0, made, err);
    atomic_init(&run->references, 1);
    run->first = sweep->first;
    run->n = n;
    for (size_t i = 0; i < n; i++)
        atomic_init(&run->masks[i], is_made ? made[i] : NULL);
    free(made);
    if (!is_made)
        free(run);
    return is_made ? run : NULL;
}

struct mask *region_masks_take(struct region_masks *masks, size_t wish, struct error *err)
{
    size_t first = masks->run_of[wish];
    struct once_key key = { &first, sizeof first, first };
    struct sweep sweep = { masks, first };
    struct run *run = once_cache_get(masks->runs, &key, make_run, &sweep, err);
    if (!run)
        return NULL;
    struct mask *mask = atomic_exchange(&run->masks[wish - first], NULL);
    run_unref(run);
    if (!mask && !mask_sweep(&masks->plan->regions, &masks->wishes[wish], 1, 0, &mask, err))
        return NULL;
    return mask;
}
