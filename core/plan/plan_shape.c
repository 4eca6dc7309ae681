/* What a plan gives of its regions to draw: built on first use, then kept (plan_shapes.h). */
#include <math.h>

#include "core/plan/plan_shapes.h"
#include "core/plan/plan_surface.h"

struct wanted {
    struct plan *plan;
    uint32_t reduction; /* of a light surface */
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

static struct shape *build(void *context, const struct shape_name *name, struct surface_facts *facts, struct error *err)
{
    const struct wanted *wanted = context;
    struct plan *plan = wanted->plan;
    struct shape *shape = NULL;
    if (name->key.representation != REPRESENTATION_SURFACE)
        error_set(err, ERROR_UNSUPPORTED, "a region as \"%s\"", region_representation_word(name->key.representation));
    else if (name->detail == SURFACE_LIGHT)
        shape = plan_build_light_surface(plan, name->region, name->key.algorithm, wanted->reduction, facts, err);
    else
        shape = plan_build_surface(plan, name->region, name->key.algorithm, facts, err);
    if (!shape && err)
        error_prefix(err, "region \"%s\"", plan->regions.regions[name->region].name);
    return shape;
}

struct shape *plan_shape(struct plan *plan, size_t region, const struct shape_key *key, enum surface_detail detail,
                         struct surface_facts *facts, struct error *err)
{
    struct surface_facts unwanted;
    struct shape_name name = { region, *key, SURFACE_FULL };
    struct wanted wanted = { plan, 1 };
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

struct mesh *plan_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm, enum surface_detail detail,
                          struct surface_facts *facts, struct error *err)
{
    struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm };
    struct shape *shape = plan_shape(plan, region, &key, detail, facts, err);
    struct mesh *mesh = shape ? mesh_ref(shape->mesh) : NULL;
    shape_unref(shape);
    return mesh;
}

void plan_set_shape_budget(struct plan *plan, uint64_t n_bytes)
{
    plan_shapes_set_budget(plan->shapes, n_bytes);
}

void plan_shape_usage(struct plan *plan, struct plan_shape_usage *usage)
{
    plan_shapes_usage(plan->shapes, usage);
}
