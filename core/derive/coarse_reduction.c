/* Finds the reduction that all coarse surfaces of a plan share, and keeps it as a result. */
#include "core/derive/coarse_reduction.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/region_masks.h"
#include "core/derive/region_shape.h"
#include "core/derive/region_surface.h"

enum { MAX_REDUCTION = REGION_SURFACE_MAX_REDUCTION };

struct recipe {
    struct derive_recipe base; /* the subject is the plan */
    enum surface_algorithm algorithm;
};

struct result {
    struct derive_result base;
    uint32_t reduction;
};

/* ---- trying reductions ------------------------------------------------------------------------------------------ */

/* The coarse surfaces of one region, by reduction; NULL: not tried, or failed. */
struct ladder {
    struct shape *shape[MAX_REDUCTION + 1];
    struct shape_facts facts[MAX_REDUCTION + 1];
};

struct search {
    struct derive *derive;
    const struct region_set *set;
    enum surface_algorithm algorithm;
    struct ladder *ladders; /* [n_regions] */
    bool is_tried[MAX_REDUCTION + 1];
    uint32_t factor;            /* the reduction that is tried */
    struct region_masks *masks; /* of all regions, in their order */
    atomic_size_t next;
    atomic_bool is_failed;
};

static void reduce_some(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct search *search = context;
    for (size_t r; (r = atomic_fetch_add(&search->next, 1)) < search->set->n_regions;) {
        struct ladder *ladder = &search->ladders[r];
        if (search->set->regions[r].n_voxels == 0)
            continue;
        struct mask *mask = region_masks_take(search->masks, r, NULL);
        if (mask)
            ladder->shape[search->factor] = region_surface_build_coarse(mask, search->algorithm, search->factor,
                                                                        &ladder->facts[search->factor], NULL);
        mask_destroy(mask);
        if (!ladder->shape[search->factor])
            atomic_store(&search->is_failed, true);
    }
}

/* Triangles of the whole plan at a reduction; several regions are worked on at once. */
static size_t triangles_at(struct search *search, uint32_t factor)
{
    size_t n_regions = search->set->n_regions, n = 0;
    int n_threads = parallel_cores();
    if (!search->is_tried[factor]) {
        struct mask_wish *wishes = mem_new((n_regions + 1) * sizeof *wishes);
        for (size_t r = 0; r < n_regions; r++)
            wishes[r] = (struct mask_wish){ r, false };
        search->factor = factor;
        search->masks = region_masks_create(derive_plan(search->derive), wishes, n_regions, REGION_MASKS_BYTES);
        free(wishes);
        atomic_store(&search->next, 0);
        parallel_run((size_t)n_threads < n_regions ? n_threads : (int)n_regions, reduce_some, search);
        region_masks_destroy(search->masks);
        search->is_tried[factor] = true;
    }
    for (size_t r = 0; r < n_regions; r++)
        n += search->ladders[r].shape[factor] ? search->ladders[r].shape[factor]->mesh->n_triangles : 0;
    return n;
}

/* The smallest reduction from 2 on that keeps the limit, or the largest. The number of triangles falls with the square
 * of the reduction, so the search starts where that law says. */
static uint32_t find_reduction(struct search *search, size_t n_at_two)
{
    if (n_at_two <= COARSE_MAX_TRIANGLES)
        return 2;
    double guess = 2 * sqrt((double)n_at_two / COARSE_MAX_TRIANGLES);
    uint32_t factor = guess < 3 ? 3 : guess > MAX_REDUCTION ? MAX_REDUCTION : (uint32_t)guess;
    while (factor < MAX_REDUCTION && triangles_at(search, factor) > COARSE_MAX_TRIANGLES)
        factor++;
    (void)triangles_at(search, factor);
    while (factor > 3 && triangles_at(search, factor - 1) <= COARSE_MAX_TRIANGLES)
        factor--;
    return factor;
}

/* ---- full surfaces ---------------------------------------------------------------------------------------------- */

