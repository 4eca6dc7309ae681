/* Makes the surface around the univels of a region's coverage. */
#include "core/derive/coverage_shape.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/region_surface.h"

struct coverage_shape_recipe {
    struct derive_recipe base;
    struct dose_coverage_choice choice;
    enum surface_algorithm algorithm;
};

static bool is_equal(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct coverage_shape_recipe *a = (const struct coverage_shape_recipe *)left,
                                       *b = (const struct coverage_shape_recipe *)right;
    return a->algorithm == b->algorithm && memcmp(&a->choice, &b->choice, sizeof a->choice) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    struct coverage_shape *result = (struct coverage_shape *)base;
    shape_unref(result->shape);
    free(result);
}

static const struct derive_kind kind = { sizeof(struct coverage_shape_recipe), is_equal, build, destroy };

static struct shape *empty_shape(struct error *err)
{
    struct shape *shape = mem_new(sizeof *shape);
    atomic_init(&shape->references, 1);
    shape->kind = SHAPE_TRIANGLES;
    shape->bounds_lps_mm = box3_empty();
    shape->mesh = mesh_create(0, 0, err);
    if (shape->mesh)
        return shape;
    shape_unref(shape);
    return NULL;
}

/* Moves the vertices outwards: the surface is seen also where it coincides with that of the region, drawn opaque. The
 * shape is not published yet. */
static void lift(struct shape *shape, double mm)
{
    struct mesh *mesh = shape->mesh;
    for (size_t at = 0; at < 3 * mesh->n_vertices; at++)
        mesh->positions_lps_mm[at] += (float)mm * mesh->normals[at];
    mesh_measure_bounds(mesh);
    shape->bounds_lps_mm = mesh->bounds_lps_mm;
}

static struct shape *surface_of(const struct dose_coverage *coverage, enum surface_algorithm algorithm,
                                struct shape_facts *facts, struct error *err)
{
    if (coverage->n == 0)
        return empty_shape(err);
    struct mask *mask = mask_from_labels(coverage->labels, (const uint16_t[]){ 1 }, 1, parallel_cores(), err);
    struct shape *shape = mask ? region_surface_build(mask, algorithm, parallel_cores(), facts, err) : NULL;
    mask_destroy(mask);
    struct vec3 edge_mm = grid_spacing_mm(&coverage->labels->grid);
    if (shape)
        lift(shape, COVERAGE_SHAPE_LIFT * fmin(edge_mm.x, fmin(edge_mm.y, edge_mm.z)));
    return shape;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct coverage_shape_recipe *recipe = (const struct coverage_shape_recipe *)base;
    struct shape_facts facts = { .reduction = 1, .distance_mean_mm = NAN, .distance_max_mm = NAN };
    (void)way;
    struct dose_coverage *coverage = dose_coverage_get(derive, &recipe->choice, err);
    struct shape *shape = coverage ? surface_of(coverage, recipe->algorithm, &facts, err) : NULL;
    if (coverage)
        derive_result_unref(&coverage->base);
    if (!shape)
        return NULL;
    struct coverage_shape *result = mem_new(sizeof *result);
    derive_result_init(&result->base, &kind, shape->n_bytes + sizeof *result);
    result->shape = shape;
    result->facts = facts;
    return &result->base;
}

struct coverage_shape *coverage_shape_get(struct derive *derive, const struct dose_coverage_choice *choice,
                                          enum surface_algorithm algorithm, struct error *err)
{
    struct coverage_shape_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base = (struct derive_recipe){ &kind, { SUBJECT_REGION, choice->region, 0 } };
    recipe.choice = *choice;
    recipe.algorithm = algorithm;
    return (struct coverage_shape *)derive_get(derive, &recipe.base, NULL, err);
}
