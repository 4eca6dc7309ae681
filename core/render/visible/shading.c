/* Vertex normals averaged over their neighbourhood, for shading surfaces made of voxels. */
#include "core/render/visible/shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* to[vertex] = sum of the normals at all corners of the triangles around it, its own included. */
static void spread(const struct mesh *mesh, const float *restrict from, float *restrict to)
{
    memset(to, 0, mesh->n_vertices * 3 * sizeof *to);
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *corner = &mesh->indices[3 * t];
        const float *a = &from[3 * (size_t)corner[0]], *b = &from[3 * (size_t)corner[1]],
                    *c = &from[3 * (size_t)corner[2]];
        const float sum[3] = { a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2] };
        for (int i = 0; i < 3; i++) {
            float *vertex = &to[3 * (size_t)corner[i]];
            vertex[0] += sum[0];
            vertex[1] += sum[1];
            vertex[2] += sum[2];
        }
    }
}

/* Where opposite normals cancel, at the edge of a sheet one voxel thick, the vertex keeps its own. */
static void normalize(const float *own, float *normals, size_t n_vertices)
{
    for (size_t v = 0; v < n_vertices; v++) {
        float *n = &normals[3 * v], length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int i = 0; i < 3; i++)
            n[i] = length > 1e-3f ? n[i] / length : own[3 * v + (size_t)i];
    }
}

float *shading_normals(const struct mesh *mesh, int n_passes, struct error *err)
{
    float *now = mem_array(mesh->n_vertices, 3 * sizeof *now, UINT64_MAX, err);
    float *next = now ? mem_array(mesh->n_vertices, 3 * sizeof *next, UINT64_MAX, err) : NULL;
    if (!next) {
        free(now);
        return NULL;
    }
    memcpy(now, mesh->normals, mesh->n_vertices * 3 * sizeof *now);
    for (int pass = 0; pass < n_passes; pass++) {
        spread(mesh, now, next);
        normalize(mesh->normals, next, mesh->n_vertices);
        float *swap = now;
        now = next;
        next = swap;
    }
    free(next);
    return now;
}

/* Passes that reach across the terraces of a surface with a slope of 1 voxel in 12. A reduced surface has larger
 * triangles, so fewer passes reach as far. */
enum { FULL_PASSES = 12 };

int shading_passes(uint32_t reduction)
{
    return FULL_PASSES / (int)(reduction < 1 ? 1 : reduction > FULL_PASSES ? FULL_PASSES : reduction);
}
