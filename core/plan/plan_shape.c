/* What a plan gives of its regions to draw: built on first use, then kept (plan_shapes.h). */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/plan/plan_masks.h"
#include "core/plan/plan_shapes.h"
#include "core/plan/plan_surface.h"
#include "core/region/boundary.h"
#include "core/surface/shape_distance.h"
#include "core/surface/shape_make.h"

struct wanted {
    struct plan *plan;
    uint32_t reduction;       /* of a light surface */
    int n_threads;            /* to build it */
    struct plan_masks *masks; /* NULL: the mask is made for this one alone; else it is this wish of these */
    size_t wish;
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
    if (key->has_inner_boundary)
        return mask_from_region_own(&plan->regions, region, parallel_cores(), err);
    return mask_from_region(&plan->regions, region, parallel_cores(), err);
}

static struct shape *build_other(const struct shape_key *key, const struct mask *mask, int n_threads,
                                 struct surface_facts *facts, struct error *err)
{
    int64_t began_us = clock_now_us();
    struct shape *shape = shape_make_from_mask(key, mask, n_threads, err);
    if (!shape)
        return NULL;
    *facts = (struct surface_facts){ .reduction = 1, .n_univels = mask_count(mask) };
    facts->build_ms = (double)(clock_now_us() - began_us) / 1000;
    facts->univel_volume_mm3 = (double)facts->n_univels * fabs(affine_determinant(&mask->lps_mm_from_ijk));
    plan_count_shape(shape, facts);
    if (key->representation == REPRESENTATION_FAN)
        facts->volume_mm3 = NAN; /* its triangles overlap: it encloses nothing */
    return shape;
}

static struct shape *build(void *context, const struct shape_name *name, struct surface_facts *facts, struct error *err)
{
    const struct wanted *wanted = context;
    struct shape *shape = NULL;
    int64_t began_us = clock_now_us();
    struct mask *mask = wanted->masks ? plan_masks_take(wanted->masks, wanted->wish, err)
                                      : mask_of(wanted->plan, name->region, &name->key, err);
    double mask_ms = (double)(clock_now_us() - began_us) / 1000;
    if (mask && name->key.representation != REPRESENTATION_SURFACE)
        shape = build_other(&name->key, mask, wanted->n_threads, facts, err);
    else if (mask && name->detail == SURFACE_LIGHT)
        shape = plan_build_light_surface(mask, name->key.algorithm, wanted->reduction, facts, err);
    else if (mask)
        shape = plan_build_surface(mask, name->key.algorithm, wanted->n_threads, facts, err);
    mask_destroy(mask);
    if (shape)
        facts->build_ms += mask_ms;
    else if (err)
        error_prefix(err, "region \"%s\"", wanted->plan->regions.regions[name->region].name);
    return shape;
}

bool plan_shape_distance(const struct plan *plan, size_t region, const struct shape_key *key, const struct shape *shape,
                         struct surface_facts *facts, struct error *err)
{
    const float *positions = shape->mesh    ? shape->mesh->positions_lps_mm
                             : shape->lines ? shape->lines->positions_lps_mm
                                            : shape->points->positions_lps_mm;
    size_t n = shape->mesh    ? shape->mesh->n_vertices
               : shape->lines ? shape->lines->n_vertices
                              : shape->points->n_points;
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

/* What a shape is kept as, with the reduction it has; false: there is none. */
static bool name_of(struct plan *plan, const struct plan_want *want, struct shape_name *name, uint32_t *reduction,
                    struct error *err)
{
    *name = (struct shape_name){ want->region, want->key, SURFACE_FULL };
    *reduction = 1;
    shape_key_normalise(&name->key);
    if (want->region >= plan->regions.n_regions)
        return error_set(err, ERROR_RANGE, "region %zu; the plan has %zu", want->region, plan->regions.n_regions);
    if (plan->regions.regions[want->region].n_voxels == 0)
        return error_set(err, ERROR_RANGE, "the region \"%s\" has no voxel", plan->regions.regions[want->region].name);
    if (want->detail == SURFACE_LIGHT && name->key.representation == REPRESENTATION_SURFACE) {
        *reduction = plan_light_reduction(plan, name->key.algorithm, err);
        name->detail = *reduction > 1 ? SURFACE_LIGHT : SURFACE_FULL;
    }
    return *reduction > 0;
}

struct shape *plan_shape(struct plan *plan, size_t region, const struct shape_key *key, enum surface_detail detail,
                         struct surface_facts *facts, struct error *err)
{
    struct surface_facts unwanted;
    struct shape_name name;
    struct wanted wanted = { .plan = plan, .n_threads = parallel_cores() };
    if (!name_of(plan, &(struct plan_want){ region, *key, detail }, &name, &wanted.reduction, err))
        return NULL;
    return plan_shapes_get(plan->shapes, &name, build, &wanted, facts ? facts : &unwanted, err);
}

bool plan_shape_refused(struct plan *plan, const struct plan_want *want, struct error *why)
{
    struct shape_name name;
    uint32_t reduction;
    return plan_shapes_refused_some(plan->shapes) && name_of(plan, want, &name, &reduction, why) &&
           plan_shapes_refused(plan->shapes, &name, why);
}

struct mesh *plan_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm,
                          enum surface_detail detail, struct surface_facts *facts, struct error *err)
{
    struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm };
    struct shape *shape = plan_shape(plan, region, &key, detail, facts, err);
    struct mesh *mesh = shape ? mesh_ref(shape->mesh) : NULL;
    shape_unref(shape);
    return mesh;
}

