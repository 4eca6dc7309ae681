/* Builds shapes by level of detail: chooses the recipe for a wanted shape. */
#include "core/derive/shapes.h"

#include <assert.h>
#include <stdlib.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/derive/coarse_reduction.h"
#include "core/derive/region_shape.h"
#include "core/surface/shape_distance.h"

bool shape_want_equal(const struct shape_want *a, const struct shape_want *b)
{
    return subject_equal(a->subject, b->subject) && a->detail == b->detail && shape_key_equal(&a->key, &b->key);
}

/* The recipe of a wanted shape; false: there is none. */
static bool find_recipe(struct derive *derive, const struct shape_want *want, struct region_shape_recipe *recipe,
                        struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    assert(want->subject.kind == SUBJECT_REGION);
    *recipe = region_shape_recipe(want->subject, &want->key, 1);
    if (!subject_exists(derive_plan(derive), want->subject))
        return error_set(err, ERROR_RANGE, "region %zu; the plan has %zu", want->subject.index, set->n_regions);
    if (set->regions[want->subject.index].n_voxels == 0)
        return error_set(err, ERROR_RANGE, "the region \"%s\" has no voxel", set->regions[want->subject.index].name);
    if (want->detail == SURFACE_COARSE && recipe->key.representation == REPRESENTATION_SURFACE)
        recipe->reduction = coarse_reduction_get(derive, recipe->key.algorithm, err);
    return recipe->reduction > 0;
}

struct shape *derive_shape(struct derive *derive, const struct shape_want *want, struct shape_facts *facts,
                           struct error *err)
{
    struct region_shape_recipe recipe;
    struct region_shape *result =
        find_recipe(derive, want, &recipe, err) ? region_shape_get(derive, &recipe, err) : NULL;
    if (!result)
        return NULL;
    struct shape *shape = shape_ref(result->shape);
    if (facts)
        *facts = result->facts;
    derive_result_unref(&result->base);
    return shape;
}

bool derive_shape_is_ready(struct derive *derive, const struct shape_want *want)
{
    struct region_shape_recipe recipe = region_shape_recipe(want->subject, &want->key, 1);
    assert(want->detail == SURFACE_FULL);
    return derive_is_ready(derive, &recipe.base);
}

bool derive_shape_is_refused(struct derive *derive, const struct shape_want *want, struct error *why)
{
    struct region_shape_recipe recipe;
    return derive_has_refusals(derive) && find_recipe(derive, want, &recipe, why) &&
           derive_is_refused(derive, &recipe.base, why);
}

bool derive_shape_distance(const struct derive *derive, const struct shape_want *want, const struct shape *shape,
                           struct shape_facts *facts, struct error *err)
{
    const float *positions = shape->mesh    ? shape->mesh->positions_lps_mm
                             : shape->lines ? shape->lines->positions_lps_mm
                                            : shape->points->positions_lps_mm;
    size_t n = shape->mesh    ? shape->mesh->n_vertices
               : shape->lines ? shape->lines->n_vertices
                              : shape->points->n_points;
    struct shape_distance distance;
    struct mask *mask = region_shape_mask(derive_plan(derive), want->subject, &want->key, err);
    bool is_measured = mask && shape_distance(mask, positions, n, 0, &distance, err);
    mask_destroy(mask);
    if (!is_measured)
        return false;
    facts->distance_mean_mm = distance.mean_mm;
    facts->distance_max_mm = distance.max_mm;
    return true;
}

/* ---- several at once -------------------------------------------------------------------------------------------- */

/* The recipes of those that there are; the others are logged. Returns how many; free() the list. */
static size_t find_recipes(struct derive *derive, const struct shape_want *wants, size_t n,
                           struct region_shape_recipe **recipes)
{
    size_t n_found = 0;
    *recipes = mem_new((n + 1) * sizeof **recipes);
    for (size_t i = 0; i < n; i++) {
        struct error err = { 0 };
        if (find_recipe(derive, &wants[i], &(*recipes)[n_found], &err))
            n_found++;
        else
            log_warn("shape of region %zu: %s", wants[i].subject.index, err.text);
    }
    return n_found;
}

void derive_build_shapes(struct derive *derive, const struct shape_want *wants, size_t n, bool (*go_on)(void *context),
                         void *context)
{
    struct region_shape_recipe *recipes;
    if (go_on && !go_on(context))
        return;
    size_t n_recipes = find_recipes(derive, wants, n, &recipes);
    region_shapes_build(derive, recipes, n_recipes, go_on, context);
    free(recipes);
}

void derive_build_surfaces(struct derive *derive, const struct subject *subjects, size_t n,
                           enum surface_algorithm algorithm, enum surface_detail detail, bool (*go_on)(void *context),
                           void *context)
{
    struct region_shape_recipe *recipes;
    struct shape_want *wants = mem_new((n + 1) * sizeof *wants);
    for (size_t i = 0; i < n; i++)
        wants[i] = (struct shape_want){ subjects[i],
                                        { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm },
                                        detail };
    if (!go_on || go_on(context)) {
        size_t n_recipes = find_recipes(derive, wants, n, &recipes);
        region_shape_sort(derive_plan(derive), recipes, n_recipes);
        region_shapes_build(derive, recipes, n_recipes, go_on, context);
        free(recipes);
    }
    free(wants);
}
