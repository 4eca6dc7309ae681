/* What a plan gives of its regions to draw: built on first use, then kept (plan_shapes.h). */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/plan/plan_shapes.h"
#include "core/plan/plan_surface.h"
#include "core/surface/shape_distance.h"
#include "core/surface/shape_make.h"

struct wanted {
    struct plan *plan;
    uint32_t reduction; /* of a light surface */
    int n_threads;      /* to build a full surface */
};

void plan_count_shape(const struct shape *shape, struct surface_facts *facts)
{
    facts->distance_mean_mm = facts->distance_max_mm = NAN;
    facts->n_bytes = shape->n_bytes;
    switch (shape->kind) {
    case SHAPE_TRIANGLES:
        facts->n_triangles = shape->mesh->n_triangles;
        facts->n_vertices = shape->mesh->n_vertices;
        facts->area_mm2 = mesh_area_mm2(shape->mesh);
        facts->volume_mm3 = mesh_volume_mm3(shape->mesh);
        break;
    case SHAPE_LINES:
        facts->n_vertices = shape->lines->n_vertices;
        facts->n_lines = shape->lines->n_lines;
        break;
    case SHAPE_POINTS: facts->n_points = shape->points->n_points; break;
    }
}

/* What a shape is made from: with its inner boundary a region is its own univels alone. */
static struct mask *mask_of(const struct plan *plan, size_t region, const struct shape_key *key, struct error *err)
{
    const struct region *what = &plan->regions.regions[region];
    if (key->has_inner_boundary)
        return mask_from_labels(plan->regions.layers[what->layer], &what->label, 1, parallel_cores(), err);
    return mask_from_region(&plan->regions, region, parallel_cores(), err);
}

static struct shape *build_other(const struct plan *plan, const struct shape_name *name, struct surface_facts *facts, struct error *err)
{
    int64_t began_us = clock_now_us();
    struct shape *shape = shape_make(&name->key, &plan->regions, name->region, 0, err);
    if (!shape)
        return NULL;
    *facts = (struct surface_facts){ .build_ms = (double)(clock_now_us() - began_us) / 1000, .reduction = 1 };
    struct mask *mask = mask_of(plan, name->region, &name->key, err);
    if (!mask) {
        shape_unref(shape);
        return NULL;
    }
    facts->n_univels = mask_count(mask);
    facts->univel_volume_mm3 = (double)facts->n_univels * fabs(affine_determinant(&mask->lps_mm_from_ijk));
    mask_destroy(mask);
    plan_count_shape(shape, facts);
    if (name->key.representation == REPRESENTATION_FAN)
        facts->volume_mm3 = NAN; /* its triangles overlap: it encloses nothing */
    return shape;
}

static struct shape *build(void *context, const struct shape_name *name, struct surface_facts *facts, struct error *err)
{
    const struct wanted *wanted = context;
    struct plan *plan = wanted->plan;
    struct shape *shape = NULL;
    if (name->key.representation != REPRESENTATION_SURFACE)
        shape = build_other(plan, name, facts, err);
    else if (name->detail == SURFACE_LIGHT)
        shape = plan_build_light_surface(plan, name->region, name->key.algorithm, wanted->reduction, facts, err);
    else
        shape = plan_build_surface(plan, name->region, name->key.algorithm, wanted->n_threads, facts, err);
    if (!shape && err)
        error_prefix(err, "region \"%s\"", plan->regions.regions[name->region].name);
    return shape;
}

bool plan_shape_distance(const struct plan *plan, size_t region, const struct shape_key *key, const struct shape *shape,
                         struct surface_facts *facts, struct error *err)
{
    const float *positions = shape->mesh ? shape->mesh->positions_lps_mm : shape->lines ? shape->lines->positions_lps_mm : shape->points->positions_lps_mm;
    size_t n = shape->mesh ? shape->mesh->n_vertices : shape->lines ? shape->lines->n_vertices : shape->points->n_points;
    struct shape_distance distance;
    struct mask *mask = mask_of(plan, region, key, err);
    bool is_measured = mask && shape_distance(mask, positions, n, 0, &distance, err);
    mask_destroy(mask);
    if (!is_measured)
        return false;
    facts->distance_mean_mm = distance.mean_mm;
    facts->distance_max_mm = distance.max_mm;
    return true;
}

