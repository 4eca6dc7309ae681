/* Creates and measures triangle meshes: volume, open edges, Euler number. */
#include "core/surface/mesh.h"

#include <limits.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"

/* Indices have 32 bits; the largest value is not used, so that the count fits too. */
#define MESH_MAX_VERTICES ((uint64_t)UINT32_MAX)
#define MESH_MAX_BYTES ((uint64_t)16 << 30)

struct mesh *mesh_create(size_t n_vertices, size_t n_triangles, struct error *err)
{
    if (n_vertices > MESH_MAX_VERTICES) {
        error_set(err, ERROR_LIMIT, "a mesh of %zu vertices: at most %llu can be numbered", n_vertices,
                  (unsigned long long)MESH_MAX_VERTICES);
        return NULL;
    }
    struct mesh *mesh = mem_new(sizeof *mesh);
    atomic_init(&mesh->references, 1);
    mesh->n_vertices = n_vertices;
    mesh->n_triangles = n_triangles;
    mesh->bounds_lps_mm = box3_empty();
    /* one float more: vector code loads four floats of the last vertex */
    mesh->positions_lps_mm = mem_large_array(3 * n_vertices + 1, sizeof(float), MESH_MAX_BYTES, err);
    mesh->indices =
        mesh->positions_lps_mm ? mem_large_array(n_triangles, 3 * sizeof(uint32_t), MESH_MAX_BYTES, err) : NULL;
    if (!mesh->indices) {
        mesh_unref(mesh);
        return NULL;
    }
    return mesh;
}

struct mesh *mesh_ref(const struct mesh *mesh)
{
    struct mesh *shared = (struct mesh *)mesh;
    atomic_fetch_add(&shared->references, 1);
    return shared;
}

void mesh_unref(const struct mesh *mesh)
{
    struct mesh *shared = (struct mesh *)mesh;
    if (!shared || atomic_fetch_sub(&shared->references, 1) != 1)
        return;
    free(shared->positions_lps_mm);
    free(shared->normals);
    free(shared->indices);
    free(shared);
}

static struct vec3 position(const struct mesh *mesh, uint32_t vertex)
{
    const float *p = mesh->positions_lps_mm + 3 * (size_t)vertex;
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

void mesh_measure_bounds(struct mesh *mesh)
{
    mesh->bounds_lps_mm = box3_empty();
    if (mesh->n_vertices == 0)
        return;
    /* four vertices at a time, so that the compiler uses whole vectors and each lane keeps its axis */
    enum { FOUR = 12 };
    const float *p = mesh->positions_lps_mm;
    float low[FOUR], high[FOUR];
    for (size_t lane = 0; lane < FOUR; lane++)
        low[lane] = high[lane] = p[lane % 3];
    size_t at = 0, end = 3 * mesh->n_vertices;
    for (; end - at >= FOUR; at += FOUR)
        for (size_t lane = 0; lane < FOUR; lane++) {
            low[lane] = p[at + lane] < low[lane] ? p[at + lane] : low[lane];
            high[lane] = p[at + lane] > high[lane] ? p[at + lane] : high[lane];
        }
    for (; at < end; at++) {
        low[at % 3] = p[at] < low[at % 3] ? p[at] : low[at % 3];
        high[at % 3] = p[at] > high[at % 3] ? p[at] : high[at % 3];
    }
    for (size_t lane = 0; lane < FOUR; lane += 3) {
        box3_add(&mesh->bounds_lps_mm, vec3((double)low[lane], (double)low[lane + 1], (double)low[lane + 2]));
        box3_add(&mesh->bounds_lps_mm, vec3((double)high[lane], (double)high[lane + 1], (double)high[lane + 2]));
    }
}

double mesh_area_mm2(const struct mesh *mesh)
{
    double twice = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        struct vec3 a = position(mesh, v[0]);
        twice += vec3_length(vec3_cross(vec3_sub(position(mesh, v[1]), a), vec3_sub(position(mesh, v[2]), a)));
    }
    return twice / 2;
}

