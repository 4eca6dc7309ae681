#include <math.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/plan/plan_meshes.h"
#include "core/region/mask.h"
#include "core/surface/surface.h"

enum { MAX_REDUCTION = 8 };

static struct mesh *extract(enum surface_algorithm algorithm, const struct mask *mask, int n_threads, struct error *err)
{
    struct surface_options options = surface_defaults;
    options.n_threads = n_threads;
    struct mesh *mesh = surface_make(algorithm, mask, &options, err);
    if (mesh && !mesh_make_normals(mesh, n_threads, err)) {
        mesh_unref(mesh);
        return NULL;
    }
    return mesh;
}

/* The univel volume is that of the unreduced mask. */
static void fill_facts(struct surface_facts *facts, const struct mesh *mesh, const struct mask *full, uint32_t reduction,
                       int64_t started_us)
{
    facts->n_triangles = mesh->n_triangles;
    facts->n_vertices = mesh->n_vertices;
    facts->area_mm2 = mesh_area_mm2(mesh);
    facts->volume_mm3 = mesh_volume_mm3(mesh);
    facts->n_univels = mask_count(full);
    facts->univel_volume_mm3 = (double)facts->n_univels * fabs(affine_determinant(&full->lps_mm_from_ijk));
    facts->reduction = reduction;
    facts->build_ms = (double)(clock_now_us() - started_us) / 1000;
}

static struct mesh *build_full(const struct plan *plan, size_t region, enum surface_algorithm algorithm, struct surface_facts *facts,
                               struct error *err)
{
    int64_t started_us = clock_now_us();
    int n_threads = parallel_cores();
    struct mask *mask = mask_from_region(&plan->regions, region, n_threads, err);
    if (!mask)
        return NULL;
    struct mesh *mesh = extract(algorithm, mask, n_threads, err);
    if (mesh)
        fill_facts(facts, mesh, mask, 1, started_us);
    mask_destroy(mask);
    if (!mesh && err)
        error_prefix(err, "region \"%s\"", plan->regions.regions[region].name);
    return mesh;
}

/* The first caller builds under the slot's own lock; others wait for it. A failure is not kept: memory may come back. */
static struct mesh *full_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm, struct surface_facts *facts,
                                 struct error *err)
{
    struct plan_mesh *slot = &plan->meshes->of_region[region][algorithm][SURFACE_FULL];
    pthread_mutex_lock(&slot->lock);
    if (!slot->mesh)
        slot->mesh = build_full(plan, region, algorithm, &slot->facts, err);
    struct mesh *mesh = slot->mesh ? mesh_ref(slot->mesh) : NULL;
    *facts = slot->facts;
    pthread_mutex_unlock(&slot->lock);
    return mesh;
}

/* ---- light surfaces: one reduction for the whole plan, so all of it is decided at once ---------------------------------- */

/* What the reductions tried so far give, for one region. */
struct ladder {
    struct mesh *mesh[MAX_REDUCTION + 1];
    struct surface_facts facts[MAX_REDUCTION + 1];
};

struct lighting {
    const struct plan *plan;
    enum surface_algorithm algorithm;
    struct ladder *ladders; /* [n_regions] */
    bool is_tried[MAX_REDUCTION + 1];
    uint32_t factor; /* being tried */
    atomic_size_t next;
    atomic_bool is_failed;
};

static struct mesh *extract_reduced(enum surface_algorithm algorithm, const struct mask *full, uint32_t factor)
{
    struct mask *mask = factor > 1 ? mask_reduce(full, factor, 1, NULL) : NULL;
    struct mesh *mesh = factor == 1 || mask ? extract(algorithm, mask ? mask : full, 1, NULL) : NULL;
    mask_destroy(mask);
    return mesh;
}

/* A small region that the 8-cell algorithm does not draw when reduced so far is reduced less: it must not vanish in motion. */
static bool reduce_region(const struct plan *plan, size_t region, enum surface_algorithm algorithm, uint32_t factor,
                          struct ladder *ladder)
{
    int64_t started_us = clock_now_us();
    if (plan->regions.regions[region].n_voxels == 0)
        return true;
    struct mask *full = mask_from_region(&plan->regions, region, 1, NULL);
    uint32_t taken = factor;
    struct mesh *mesh = full ? extract_reduced(algorithm, full, taken) : NULL;
    while (mesh && mesh->n_triangles == 0 && taken > 1) {
        mesh_unref(mesh);
        mesh = extract_reduced(algorithm, full, --taken);
    }
    if (mesh)
        fill_facts(&ladder->facts[factor], mesh, full, taken, started_us);
    ladder->mesh[factor] = mesh;
    mask_destroy(full);
    return mesh != NULL;
}

