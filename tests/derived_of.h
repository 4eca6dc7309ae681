#pragma once
/* The store of a plan in a test: created when it is first asked for, destroyed together with the plan. Call from one
 * thread. */
#include <assert.h>

#include "core/derive/coarse_reduction.h"
#include "core/derive/shapes.h"

enum { DERIVED_OF_MAX = 16 };
/* Weak: all files of a test program share one table. */
__attribute__((weak)) struct derive *derived_of_table[DERIVED_OF_MAX];

static inline struct derive *derived_of(const struct plan *plan)
{
    struct derive **unused = NULL;
    for (int i = 0; i < DERIVED_OF_MAX; i++) {
        if (derived_of_table[i] && derive_plan(derived_of_table[i]) == plan)
            return derived_of_table[i];
        if (!derived_of_table[i])
            unused = &derived_of_table[i];
    }
    assert(unused);
    *unused = derive_create(plan);
    return *unused;
}

static inline void plan_and_derived_destroy(struct plan *plan)
{
    for (int i = 0; i < DERIVED_OF_MAX; i++)
        if (derived_of_table[i] && derive_plan(derived_of_table[i]) == plan) {
            derive_destroy(derived_of_table[i]);
            derived_of_table[i] = NULL;
        }
    plan_destroy(plan);
}

/* The surface of a region as its mesh; one reference, the caller's. facts may be NULL. */
static inline struct mesh *surface_of(const struct plan *plan, size_t region, enum surface_algorithm algorithm,
                                      enum surface_detail detail, struct shape_facts *facts, struct error *err)
{
    const struct shape_want want = { subject_region(region),
                                     { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm },
                                     detail };
    struct shape *shape = derive_shape(derived_of(plan), &want, facts, err);
    struct mesh *mesh = shape ? mesh_ref(shape->mesh) : NULL;
    shape_unref(shape);
    return mesh;
}
