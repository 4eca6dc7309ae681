/* Requests that wait for their shapes, and the set of shapes built before. */
#include "core/pipeline/waiting_request.h"

#include <stdlib.h>

#include "core/base/mem.h"

/* The set starts empty again beyond this size: a plan has as many shapes as regions times representations times their
 * settings. */
enum { MAX_BUILT_SHAPES = 4096 };

struct waiting_request *waiting_request_create(const struct pipeline_request *request)
{
    struct waiting_request *waiting = mem_new(sizeof *waiting);
    waiting->request = *request;
    waiting->wants = mem_new((request->snapshot->plan->regions.n_regions + 1) * sizeof *waiting->wants);
    waiting->n_wants = visible_wants(request->snapshot, request->render.detail, waiting->wants);
    return waiting;
}

void waiting_request_destroy(struct waiting_request *waiting)
{
    if (!waiting)
        return;
    snapshot_unref(waiting->request.snapshot);
    free(waiting->wants);
    free(waiting);
}

struct building {
    const struct waiting_request *waiting;
    const atomic_bool *cancel;
    bool has_stopped;
};

static bool go_on(void *context)
{
    struct building *building = context;
    const struct waiting_request *waiting = building->waiting;
    bool is_wanted = !waiting->wanted || atomic_load(waiting->wanted) == waiting->request.id;
    building->has_stopped = building->has_stopped || !is_wanted || atomic_load(building->cancel);
    return !building->has_stopped;
}

void waiting_request_build_shapes(struct waiting_request *waiting, const atomic_bool *cancel)
{
    struct building building = { waiting, cancel, false };
    derive_build_shapes(waiting->request.snapshot->derived, waiting->wants, waiting->n_wants, go_on, &building);
    waiting->is_built = !building.has_stopped;
}

/* ---- shapes built before ----------------------------------------------------------------------------------------- */

struct built_shapes {
    struct shape_want wants[MAX_BUILT_SHAPES];
    size_t n;
};

struct built_shapes *built_shapes_create(void)
{
    return mem_new(sizeof(struct built_shapes));
}

void built_shapes_destroy(struct built_shapes *built)
{
    free(built);
}

static bool has(const struct built_shapes *built, const struct shape_want *want)
{
    for (size_t i = built->n; i-- > 0;) /* the newest first */
        if (shape_want_equal(&built->wants[i], want))
            return true;
    return false;
}

bool built_shapes_has_all(const struct built_shapes *built, const struct waiting_request *waiting)
{
    for (size_t i = 0; i < waiting->n_wants; i++)
        if (!has(built, &waiting->wants[i]))
            return false;
    return true;
}

void built_shapes_add(struct built_shapes *built, const struct waiting_request *waiting)
{
    for (size_t i = 0; i < waiting->n_wants; i++) {
        if (has(built, &waiting->wants[i]))
            continue;
        if (built->n == MAX_BUILT_SHAPES)
            built->n = 0;
        built->wants[built->n++] = waiting->wants[i];
    }
}