static void reduce_some(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct lighting *lighting = context;
    for (size_t r; (r = atomic_fetch_add(&lighting->next, 1)) < lighting->plan->regions.n_regions;)
        if (!reduce_region(lighting->plan, r, lighting->algorithm, lighting->factor, &lighting->ladders[r]))
            atomic_store(&lighting->is_failed, true);
}

/* Triangles of the whole plan at a reduction; several regions are worked on at once. */
static size_t triangles_at(struct lighting *lighting, uint32_t factor)
{
    size_t n_regions = lighting->plan->regions.n_regions, n = 0;
    int n_threads = parallel_cores();
    if (!lighting->is_tried[factor]) {
        lighting->factor = factor;
        atomic_store(&lighting->next, 0);
        parallel_run((size_t)n_threads < n_regions ? n_threads : (int)n_regions, reduce_some, lighting);
        lighting->is_tried[factor] = true;
    }
    for (size_t r = 0; r < n_regions; r++)
        n += lighting->ladders[r].facts[factor].n_triangles;
    return n;
}

/* The smallest reduction from 2 on that is light enough, or the largest. Triangles fall with the square of it, so the search
 * starts where that law says. */
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

/* Whether the full surfaces are already light enough. Halving the grid quarters the triangles, so they are only built when
 * the first step of the ladder promises that. */
static bool full_is_light(struct plan *plan, enum surface_algorithm algorithm, size_t n_at_two)
{
    size_t n = 0;
    if (n_at_two > PLAN_LIGHT_TRIANGLES / 3)
        return false;
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        struct surface_facts facts;
        if (plan->regions.regions[r].n_voxels == 0)
            continue;
        struct mesh *mesh = full_surface(plan, r, algorithm, &facts, NULL);
        if (!mesh)
            return false;
        mesh_unref(mesh);
        n += facts.n_triangles;
    }
    return n <= PLAN_LIGHT_TRIANGLES;
}

/* Under the algorithm's lock. */
static bool build_light(struct plan *plan, enum surface_algorithm algorithm, struct error *err)
{
    size_t n_regions = plan->regions.n_regions;
    struct lighting lighting = { .plan = plan, .algorithm = algorithm, .ladders = mem_new((n_regions + 1) * sizeof *lighting.ladders) };
    atomic_init(&lighting.next, 0);
    atomic_init(&lighting.is_failed, false);
    size_t n_at_two = triangles_at(&lighting, 2);
    uint32_t factor = full_is_light(plan, algorithm, n_at_two) ? 1 : find_reduction(&lighting, n_at_two);
    bool is_built = !atomic_load(&lighting.is_failed);
    for (size_t r = 0; r < n_regions; r++) {
        struct plan_mesh *slot = &plan->meshes->of_region[r][algorithm][SURFACE_LIGHT];
        if (is_built && factor > 1 && lighting.ladders[r].mesh[factor]) {
            slot->mesh = mesh_ref(lighting.ladders[r].mesh[factor]);
            slot->facts = lighting.ladders[r].facts[factor];
        }
        for (uint32_t step = 2; step <= MAX_REDUCTION; step++)
            mesh_unref(lighting.ladders[r].mesh[step]);
    }
    free(lighting.ladders);
    if (is_built)
        plan->meshes->light[algorithm].reduction = factor;
    return is_built || error_set(err, ERROR_MEMORY, "no memory for the lighter surfaces");
}

static struct mesh *light_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm, struct surface_facts *facts,
                                  struct error *err)
{
    struct plan_lightness *light = &plan->meshes->light[algorithm];
    pthread_mutex_lock(&light->lock);
    bool is_built = light->reduction > 0 || build_light(plan, algorithm, err);
    bool is_full = light->reduction == 1;
    pthread_mutex_unlock(&light->lock);
    if (!is_built)
        return NULL;
    if (is_full)
        return full_surface(plan, region, algorithm, facts, err);
    const struct plan_mesh *slot = &plan->meshes->of_region[region][algorithm][SURFACE_LIGHT]; /* frozen from here on */
    *facts = slot->facts;
    return mesh_ref(slot->mesh);
}

struct mesh *plan_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm, enum surface_detail detail,
                          struct surface_facts *facts, struct error *err)
{
    struct surface_facts unwanted;
    if (region >= plan->regions.n_regions) {
        error_set(err, ERROR_RANGE, "region %zu; the plan has %zu", region, plan->regions.n_regions);
        return NULL;
    }
    if (plan->regions.regions[region].n_voxels == 0) {
        error_set(err, ERROR_RANGE, "the region \"%s\" has no voxel", plan->regions.regions[region].name);
        return NULL;
    }
    facts = facts ? facts : &unwanted;
    return detail == SURFACE_FULL ? full_surface(plan, region, algorithm, facts, err)
                                  : light_surface(plan, region, algorithm, facts, err);
}
