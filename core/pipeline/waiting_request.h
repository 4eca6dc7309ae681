#pragma once
/* A request that waits for its shapes. Shapes are built on a thread of their own before the request goes to the render
 * thread: so a request that needs a new shape holds up no other, and the requests of a view that need the same shape
 * are drawn as soon as it is built. */
#include <stdatomic.h>

#include "core/pipeline/pipeline.h"
#include "core/render/visible/visible.h"

struct waiting_request {
    struct pipeline_request request; /* owned, with its snapshot, annotation and film */
    const _Atomic uint64_t *wanted;  /* holds the request's id as long as the picture is wanted; NULL: always wanted */
    bool is_built;                   /* every shape was built, or tried */
    struct shape_want *wants;        /* [n_wants], owned: the shapes that the picture needs */
    size_t n_wants;
    bool has_isodoses; /* the picture also needs isodose surfaces, or that of a coverage */
};
/* Takes request->snapshot, request->annotation and request->film. */
struct waiting_request *waiting_request_create(const struct pipeline_request *request);
void waiting_request_destroy(struct waiting_request *waiting);
/* Builds the shapes, several at once. A failure is not reported: the render thread meets it again. Begins no further
 * shape when the picture is no longer wanted, or *cancel is true. Any thread. */
void waiting_request_build_shapes(struct waiting_request *waiting, const atomic_bool *cancel);

/* The shapes that were built, or tried, for earlier requests of one plan, so that later requests need not wait. A shape
 * that the store has dropped since is built by the render thread. One thread at a time. */
struct built_shapes;
struct built_shapes *built_shapes_create(void);
void built_shapes_destroy(struct built_shapes *built);
/* True if the set has every shape that the request needs. Isodoses change with each level and weight: a request that
 * shows some always passes by the building thread, which finds in the store those that are there. */
bool built_shapes_has_all(const struct built_shapes *built, const struct waiting_request *waiting);
void built_shapes_add(struct built_shapes *built, const struct waiting_request *waiting);
