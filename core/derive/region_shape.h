#pragma once
/* Inside core/derive: shapes of regions as results of the store, by reduction. Other folders call shapes.h, which finds
 * the reduction for a level of detail. */
#include "core/derive/derive.h"
#include "core/derive/shape_facts.h"

struct region_shape_recipe {
    struct derive_recipe base; /* the subject is a region of the plan with a voxel */
    struct shape_key key;      /* normalised */
    uint32_t reduction;        /* of the mask of a surface; 1: full. Other representations: 1 */
};

struct region_shape {
    struct derive_result base;
    struct shape *shape;
    struct shape_facts facts; /* distances are not measured */
};

struct region_shape_recipe region_shape_recipe(struct subject subject, const struct shape_key *key, uint32_t reduction);
/* Returns the shape of a recipe, built on first use. One reference, the caller's, dropped by
 * derive_result_unref(&result->base). errors those of surface_make and shape_make */
NODISCARD struct region_shape *region_shape_get(struct derive *derive, const struct region_shape_recipe *recipe,
                                                struct error *err);
/* Keeps a shape that was built on the way to something else (derive_offer). Adds a reference to the shape. */
void region_shape_offer(struct derive *derive, const struct region_shape_recipe *recipe, const struct shape *shape,
                        const struct shape_facts *facts);
/* The mask that a shape is made from: the region with its descendants, or its own univels alone when the key has the
 * inner boundary. errors as mask_from_region */
NODISCARD struct mask *region_shape_mask(const struct plan *plan, struct subject subject, const struct shape_key *key,
                                         struct error *err);

/* Builds the shapes that the store does not have, one thread each, in this order; logs failures. Calls go_on before
 * each shape that the calling thread builds and stops when it returns false; NULL: never stops. */
void region_shapes_build(struct derive *derive, const struct region_shape_recipe *recipes, size_t n,
                         bool (*go_on)(void *context), void *context);
/* Sorts by the box around the region's voxels, largest first: in this order several threads end soonest. Stable. */
void region_shape_sort(const struct plan *plan, struct region_shape_recipe *recipes, size_t n);
