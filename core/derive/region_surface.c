/* Builds surfaces of regions from their masks: full ones, and coarse ones for pictures that move. */
#include "core/derive/region_surface.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/surface/surface.h"

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

/* Takes the mesh. The facts count the univels of the unreduced mask. */
static struct shape *shape_of(struct mesh *mesh, const struct mask *full, uint32_t reduction, int64_t started_us,
                              struct shape_facts *facts)
{
    struct shape *shape = mem_new(sizeof *shape);
    atomic_init(&shape->references, 1);
    shape->kind = SHAPE_TRIANGLES;
    shape->mesh = mesh;
    shape->bounds_lps_mm = mesh->bounds_lps_mm;
    shape->n_bytes =
        sizeof *shape + sizeof *mesh + mesh->n_vertices * 6 * sizeof(float) + mesh->n_triangles * 3 * sizeof(uint32_t);
    *facts = (struct shape_facts){ .n_univels = mask_count(full), .reduction = reduction };
    facts->univel_volume_mm3 = (double)facts->n_univels * fabs(affine_determinant(&full->lps_mm_from_ijk));
    shape_facts_count(shape, facts);
    facts->build_ms = (double)(clock_now_us() - started_us) / 1000;
    return shape;
}

struct shape *region_surface_build(const struct mask *mask, enum surface_algorithm algorithm, int n_threads,
                                   struct shape_facts *facts, struct error *err)
{
    int64_t started_us = clock_now_us();
    struct mesh *mesh = extract(algorithm, mask, n_threads, err);
    return mesh ? shape_of(mesh, mask, 1, started_us, facts) : NULL;
}

/* How many voxels become one along each axis: along the shortest edge as many as the reduction says, along the others
 * only as many as make them no longer than that. So slices are not merged before the pixels within them are as large as
 * a slice is thick. */
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

/* A region that has no triangle at this reduction (small ones by the 8-cell algorithm) is reduced less: it must not
 * vanish in motion. */
struct shape *region_surface_build_coarse(const struct mask *full, enum surface_algorithm algorithm, uint32_t reduction,
                                          struct shape_facts *facts, struct error *err)
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
