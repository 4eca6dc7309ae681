#pragma once
/* The surface around the univels of a region's coverage by a dose, as a result of the store. */
#include "core/derive/dose_coverage.h"
#include "core/derive/shape_facts.h"

/* The surface is so many of a univel's shortest edge outside, so that it is seen where the region is drawn opaque. */
#define COVERAGE_SHAPE_LIFT 0.25
struct coverage_shape {
    struct derive_result base;
    struct shape *shape;
    struct shape_facts facts; /* of the surface in its place; distances are not measured */
};

/* One reference, the caller's, dropped by derive_result_unref(&result->base). Made as a region's surface is; without
 * triangles if no univel is within the limits. Always at full detail.
 * errors  those of dose_coverage_get and surface_make
 * thread  any; uses all cores */
NODISCARD struct coverage_shape *coverage_shape_get(struct derive *derive, const struct dose_coverage_choice *choice,
                                                    enum surface_algorithm algorithm, struct error *err);
