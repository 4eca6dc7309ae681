#include "core/pipeline/prepare.h"

#include <stdlib.h>

#include "core/base/mem.h"

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
    const atomic_bool *cancel;
    bool has_stopped;
};

static bool go_on(void *context)
{
    struct building *building = context;
    const struct preparation *preparation = building->preparation;
    bool is_wanted = !preparation->wanted || atomic_load(preparation->wanted) == preparation->request.id;
    building->has_stopped = building->has_stopped || !is_wanted || atomic_load(building->cancel);
    return !building->has_stopped;
}

void preparation_build(struct preparation *preparation, const atomic_bool *cancel)
{
    struct building building = { preparation, cancel, false };
    derive_build_shapes(preparation->request.snapshot->derived, preparation->wants, preparation->n_wants, go_on,
                        &building);
    preparation->is_built = !building.has_stopped;
}

/* ---- what was built --------------------------------------------------------------------------------------------- */

struct prepared {
    struct shape_want wants[MAX_PREPARED];
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

static bool has(const struct prepared *prepared, const struct shape_want *want)
{
    for (size_t i = prepared->n; i-- > 0;) { /* the newest first */
        const struct shape_want *one = &prepared->wants[i];
        if (subject_equal(one->subject, want->subject) && one->detail == want->detail &&
            shape_key_equal(&one->key, &want->key))
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
