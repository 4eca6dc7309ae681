#include "core/pipeline/prepare.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* Begins anew after so many: there are regions by representations by their settings. */
enum { MAX_PREPARED = 4096 };

struct preparation *preparation_create(const struct pipeline_request *request)
{
    struct preparation *preparation = mem_new(sizeof *preparation);
    preparation->request = *request;
    preparation->wants = mem_new((request->snapshot->plan->regions.n_regions + 1) * sizeof *preparation->wants);
    preparation->n_wants = visible_wants(request->snapshot, request->render.detail, preparation->wants);
    return preparation;
}

void preparation_destroy(struct preparation *preparation)
{
    if (!preparation)
        return;
    snapshot_unref(preparation->request.snapshot);
    free(preparation->wants);
    free(preparation);
}

struct building {
    const struct preparation *preparation;
    atomic_size_t next;
};

static void build_some(void *context, int part, int n_parts)
{
    struct building *building = context;
    const struct preparation *preparation = building->preparation;
    (void)part, (void)n_parts;
    for (size_t i; (i = atomic_fetch_add(&building->next, 1)) < preparation->n_wants;) {
        const struct visible_want *want = &preparation->wants[i];
        shape_unref(plan_shape(preparation->request.snapshot->plan, want->region, &want->key, want->detail, NULL, NULL));
    }
}

void preparation_build(const struct preparation *preparation)
{
    struct building building = { .preparation = preparation };
    size_t n_threads = (size_t)parallel_cores();
    atomic_init(&building.next, 0);
    if (preparation->n_wants > 0)
        parallel_run((int)(n_threads < preparation->n_wants ? n_threads : preparation->n_wants), build_some, &building);
}

/* ---- what was built ----------------------------------------------------------------------------------------------------- */

struct prepared {
    struct visible_want wants[MAX_PREPARED];
    size_t n;
};

struct prepared *prepared_create(void)
{
    return mem_new(sizeof(struct prepared));
}

void prepared_destroy(struct prepared *prepared)
{
    free(prepared);
}

static bool has(const struct prepared *prepared, const struct visible_want *want)
{
    for (size_t i = prepared->n; i-- > 0;) { /* the newest first */
        const struct visible_want *one = &prepared->wants[i];
        if (one->region == want->region && one->detail == want->detail && shape_key_equal(&one->key, &want->key))
            return true;
    }
    return false;
}

bool prepared_has_all(const struct prepared *prepared, const struct preparation *preparation)
{
    for (size_t i = 0; i < preparation->n_wants; i++)
        if (!has(prepared, &preparation->wants[i]))
            return false;
    return true;
}

void prepared_add(struct prepared *prepared, const struct preparation *preparation)
{
    for (size_t i = 0; i < preparation->n_wants; i++) {
        if (has(prepared, &preparation->wants[i]))
            continue;
        if (prepared->n == MAX_PREPARED)
            prepared->n = 0;
        prepared->wants[prepared->n++] = preparation->wants[i];
    }
}
