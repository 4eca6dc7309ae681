#pragma once
/* Shapes are built before a picture is given to the render thread, on a thread of their own: so that a picture that
 * needs a new shape holds up no other, and the pictures of a view that wait for it are drawn as soon as it is there. */
#include <stdatomic.h>

#include "core/pipeline/pipeline.h"
#include "core/render/visible/visible.h"

/* A picture that waits for shapes. */
struct preparation {
    struct pipeline_request request; /* with its snapshot */
    const _Atomic uint64_t *wanted;  /* holds the request's id while the picture is wanted; NULL: it always is */
    bool is_built;                   /* all of it was built, or tried */
    struct shape_want *wants;
    size_t n_wants;
};
/* Takes request->snapshot. */
struct preparation *preparation_create(const struct pipeline_request *request);
void preparation_destroy(struct preparation *preparation);
/* Builds what is wanted, several regions at once; what fails is found again by whoever draws it. Begins no further
 * shape once the picture is not wanted any more, or *cancel. Any thread. */
void preparation_build(struct preparation *preparation, const atomic_bool *cancel);

/* What was built, or tried, before; of one plan, on the main thread. What the plan has dropped since is built by the
 * render thread. */
struct prepared;
struct prepared *prepared_create(void);
void prepared_destroy(struct prepared *prepared);
bool prepared_has_all(const struct prepared *prepared, const struct preparation *preparation);
void prepared_add(struct prepared *prepared, const struct preparation *preparation);
