#pragma once
/* Inside core/plan: the shapes that were built, kept by least recent use within a budget of memory. Knows nothing of
 * how a shape is built. */
#include "core/plan/plan.h"

struct shape_name {
    size_t region;
    struct shape_key key; /* normalised */
    enum surface_detail detail;
};

struct plan_shapes;

struct plan_shapes *plan_shapes_create(uint64_t budget_bytes);
void plan_shapes_destroy(struct plan_shapes *shapes);
void plan_shapes_set_budget(struct plan_shapes *shapes, uint64_t budget_bytes); /* drops what is too much at once */
void plan_shapes_usage(struct plan_shapes *shapes, struct plan_shape_usage *usage);

typedef struct shape *plan_shape_build(void *context, const struct shape_name *name, struct surface_facts *facts,
                                       struct error *err);

/* The kept shape of this name, else what build gives, which is then kept. The first who asks builds, without any lock
 * held; others wait for it. A failure is not kept, memory may come back: whoever waited tries in turn. But a refusal
 * (plan_is_refusal) is: it is given again without building. One reference, the caller's. */
NODISCARD struct shape *plan_shapes_get(struct plan_shapes *shapes, const struct shape_name *name,
                                        plan_shape_build *build, void *context, struct surface_facts *facts,
                                        struct error *err);
/* Whether a shape of this name was refused; fills why. */
bool plan_shapes_refused(struct plan_shapes *shapes, const struct shape_name *name, struct error *why);
/* Whether any was. */
bool plan_shapes_refused_some(struct plan_shapes *shapes);
/* Whether it is kept, being built, or refused. It may be gone by the time it is asked for. */
bool plan_shapes_has(struct plan_shapes *shapes, const struct shape_name *name);
/* Keeps a shape that was built on the way to something else, unless there is one of its name. Takes a reference of its
 * own. */
void plan_shapes_offer(struct plan_shapes *shapes, const struct shape_name *name, const struct shape *shape,
                       const struct surface_facts *facts);

/* The reduction that the light surfaces by one algorithm have in common: decide() gives it, once, 0 when it fails. */
NODISCARD uint32_t plan_shapes_reduction(struct plan_shapes *shapes, enum surface_algorithm algorithm,
                                         uint32_t (*decide)(void *context, struct error *err), void *context,
                                         struct error *err);
