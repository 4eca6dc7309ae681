/* Keeps requests that wait for their shapes, and the set of shapes built before. */
#include "core/pipeline/waiting_request.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/draw_isodoses.h"

/* The set starts empty again beyond this size: a plan has as many shapes as regions times representations times their
 * settings. */
enum { MAX_BUILT_SHAPES = 4096 };

struct waiting_request *waiting_request_create(const struct pipeline_request *request)
{
    struct waiting_request *waiting = mem_new(sizeof *waiting);
    waiting->request = *request;
    waiting->wants = mem_new((2 * request->snapshot->plan->regions.n_regions + 1) * sizeof *waiting->wants);
    waiting->n_wants =
        visible_wants(request->snapshot, request->render.detail, request->render.is_still, waiting->wants);
    waiting->has_isodoses = draw_isodoses_are_wanted(request->snapshot);
    return waiting;
}

void waiting_request_destroy(struct waiting_request *waiting)
{
    if (!waiting)
        return;
    snapshot_unref(waiting->request.snapshot);
    pipeline_annotation_destroy(waiting->request.annotation);
    film_unref(waiting->request.film);
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
    draw_isodoses_build(waiting->request.snapshot, waiting->request.render.detail, go_on, &building);
    waiting->is_built = !building.has_stopped;
}

/* ---- shapes built before ----------------------------------------------------------------------------------------- */

enum { N_BUCKETS = 512, NO_SHAPE = UINT16_MAX };

struct built_shapes {
    struct shape_want wants[MAX_BUILT_SHAPES];
    uint16_t first[N_BUCKETS];       /* by the subject's hash: the newest want of the bucket, or NO_SHAPE */
    uint16_t next[MAX_BUILT_SHAPES]; /* an older want of the same bucket, or NO_SHAPE */
    size_t n;
};

static void forget_all(struct built_shapes *built)
{
    built->n = 0;
    for (size_t b = 0; b < N_BUCKETS; b++)
        built->first[b] = NO_SHAPE;
}

struct built_shapes *built_shapes_create(void)
{
    struct built_shapes *built = mem_new(sizeof *built);
    forget_all(built);
    return built;
}

void built_shapes_destroy(struct built_shapes *built)
{
    free(built);
}

static size_t bucket_of(const struct shape_want *want)
{
    return subject_hash(want->subject) % N_BUCKETS;
}

static bool has(const struct built_shapes *built, const struct shape_want *want)
{
    for (size_t i = built->first[bucket_of(want)]; i != NO_SHAPE; i = built->next[i])
        if (shape_want_equal(&built->wants[i], want))
            return true;
    return false;
}

bool built_shapes_has_all(const struct built_shapes *built, const struct waiting_request *waiting)
{
    if (waiting->has_isodoses)
        return false;
    for (size_t i = 0; i < waiting->n_wants; i++)
        if (!has(built, &waiting->wants[i]))
            return false;
    return true;
}

void built_shapes_add(struct built_shapes *built, const struct waiting_request *waiting)
{
    for (size_t i = 0; i < waiting->n_wants; i++) {
        const struct shape_want *want = &waiting->wants[i];
        if (has(built, want))
            continue;
        if (built->n == MAX_BUILT_SHAPES)
            forget_all(built);
        uint16_t *first = &built->first[bucket_of(want)];
        built->wants[built->n] = *want;
        built->next[built->n] = *first;
        *first = (uint16_t)built->n++;
    }
}