/* Full surfaces of all regions with a voxel; returns how many recipes. */
static size_t full_recipes(const struct search *search, struct region_shape_recipe *recipes)
{
    const struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = search->algorithm };
    size_t n = 0;
    for (size_t r = 0; r < search->set->n_regions; r++)
        if (search->set->regions[r].n_voxels > 0)
            recipes[n++] = region_shape_recipe(subject_region(r), &key, 1);
    region_shape_sort(derive_plan(search->derive), recipes, n);
    return n;
}

/* True if the full surfaces keep the limit. Halving the grid quarters the triangles, so the full surfaces are only
 * built when those at a reduction of 2 promise that. */
static bool full_is_enough(struct search *search, size_t n_at_two)
{
    if (n_at_two > COARSE_MAX_TRIANGLES / 3)
        return false;
    struct region_shape_recipe *recipes = mem_new((search->set->n_regions + 1) * sizeof *recipes);
    size_t n_recipes = full_recipes(search, recipes), n = 0;
    bool is_built = true;
    region_shapes_build(search->derive, recipes, n_recipes, NULL, NULL);
    for (size_t i = 0; is_built && i < n_recipes; i++) {
        struct error err = { 0 };
        struct region_shape *full = region_shape_get(search->derive, &recipes[i], &err);
        is_built = full != NULL;
        if (!full && !derive_is_refusal(err.code)) /* only a refusal is final; memory may be there later */
            atomic_store(&search->is_failed, true);
        if (full) {
            n += full->facts.n_triangles;
            derive_result_unref(&full->base);
        }
    }
    free(recipes);
    return is_built && n <= COARSE_MAX_TRIANGLES;
}

/* ---- the kind --------------------------------------------------------------------------------------------------- */

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return ((const struct recipe *)a)->algorithm == ((const struct recipe *)b)->algorithm;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    free(base);
}

static const struct derive_kind kind = { sizeof(struct recipe), is_equal, build, destroy };

/* Keeps those surfaces of the search that have the reduction found: pictures will request them. */
static void keep_surfaces(struct search *search, uint32_t factor)
{
    const struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = search->algorithm };
    for (size_t r = 0; r < search->set->n_regions; r++) {
        const struct ladder *ladder = &search->ladders[r];
        struct region_shape_recipe recipe = region_shape_recipe(subject_region(r), &key, factor);
        if (factor > 1 && ladder->shape[factor])
            region_shape_offer(search->derive, &recipe, ladder->shape[factor], &ladder->facts[factor]);
    }
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    (void)way;
    const struct region_set *set = &derive_plan(derive)->regions;
    struct search search = {
        .derive = derive,
        .set = set,
        .algorithm = ((const struct recipe *)base)->algorithm,
        .ladders = mem_new((set->n_regions + 1) * sizeof *search.ladders),
    };
    atomic_init(&search.next, 0);
    atomic_init(&search.is_failed, false);
    size_t n_at_two = triangles_at(&search, 2);
    uint32_t factor = full_is_enough(&search, n_at_two) ? 1 : find_reduction(&search, n_at_two);
    bool is_built = !atomic_load(&search.is_failed);
    if (is_built)
        keep_surfaces(&search, factor);
    for (size_t r = 0; r < set->n_regions; r++)
        for (uint32_t step = 2; step <= MAX_REDUCTION; step++)
            shape_unref(search.ladders[r].shape[step]);
    free(search.ladders);
    if (!is_built) {
        error_set(err, ERROR_MEMORY, "no memory for the coarse surfaces");
        return NULL;
    }
    struct result *result = mem_new(sizeof *result);
    derive_result_init(&result->base, &kind, 0);
    result->reduction = factor;
    return &result->base;
}

uint32_t coarse_reduction_get(struct derive *derive, enum surface_algorithm algorithm, struct error *err)
{
    const struct recipe recipe = { { &kind, subject_plan() }, algorithm };
    struct result *result = (struct result *)derive_get(derive, &recipe.base, NULL, err);
    uint32_t reduction = result ? result->reduction : 0;
    derive_result_unref(result ? &result->base : NULL);
    return reduction;
}
