#pragma once
/* The index of a shape's triangles along a patient axis, as a result of the store: for cutting it by many planes. */
#include "core/derive/shapes.h"
#include "core/surface/mesh_slabs.h"

struct shape_slabs {
    struct derive_result base;
    struct mesh_slabs *slabs;
};
/* shape: the want's, of triangles, in full detail. One reference, the caller's, dropped by
 * derive_result_unref(&result->base). errors ERROR_MEMORY */
NODISCARD struct shape_slabs *shape_slabs_get(struct derive *derive, const struct shape_want *want,
                                              const struct shape *shape, int axis, struct error *err);
