/* Surfaces of regions: full ones, and lighter ones of the whole plan for moving pictures. */
#include "core/plan/plan_surface.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/plan/plan_masks.h"
#include "core/plan/plan_shapes.h"
#include "core/region/mask.h"
#include "core/surface/surface.h"

enum { MAX_REDUCTION = MASK_MAX_FACTOR };

static struct mesh *extract(enum surface_algorithm algorithm, const struct mask *mask, int n_threads, struct error *err)
{
    struct surface_options options = surface_defaults;
    options.n_threads = n_threads;
    struct mesh *mesh = surface_make(algorithm, mask, &options, err);
    if (mesh && !mesh->normals && !mesh_make_normals(mesh, n_threads, err)) {
        mesh_unref(mesh);
        return NULL;
    }
    return mesh;
}

/* Takes the mesh. The univels are those of the unreduced mask. */
static struct shape *shape_of(struct mesh *mesh, const struct mask *full, uint32_t reduction, int64_t started_us,
                              struct surface_facts *facts)
{
    struct shape *shape = mem_new(sizeof *shape);
    atomic_init(&shape->references, 1);
    shape->kind = SHAPE_TRIANGLES;
    shape->mesh = mesh;
    shape->bounds_lps_mm = mesh->bounds_lps_mm;
    shape->n_bytes =
        sizeof *shape + sizeof *mesh + mesh->n_vertices * 6 * sizeof(float) + mesh->n_triangles * 3 * sizeof(uint32_t);
    *facts = (struct surface_facts){ .n_univels = mask_count(full), .reduction = reduction };
    facts->univel_volume_mm3 = (double)facts->n_univels * fabs(affine_determinant(&full->lps_mm_from_ijk));
    plan_count_shape(shape, facts);
    facts->build_ms = (double)(clock_now_us() - started_us) / 1000;
    return shape;
}

struct shape *plan_build_surface(const struct mask *mask, enum surface_algorithm algorithm, int n_threads,
                                 struct surface_facts *facts, struct error *err)
{
    int64_t started_us = clock_now_us();
    struct mesh *mesh = extract(algorithm, mask, n_threads, err);
    return mesh ? shape_of(mesh, mask, 1, started_us, facts) : NULL;
}

/* How many voxels become one along each axis: as many along the shortest as the reduction says, along others only as
 * many as make them no longer than that. So thick slices are not thinned before the pixels within them are as large. */
static void factors_of(const struct mask *mask, uint32_t reduction, uint32_t factors[3])
{
    double edge_mm[3], shortest = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        edge_mm[axis] = vec3_length(mask->lps_mm_from_ijk.columns[axis]);
        shortest = fmin(shortest, edge_mm[axis]);
    }
    for (int axis = 0; axis < 3; axis++) {
        double fits = floor(reduction * shortest / edge_mm[axis] + 1e-6);
        factors[axis] = fits < 1 ? 1 : fits > reduction ? reduction : (uint32_t)fits;
    }
}

/* A small region that the 8-cell algorithm does not draw when reduced so far is reduced less: it must not vanish in
 * motion. */
struct shape *plan_build_light_surface(const struct mask *full, enum surface_algorithm algorithm, uint32_t reduction,
                                       struct surface_facts *facts, struct error *err)
{
    int64_t started_us = clock_now_us();
    struct shape *shape = NULL;
    for (uint32_t taken = reduction; !shape && taken > 0; taken--) {
        uint32_t factors[3];
        factors_of(full, taken, factors);
        struct mask *reduced = taken > 1 ? mask_reduce(full, factors, 1, err) : NULL;
        struct mesh *mesh = taken == 1 || reduced ? extract(algorithm, reduced ? reduced : full, 1, err) : NULL;
        mask_destroy(reduced);
        if (!mesh)
            break;
        if (mesh->n_triangles > 0 || taken == 1)
            shape = shape_of(mesh, full, taken, started_us, facts);
        else
            mesh_unref(mesh);
    }
    return shape;
}

/* ---- one reduction for the whole plan, so all of it is decided at once ------------------------------------------ */

/* What the reductions tried so far give, for one region. */
struct ladder {
    struct shape *shape[MAX_REDUCTION + 1];
    struct surface_facts facts[MAX_REDUCTION + 1];
};

struct lighting {
    struct plan *plan;
    enum surface_algorithm algorithm;
    struct ladder *ladders; /* [n_regions] */
    bool is_tried[MAX_REDUCTION + 1];
    uint32_t factor;          /* being tried */
    struct plan_masks *masks; /* of all regions, in their order */
    atomic_size_t next;
    atomic_bool is_failed;
};

static void reduce_some(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct lighting *lighting = context;
    const struct region_set *set = &lighting->plan->regions;
    for (size_t r; (r = atomic_fetch_add(&lighting->next, 1)) < set->n_regions;) {
        struct ladder *ladder = &lighting->ladders[r];
        if (set->regions[r].n_voxels == 0)
            continue;
        struct mask *mask = plan_masks_take(lighting->masks, r, NULL);
        if (mask)
            ladder->shape[lighting->factor] = plan_build_light_surface(mask, lighting->algorithm, lighting->factor,
                                                                       &ladder->facts[lighting->factor], NULL);
        mask_destroy(mask);
        if (!ladder->shape[lighting->factor])
            atomic_store(&lighting->is_failed, true);
    }
}