/* ---- several at once -------------------------------------------------------------------------------------------- */

struct crowd {
    struct plan *plan;
    const struct plan_want *wants;
    size_t n;
    struct shape_name *names; /* [n_missing] */
    uint32_t *reductions;     /* [n_missing] */
    size_t n_missing;
    struct plan_masks *masks; /* a wish for each that is missing */
    bool (*go_on)(void *context);
    void *context;
    atomic_size_t next;
    atomic_bool is_over;
};

static void take_shapes(void *context, int part, int n_parts)
{
    struct crowd *crowd = context;
    for (size_t at; !atomic_load(&crowd->is_over) && (at = atomic_fetch_add(&crowd->next, 1)) < crowd->n_missing;) {
        if (part == 0 && crowd->go_on && !crowd->go_on(crowd->context)) {
            atomic_store(&crowd->is_over, true);
            return;
        }
        struct error err = { 0 };
        struct surface_facts facts;
        struct wanted wanted = { crowd->plan, crowd->reductions[at], n_parts > 1 ? 1 : parallel_cores(), crowd->masks,
                                 at };
        struct shape *shape = plan_shapes_get(crowd->plan->shapes, &crowd->names[at], build, &wanted, &facts, &err);
        if (!shape)
            log_warn("shape of region %s: %s", crowd->plan->regions.regions[crowd->names[at].region].id, err.text);
        shape_unref(shape);
    }
}

/* Those that are not there yet, and a wish for the mask of each. */
static void find_missing(struct crowd *crowd)
{
    struct mask_wish *wishes = mem_new((crowd->n + 1) * sizeof *wishes);
    for (size_t i = 0; i < crowd->n; i++) {
        struct error err = { 0 };
        struct shape_name *name = &crowd->names[crowd->n_missing];
        if (!name_of(crowd->plan, &crowd->wants[i], name, &crowd->reductions[crowd->n_missing], &err))
            log_warn("shape of region %zu: %s", crowd->wants[i].region, err.text);
        else if (!plan_shapes_has(crowd->plan->shapes, name))
            wishes[crowd->n_missing++] = (struct mask_wish){ name->region, name->key.has_inner_boundary };
    }
    crowd->masks = plan_masks_create(crowd->plan, wishes, crowd->n_missing, PLAN_MASKS_BYTES);
    free(wishes);
}

void plan_build_shapes(struct plan *plan, const struct plan_want *wants, size_t n, bool (*go_on)(void *context),
                       void *context)
{
    struct crowd crowd = { .plan = plan, .wants = wants, .n = n, .go_on = go_on, .context = context };
    size_t n_threads = (size_t)parallel_cores();
    if (go_on && !go_on(context))
        return;
    crowd.names = mem_new((n + 1) * sizeof *crowd.names);
    crowd.reductions = mem_new((n + 1) * sizeof *crowd.reductions);
    atomic_init(&crowd.next, 0);
    atomic_init(&crowd.is_over, false);
    find_missing(&crowd);
    if (crowd.n_missing > 0)
        parallel_run((int)(n_threads < crowd.n_missing ? n_threads : crowd.n_missing), take_shapes, &crowd);
    plan_masks_destroy(crowd.masks);
    free(crowd.names);
    free(crowd.reductions);
}

static double box_of(const struct plan *plan, size_t region)
{
    const struct region *what = &plan->regions.regions[region];
    double size = 1;
    for (int axis = 0; axis < 3; axis++)
        size *= (double)what->high_ijk[axis] - what->low_ijk[axis] + 1;
    return size;
}

void plan_build_surfaces(struct plan *plan, const size_t *regions, size_t n, enum surface_algorithm algorithm,
                         enum surface_detail detail, bool (*go_on)(void *context), void *context)
{
    struct plan_want *wants = mem_new((n + 1) * sizeof *wants);
    for (size_t i = 0; i < n; i++) { /* a plan has few */
        size_t at = i;
        for (; at > 0 && box_of(plan, wants[at - 1].region) < box_of(plan, regions[i]); at--)
            wants[at] = wants[at - 1];
        wants[at] = (struct plan_want){ regions[i],
                                        { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm },
                                        detail };
    }
    plan_build_shapes(plan, wants, n, go_on, context);
    free(wants);
}

/* ---- memory ----------------------------------------------------------------------------------------------------- */

void plan_set_shape_budget(struct plan *plan, uint64_t n_bytes)
{
    plan_shapes_set_budget(plan->shapes, n_bytes);
}

void plan_shape_usage(struct plan *plan, struct plan_shape_usage *usage)
{
    plan_shapes_usage(plan->shapes, usage);
}
