/* Vertex normals of any mesh, on several threads and always the same to the last bit.
 *
 * Each thread owns a range of vertices and adds up, in the order of the triangles, what reaches that range. So every sum has
 * one owner and one order, whatever the number of threads. A triangle near a border between ranges is looked at twice; blocks
 * of triangles that stay clear of a range (most, as meshes from grids are ordered) are skipped whole. */
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/mesh.h"

enum { BLOCK = 1024 }; /* triangles */

struct block {
    uint32_t low, high; /* vertices its triangles use, inclusive */
};

struct job {
    struct mesh *mesh;
    struct block *blocks;
    size_t n_blocks;
};

static size_t share(size_t n, int part, int n_parts)
{
    return n * (size_t)part / (size_t)n_parts; /* n is below 2^34, a part below 2^7 */
}

static void measure_blocks(void *context, int part, int n_parts)
{
    const struct job *job = context;
    size_t end = share(job->n_blocks, part + 1, n_parts);
    for (size_t b = share(job->n_blocks, part, n_parts); b < end; b++) {
        size_t last = (b + 1) * BLOCK < job->mesh->n_triangles ? (b + 1) * BLOCK : job->mesh->n_triangles;
        struct block block = { UINT32_MAX, 0 };
        for (size_t at = 3 * b * BLOCK; at < 3 * last; at++) {
            uint32_t vertex = job->mesh->indices[at];
            block.low = vertex < block.low ? vertex : block.low;
            block.high = vertex > block.high ? vertex : block.high;
        }
        job->blocks[b] = block;
    }
}

/* The cross product of two sides: along the normal, twice the area long. */
static inline void triangle_normal(const float *positions, const uint32_t v[3], float normal[3])
{
    const float *a = positions + 3 * (size_t)v[0], *b = positions + 3 * (size_t)v[1], *c = positions + 3 * (size_t)v[2];
    float ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    float wx = c[0] - a[0], wy = c[1] - a[1], wz = c[2] - a[2];
    normal[0] = uy * wz - uz * wy;
    normal[1] = uz * wx - ux * wz;
    normal[2] = ux * wy - uy * wx;
}

static inline void add(float *sum, const float normal[3])
{
    sum[0] += normal[0];
    sum[1] += normal[1];
    sum[2] += normal[2];
}

static void add_blocks(void *context, int part, int n_parts)
{
    const struct job *job = context;
    const struct mesh *mesh = job->mesh;
    size_t from = share(mesh->n_vertices, part, n_parts), end = share(mesh->n_vertices, part + 1, n_parts);
    for (size_t b = 0; b < job->n_blocks; b++) {
        if (job->blocks[b].high < from || job->blocks[b].low >= end)
            continue;
        bool all_mine = job->blocks[b].low >= from && job->blocks[b].high < end;
        size_t last = (b + 1) * BLOCK < mesh->n_triangles ? (b + 1) * BLOCK : mesh->n_triangles;
        for (size_t t = b * BLOCK; t < last; t++) {
            const uint32_t *v = mesh->indices + 3 * t;
            float normal[3];
            triangle_normal(mesh->positions_lps_mm, v, normal);
            for (int corner = 0; corner < 3; corner++)
                if (all_mine || (v[corner] >= from && v[corner] < end))
                    add(mesh->normals + 3 * (size_t)v[corner], normal);
        }
    }
    for (size_t vertex = from; vertex < end; vertex++) {
        float *n = mesh->normals + 3 * vertex;
        float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (length > 0) {
            n[0] /= length;
            n[1] /= length;
            n[2] /= length;
        } else {
            n[2] = 1; /* unused, or its triangles cancel: any direction, but a unit one */
        }
    }
}

bool mesh_make_normals(struct mesh *mesh, int n_threads, struct error *err)
{
    struct job job = { mesh, NULL, (mesh->n_triangles + BLOCK - 1) / BLOCK };
    float *normals = mem_array(mesh->n_vertices, 3 * sizeof(float), UINT64_MAX, err);
    job.blocks = normals ? mem_array(job.n_blocks, sizeof *job.blocks, UINT64_MAX, err) : NULL;
    if (!job.blocks) {
        free(normals);
        return false;
    }
    free(mesh->normals);
    mesh->normals = normals;
    int n_parts = n_threads > 0 ? n_threads : parallel_cores();
    parallel_run(n_parts, measure_blocks, &job);
    parallel_run(n_parts, add_blocks, &job);
    free(job.blocks);
    return true;
}
