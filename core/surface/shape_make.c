/* Makes the shape of a region for a key, and measures its bounds and memory. */
#include "core/surface/shape_make.h"

#include <assert.h>
#include <stdatomic.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/boundary.h"
#include "core/surface/shape_parts.h"

static struct mesh *make_mesh(const struct shape_key *key, const struct mask *mask, int n_threads, struct error *err)
{
    struct surface_options options = surface_defaults;
    struct mesh *mesh = NULL;
    options.n_threads = n_threads;
    switch (key->representation) {
    case REPRESENTATION_SURFACE: mesh = surface_make(key->algorithm, mask, &options, err); break;
    case REPRESENTATION_UNIVELS: mesh = shape_univels(mask, n_threads, err); break;
    case REPRESENTATION_NURBS: mesh = shape_nurbs(mask, key, n_threads, err); break;
    case REPRESENTATION_FAN: mesh = shape_fan(mask, n_threads, err); break;
    default: assert(false);
    }
    if (mesh && (mesh->normals || mesh_make_normals(mesh, n_threads, err)))
        return mesh;
    mesh_unref(mesh);
    return NULL;
}

static void add_positions(struct box3 *box, const float *positions_lps_mm, size_t n)
{
    for (size_t at = 0; at < n; at++, positions_lps_mm += 3)
        box3_add(box, vec3((double)positions_lps_mm[0], (double)positions_lps_mm[1], (double)positions_lps_mm[2]));
}

/* Extends a box of voxel centres to the voxels' faces. */
static void grow_by_voxel(struct box3 *box, const struct vec3 edges[3])
{
    struct vec3 half = vec3(0, 0, 0);
    for (int axis = 0; axis < 3; axis++)
        half = vec3_add(half, vec3(fabs(edges[axis].x) / 2, fabs(edges[axis].y) / 2, fabs(edges[axis].z) / 2));
    box->low = vec3_sub(box->low, half);
    box->high = vec3_add(box->high, half);
}

static bool fill(struct shape *shape, const struct shape_key *key, const struct mask *mask, int n_threads,
                 struct error *err)
{
    switch (key->representation) {
    case REPRESENTATION_OUTLINE:
        shape->kind = SHAPE_LINES;
        shape->lines = shape_outline(mask, key->outline, n_threads, err);
        if (!shape->lines)
            return false;
        add_positions(&shape->bounds_lps_mm, shape->lines->positions_lps_mm, shape->lines->n_vertices);
        shape->n_bytes +=
            shape->lines->n_vertices * 3 * sizeof(float) + shape->lines->n_segments * 2 * sizeof(uint32_t);
        return true;
    case REPRESENTATION_POINTS:
    case REPRESENTATION_SOLID:
        shape->kind = SHAPE_POINTS;
        shape->points = shape_points(mask, n_threads, err);
        if (!shape->points)
            return false;
        add_positions(&shape->bounds_lps_mm, shape->points->positions_lps_mm, shape->points->n_points);
        grow_by_voxel(&shape->bounds_lps_mm, shape->points->edge_lps_mm);
        shape->n_bytes += shape->points->n_points * (6 * sizeof(float) + 1);
        return true;
    default:
        shape->kind = SHAPE_TRIANGLES;
        shape->is_faceted = key->representation == REPRESENTATION_UNIVELS || key->representation == REPRESENTATION_FAN;
        shape->mesh = make_mesh(key, mask, n_threads, err);
        if (!shape->mesh)
            return false;
        shape->bounds_lps_mm = shape->mesh->bounds_lps_mm;
        shape->n_bytes += sizeof *shape->mesh + shape->mesh->n_vertices * 6 * sizeof(float);
        shape->n_bytes += shape->mesh->n_triangles * 3 * sizeof(uint32_t);
        return true;
    }
}

struct shape *shape_make_from_mask(const struct shape_key *key, const struct mask *mask, int n_threads,
                                   struct error *err)
{
    int n = n_threads > 0 ? n_threads : parallel_cores();
    struct shape *shape = mem_new(sizeof *shape);
    *shape = (struct shape){ .bounds_lps_mm = box3_empty(), .n_bytes = sizeof *shape };
    atomic_init(&shape->references, 1);
    bool good =
        mask_count(mask) > 0 || error_set(err, ERROR_RANGE, "no voxel%s", key->has_inner_boundary ? " of its own" : "");
    if (good && fill(shape, key, mask, n < SHAPE_MAX_THREADS ? n : SHAPE_MAX_THREADS, err))
        return shape;
    shape_unref(shape);
    return NULL;
}

struct shape *shape_make(const struct shape_key *key, const struct region_set *set, size_t region, int n_threads,
                         struct error *err)
{
    struct mask *mask = key->has_inner_boundary ? mask_from_region_own(set, region, n_threads, err)
                                                : mask_from_region(set, region, n_threads, err);
    if (!mask)
        return NULL;
    struct shape *shape = NULL;
    if (mask_count(mask) > 0)
        shape = shape_make_from_mask(key, mask, n_threads, err);
    else
        error_set(err, ERROR_RANGE, "region %s has no voxel%s", set->regions[region].id,
                  key->has_inner_boundary ? " of its own" : "");
    mask_destroy(mask);
    return shape;
}
