/* Sorts a mesh's triangles into slabs along a patient axis. */
#include "core/surface/mesh_slabs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* Slabs much thinner than a triangle find no fewer. */
enum { MAX_SLABS = 1024, MIN_TRIANGLES_PER_SLAB = 64 };

void mesh_slabs_destroy(struct mesh_slabs *slabs)
{
    if (!slabs)
        return;
    free(slabs->triangles);
    free(slabs->starts);
    free(slabs);
}

static uint32_t slab_at(const struct mesh_slabs *slabs, float at_mm)
{
    float slab = (at_mm - slabs->low_mm) * slabs->slabs_per_mm;
    return slab > 0 ? (uint32_t)fminf(slab, (float)(slabs->n_slabs - 1)) : 0;
}

static float lowest(const struct mesh *mesh, size_t triangle, int axis, float *extent_mm)
{
    const uint32_t *corner = &mesh->indices[3 * triangle];
    const float *p = mesh->positions_lps_mm + axis;
    float a = p[3 * (size_t)corner[0]], b = p[3 * (size_t)corner[1]], c = p[3 * (size_t)corner[2]];
    float low = fminf(a, fminf(b, c));
    *extent_mm = fmaxf(a, fmaxf(b, c)) - low;
    return low;
}

/* Counting sort: slab_of keeps the slab of each triangle between its two passes. */
static void sort(struct mesh_slabs *slabs, const struct mesh *mesh, int axis, uint16_t *slab_of)
{
    memset(slabs->starts, 0, ((size_t)slabs->n_slabs + 2) * sizeof *slabs->starts);
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        float extent_mm, low = lowest(mesh, t, axis, &extent_mm);
        slabs->longest_mm = fmaxf(slabs->longest_mm, extent_mm);
        slab_of[t] = (uint16_t)slab_at(slabs, low);
        slabs->starts[slab_of[t] + 2]++;
    }
    for (uint32_t s = 0; s < slabs->n_slabs; s++)
        slabs->starts[s + 2] += slabs->starts[s + 1];
    for (size_t t = 0; t < mesh->n_triangles; t++) /* starts[s + 1] is slab s's fill position, at the end its end */
        slabs->triangles[slabs->starts[slab_of[t] + 1]++] = (uint32_t)t;
}

struct mesh_slabs *mesh_slabs_create(const struct mesh *mesh, int axis, struct error *err)
{
    const struct box3 *box = &mesh->bounds_lps_mm;
    double low = axis == 0   ? box->low.x
                 : axis == 1 ? box->low.y
                             : box->low.z,
           high = axis == 0   ? box->high.x
                  : axis == 1 ? box->high.y
                              : box->high.z;
    size_t n_slabs = mesh->n_triangles / MIN_TRIANGLES_PER_SLAB;
    struct mesh_slabs *slabs = mem_new(sizeof *slabs);
    slabs->n_slabs = n_slabs < 1 ? 1 : n_slabs > MAX_SLABS ? MAX_SLABS : (uint32_t)n_slabs;
    slabs->low_mm = (float)low;
    slabs->slabs_per_mm = high > low ? (float)((double)slabs->n_slabs / (high - low)) : 0;
    slabs->n_bytes = sizeof *slabs + mesh->n_triangles * sizeof *slabs->triangles +
                     ((size_t)slabs->n_slabs + 2) * sizeof *slabs->starts;
    slabs->triangles = mem_array(mesh->n_triangles, sizeof *slabs->triangles, UINT64_MAX, err);
    slabs->starts =
        slabs->triangles ? mem_array((size_t)slabs->n_slabs + 2, sizeof *slabs->starts, UINT64_MAX, err) : NULL;
    uint16_t *slab_of = slabs->starts ? mem_array(mesh->n_triangles, sizeof *slab_of, UINT64_MAX, err) : NULL;
    if (!slab_of) {
        mesh_slabs_destroy(slabs);
        return NULL;
    }
    sort(slabs, mesh, axis, slab_of);
    free(slab_of);
    return slabs;
}

void mesh_slabs_find(const struct mesh_slabs *slabs, float position_mm, size_t *first, size_t *end)
{
    uint32_t from = slab_at(slabs, position_mm - slabs->longest_mm), to = slab_at(slabs, position_mm);
    *first = slabs->starts[from > 0 ? from - 1 : 0]; /* one more slab, for rounding */
    *end = slabs->starts[to + 1];
}