double mesh_volume_mm3(const struct mesh *mesh)
{
    if (mesh->n_triangles == 0)
        return 0;
    /* tetrahedra from a vertex of the mesh: from a far origin they would cancel badly */
    struct vec3 apex = position(mesh, mesh->indices[0]);
    double six_times = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        struct vec3 a = vec3_sub(position(mesh, v[0]), apex);
        struct vec3 b = vec3_sub(position(mesh, v[1]), apex);
        struct vec3 c = vec3_sub(position(mesh, v[2]), apex);
        six_times += vec3_dot(a, vec3_cross(b, c));
    }
    return six_times / 6;
}

/* ---- edges ------------------------------------------------------------------------------------------------------ */

struct edge_counts {
    size_t edges; /* distinct edges, without direction */
    size_t open;  /* directed edges without exactly one opposite */
    size_t used_vertices;
};

/* A directed edge, stored at its lower vertex: the other end, with 1 in the lowest bit if it points down. */
typedef uint64_t half_edge;

static int compare_half_edges(const void *a, const void *b)
{
    half_edge x = *(const half_edge *)a, y = *(const half_edge *)b;
    return x < y ? -1 : x > y;
}

static void sort_half_edges(half_edge *at, size_t n)
{
    if (n > 32) {
        qsort(at, n, sizeof *at, compare_half_edges);
        return;
    }
    for (size_t i = 1; i < n; i++) {
        half_edge value = at[i];
        size_t hole = i;
        for (; hole > 0 && at[hole - 1] > value; hole--)
            at[hole] = at[hole - 1];
        at[hole] = value;
    }
}

static void count_around_vertex(uint32_t vertex, const half_edge *at, size_t n, struct edge_counts *counts)
{
    for (size_t first = 0, end; first < n; first = end) {
        size_t up = 0, down = 0;
        for (end = first; end < n && at[end] >> 1 == at[first] >> 1; end++)
            *(at[end] & 1 ? &down : &up) += 1;
        counts->edges++;
        if (up != 1 || down != 1 || at[first] >> 1 == vertex)
            counts->open += up + down;
    }
}

static bool count_edges(const struct mesh *mesh, struct edge_counts *counts)
{
    *counts = (struct edge_counts){ 0 };
    size_t n_half = 3 * mesh->n_triangles;
    /* first[v] .. first[v + 1] are the half edges of vertex v; built by counting, because sorting all would be
     * slower */
    size_t *first = mem_array(mesh->n_vertices + 2, sizeof *first, UINT64_MAX, NULL);
    half_edge *half = mem_array(n_half, sizeof *half, UINT64_MAX, NULL);
    bool *used = mem_array(mesh->n_vertices, sizeof *used, UINT64_MAX, NULL);
    bool good = first && half && used;
    if (good) {
        for (int pass = 0; pass < 2; pass++) {
            for (size_t at = 0; at < n_half; at++) {
                uint32_t from = mesh->indices[at], to = mesh->indices[at % 3 == 2 ? at - 2 : at + 1];
                uint32_t low = from < to ? from : to, high = from < to ? to : from;
                if (pass == 0)
                    first[low + 2]++;
                else
                    half[first[low + 1]++] = (half_edge)high << 1 | (from > to);
                used[from] = true;
            }
            for (size_t v = 0; pass == 0 && v < mesh->n_vertices; v++)
                first[v + 2] += first[v + 1];
        }
        for (size_t v = 0; v < mesh->n_vertices; v++) {
            counts->used_vertices += used[v];
            sort_half_edges(half + first[v], first[v + 1] - first[v]);
            count_around_vertex((uint32_t)v, half + first[v], first[v + 1] - first[v], counts);
        }
    }
    free(first);
    free(half);
    free(used);
    return good;
}

size_t mesh_open_edges(const struct mesh *mesh)
{
    struct edge_counts counts;
    return count_edges(mesh, &counts) ? counts.open : SIZE_MAX;
}

long mesh_euler(const struct mesh *mesh)
{
    struct edge_counts counts;
    if (!count_edges(mesh, &counts))
        return LONG_MIN;
    return (long)counts.used_vertices - (long)counts.edges + (long)mesh->n_triangles;
}
