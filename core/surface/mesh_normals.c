/* Computes vertex normals of any mesh on several threads, with the same bytes for any number of them.
 *
 * Each thread owns a range of vertices and adds, in triangle sequence, what triangles contribute to that range. So
 * every sum has one owner and one sequence of additions. A triangle near a border between ranges is visited twice;
 * blocks of triangles without a vertex in a range are skipped (most of them, because meshes from grids are ordered). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/mesh.h"

enum { BLOCK = 1024 }; /* triangles */

struct block {
    uint32_t low, high; /* smallest and largest vertex used by its triangles */
};

/* Four floats in one register: x, y, z and an unused lane. */
typedef float float4 __attribute__((vector_size(16)));

struct normals_job {
    struct mesh *mesh;
    float4 *sums; /* one per vertex */
    struct block *blocks;
    size_t n_blocks;
};

static size_t share(size_t n, int part, int n_parts)
{
    return n * (size_t)part / (size_t)n_parts; /* no overflow: n is below 2^34, a part below 2^7 */
}

static void measure_blocks(void *context, int part, int n_parts)
{
    const struct normals_job *job = context;
    if (n_parts == 1) { /* a single range holds all vertices */
        for (size_t b = 0; b < job->n_blocks; b++)
            job->blocks[b] = (struct block){ 0, 0 };
        return;
    }
    size_t end = share(job->n_blocks, part + 1, n_parts);
    for (size_t b = share(job->n_blocks, part, n_parts); b < end; b++) {
        size_t last = (b + 1) * BLOCK < job->mesh->n_triangles ? (b + 1) * BLOCK : job->mesh->n_triangles;
        struct block corner[3] = { { UINT32_MAX, 0 },
                                   { UINT32_MAX, 0 },
                                   { UINT32_MAX, 0 } }; /* three independent chains of comparisons */
        for (size_t at = 3 * b * BLOCK; at < 3 * last; at += 3)
            for (size_t c = 0; c < 3; c++) {
                uint32_t vertex = job->mesh->indices[at + c];
                corner[c].low = vertex < corner[c].low ? vertex : corner[c].low;
                corner[c].high = vertex > corner[c].high ? vertex : corner[c].high;
            }
        for (size_t c = 1; c < 3; c++) {
            corner[0].low = corner[c].low < corner[0].low ? corner[c].low : corner[0].low;
            corner[0].high = corner[c].high > corner[0].high ? corner[c].high : corner[0].high;
        }
        job->blocks[b] = corner[0];
    }
}

static inline float4 load4(const float *at)
{
    float4 value;
    memcpy(&value, at, sizeof value);
    return value;
}

static inline float4 turn(float4 v) /* y, z, x */
{
    return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}

/* Cross product of two sides: direction of the normal, length twice the area. mesh_create leaves room after the last
 * vertex. */
static inline float4 triangle_normal(const float *positions, const uint32_t v[3])
{
    float4 a = load4(positions + 3 * (size_t)v[0]);
    float4 u = load4(positions + 3 * (size_t)v[1]) - a, w = load4(positions + 3 * (size_t)v[2]) - a;
    return turn(u * turn(w) - turn(u) * w);
}

/* Adds the triangles of a block to the sums of vertices from..end. */
static void add_block(const struct normals_job *job, size_t block, size_t from, size_t end)
{
    const struct mesh *mesh = job->mesh;
    bool all_mine = job->blocks[block].low >= from && job->blocks[block].high < end;
    size_t last = (block + 1) * BLOCK < mesh->n_triangles ? (block + 1) * BLOCK : mesh->n_triangles;
    for (size_t t = block * BLOCK; t < last; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        float4 normal = triangle_normal(mesh->positions_lps_mm, v);
        for (int corner = 0; corner < 3; corner++)
            if (all_mine || (v[corner] >= from && v[corner] < end))
                job->sums[v[corner]] += normal;
    }
}

static void make_normals(void *context, int part, int n_parts)
{
    const struct normals_job *job = context;
    size_t from = share(job->mesh->n_vertices, part, n_parts), end = share(job->mesh->n_vertices, part + 1, n_parts);
    memset(job->sums + from, 0, (end - from) * sizeof *job->sums);
    for (size_t b = 0; b < job->n_blocks; b++)
        if (job->blocks[b].high >= from && job->blocks[b].low < end)
            add_block(job, b, from, end);
    for (size_t vertex = from; vertex < end; vertex++) {
        float4 n = job->sums[vertex], square = n * n;
        float length = sqrtf(square[0] + square[1] + square[2]);
        if (length > 0)
            n /= length;
        else
            n = (float4){ 0, 0, 1, 0 }; /* unused vertex, or contributions that cancel: any unit vector */
        memcpy(job->mesh->normals + 3 * vertex, &n, 3 * sizeof(float));
    }
}

bool mesh_make_normals(struct mesh *mesh, int n_threads, struct error *err)
{
    struct normals_job job = { .mesh = mesh, .n_blocks = (mesh->n_triangles + BLOCK - 1) / BLOCK };
    float *normals = mem_large_array(mesh->n_vertices, 3 * sizeof(float), UINT64_MAX, err);
    job.sums = normals ? mem_large_array(mesh->n_vertices + 1, sizeof *job.sums, UINT64_MAX, err) : NULL;
    job.blocks = job.sums ? mem_array(job.n_blocks, sizeof *job.blocks, UINT64_MAX, err) : NULL;
    if (!job.blocks) {
        free(job.sums);
        free(normals);
        return false;
    }
    free(mesh->normals);
    mesh->normals = normals;
    int n_parts = n_threads > 0 ? n_threads : parallel_cores();
    parallel_run(n_parts, measure_blocks, &job);
    parallel_run(n_parts, make_normals, &job);
    free(job.sums);
    free(job.blocks);
    return true;
}