/* Triangles of the whole plan at a reduction; several regions are worked on at once. */
static size_t triangles_at(struct lighting *lighting, uint32_t factor)
{
    size_t n_regions = lighting->plan->regions.n_regions, n = 0;
    int n_threads = parallel_cores();
    if (!lighting->is_tried[factor]) {
        struct mask_wish *wishes = mem_new((n_regions + 1) * sizeof *wishes);
        for (size_t r = 0; r < n_regions; r++)
            wishes[r] = (struct mask_wish){ r, false };
        lighting->factor = factor;
        lighting->masks = plan_masks_create(lighting->plan, wishes, n_regions, PLAN_MASKS_BYTES);
        free(wishes);
        atomic_store(&lighting->next, 0);
        parallel_run((size_t)n_threads < n_regions ? n_threads : (int)n_regions, reduce_some, lighting);
        plan_masks_destroy(lighting->masks);
        lighting->is_tried[factor] = true;
    }
    for (size_t r = 0; r < n_regions; r++)
        n += lighting->ladders[r].shape[factor] ? lighting->ladders[r].shape[factor]->mesh->n_triangles : 0;
    return n;
}

/* The smallest reduction from 2 on that is light enough, or the largest. Triangles fall with the square of it, so the
 * search starts where that law says. */
static uint32_t find_reduction(struct lighting *lighting, size_t n_at_two)
{
    if (n_at_two <= PLAN_LIGHT_TRIANGLES)
        return 2;
    double guess = 2 * sqrt((double)n_at_two / PLAN_LIGHT_TRIANGLES);
    uint32_t factor = guess < 3 ? 3 : guess > MAX_REDUCTION ? MAX_REDUCTION : (uint32_t)guess;
    while (factor < MAX_REDUCTION && triangles_at(lighting, factor) > PLAN_LIGHT_TRIANGLES)
        factor++;
    (void)triangles_at(lighting, factor);
    while (factor > 3 && triangles_at(lighting, factor - 1) <= PLAN_LIGHT_TRIANGLES)
        factor--;
    return factor;
}

/* Whether the full surfaces are already light enough. Halving the grid quarters the triangles, so they are only built
 * when the first step of the ladder promises that. */
static bool full_is_light(struct plan *plan, enum surface_algorithm algorithm, size_t n_at_two)
{
    size_t n = 0, n_regions = plan->regions.n_regions, n_drawn = 0;
    if (n_at_two > PLAN_LIGHT_TRIANGLES / 3)
        return false;
    size_t *regions = mem_new((n_regions + 1) * sizeof *regions);
    for (size_t r = 0; r < n_regions; r++)
        if (plan->regions.regions[r].n_voxels > 0)
            regions[n_drawn++] = r;
    plan_build_surfaces(plan, regions, n_drawn, algorithm, SURFACE_FULL, NULL, NULL);
    free(regions);
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        if (plan->regions.regions[r].n_voxels == 0)
            continue;
        struct mesh *mesh = plan_surface(plan, r, algorithm, SURFACE_FULL, NULL, NULL);
        if (!mesh)
            return false;
        n += mesh->n_triangles;
        mesh_unref(mesh);
    }
    return n <= PLAN_LIGHT_TRIANGLES;
}

struct decision {
    struct plan *plan;
    enum surface_algorithm algorithm;
};

static uint32_t decide(void *context, struct error *err)
{
    const struct decision *decision = context;
    struct plan *plan = decision->plan;
    size_t n_regions = plan->regions.n_regions;
    struct lighting lighting = {
        .plan = plan,
        .algorithm = decision->algorithm,
        .ladders = mem_new((n_regions + 1) * sizeof *lighting.ladders),
    };
    atomic_init(&lighting.next, 0);
    atomic_init(&lighting.is_failed, false);
    size_t n_at_two = triangles_at(&lighting, 2);
    uint32_t factor = full_is_light(plan, decision->algorithm, n_at_two) ? 1 : find_reduction(&lighting, n_at_two);
    bool is_built = !atomic_load(&lighting.is_failed);
    for (size_t r = 0; r < n_regions; r++) {
        struct ladder *ladder = &lighting.ladders[r];
        struct shape_name name = { r,
                                   { .representation = REPRESENTATION_SURFACE, .algorithm = decision->algorithm },
                                   SURFACE_LIGHT };
        shape_key_normalise(&name.key);
        if (is_built && factor > 1 && ladder->shape[factor])
            plan_shapes_offer(plan->shapes, &name, ladder->shape[factor], &ladder->facts[factor]);
        for (uint32_t step = 2; step <= MAX_REDUCTION; step++)
            shape_unref(ladder->shape[step]);
    }
    free(lighting.ladders);
    if (!is_built)
        error_set(err, ERROR_MEMORY, "no memory for the lighter surfaces");
    return is_built ? factor : 0;
}

uint32_t plan_light_reduction(struct plan *plan, enum surface_algorithm algorithm, struct error *err)
{
    return plan_shapes_reduction(plan->shapes, algorithm, decide, &(struct decision){ plan, algorithm }, err);
}