static struct shape *get(struct plan *plan, size_t region, const struct shape_key *key, enum surface_detail detail, int n_threads,
                         struct surface_facts *facts, struct error *err)
{
    struct surface_facts unwanted;
    struct shape_name name = { region, *key, SURFACE_FULL };
    struct wanted wanted = { plan, 1, n_threads };
    shape_key_normalise(&name.key);
    if (region >= plan->regions.n_regions) {
        error_set(err, ERROR_RANGE, "region %zu; the plan has %zu", region, plan->regions.n_regions);
        return NULL;
    }
    if (plan->regions.regions[region].n_voxels == 0) {
        error_set(err, ERROR_RANGE, "the region \"%s\" has no voxel", plan->regions.regions[region].name);
        return NULL;
    }
    if (detail == SURFACE_LIGHT && name.key.representation == REPRESENTATION_SURFACE) {
        wanted.reduction = plan_light_reduction(plan, name.key.algorithm, err);
        if (wanted.reduction == 0)
            return NULL;
        name.detail = wanted.reduction > 1 ? SURFACE_LIGHT : SURFACE_FULL;
    }
    return plan_shapes_get(plan->shapes, &name, build, &wanted, facts ? facts : &unwanted, err);
}

struct shape *plan_shape(struct plan *plan, size_t region, const struct shape_key *key, enum surface_detail detail,
                         struct surface_facts *facts, struct error *err)
{
    return get(plan, region, key, detail, parallel_cores(), facts, err);
}

struct mesh *plan_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm, enum surface_detail detail,
                          struct surface_facts *facts, struct error *err)
{
    struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm };
    struct shape *shape = plan_shape(plan, region, &key, detail, facts, err);
    struct mesh *mesh = shape ? mesh_ref(shape->mesh) : NULL;
    shape_unref(shape);
    return mesh;
}

/* ---- several at once ------------------------------------------------------------------------------------------------------ */

struct crowd {
    struct plan *plan;
    size_t *regions; /* the largest first */
    size_t n;
    struct shape_key key;
    enum surface_detail detail;
    bool (*go_on)(void *context);
    void *context;
    atomic_size_t next;
    atomic_bool is_over;
};

static void take_regions(void *context, int part, int n_parts)
{
    struct crowd *crowd = context;
    for (size_t at; !atomic_load(&crowd->is_over) && (at = atomic_fetch_add(&crowd->next, 1)) < crowd->n;) {
        if (part == 0 && crowd->go_on && !crowd->go_on(crowd->context)) {
            atomic_store(&crowd->is_over, true);
            return;
        }
        struct error err = { 0 };
        struct shape *shape = get(crowd->plan, crowd->regions[at], &crowd->key, crowd->detail, n_parts > 1 ? 1 : parallel_cores(), NULL, &err);
        if (!shape)
            log_warn("surface of region %s: %s", crowd->plan->regions.regions[crowd->regions[at]].id, err.text);
        shape_unref(shape);
    }
}

static double box_of(const struct plan *plan, size_t region)
{
    const struct region *what = &plan->regions.regions[region];
    double size = 1;
    for (int axis = 0; axis < 3; axis++)
        size *= (double)what->high_ijk[axis] - what->low_ijk[axis] + 1;
    return size;
}

void plan_build_surfaces(struct plan *plan, const size_t *regions, size_t n, enum surface_algorithm algorithm, enum surface_detail detail,
                         bool (*go_on)(void *context), void *context)
{
    struct crowd crowd = { plan, mem_new((n + 1) * sizeof *regions), n, { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm },
                           detail, go_on, context, 0, false };
    for (size_t i = 0; i < n; i++) { /* a plan has few */
        size_t at = i;
        for (; at > 0 && box_of(plan, crowd.regions[at - 1]) < box_of(plan, regions[i]); at--)
            crowd.regions[at] = crowd.regions[at - 1];
        crowd.regions[at] = regions[i];
    }
    int n_threads = parallel_cores();
    parallel_run((size_t)n_threads < n ? n_threads : n > 0 ? (int)n : 1, take_regions, &crowd);
    free(crowd.regions);
}

/* ---- memory ---------------------------------------------------------------------------------------------------------------- */

void plan_set_shape_budget(struct plan *plan, uint64_t n_bytes)
{
    plan_shapes_set_budget(plan->shapes, n_bytes);
}

void plan_shape_usage(struct plan *plan, struct plan_shape_usage *usage)
{
    plan_shapes_usage(plan->shapes, usage);
}
