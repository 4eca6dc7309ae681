#pragma once
/* Inside surface_smooth: the state shared by smooth.c and smooth_volume.c. */
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "core/surface/marching_cubes.h"
#include "core/surface/smooth_options.h"

/* x, y, z in grid coordinates and one more float, on any processor with 16-byte vectors. */
typedef float float4 __attribute__((vector_size(16)));

struct smooth_job {
    struct smooth_options options;
    const struct marching_graph *graph;
    struct mesh *mesh;
    size_t n; /* number of vertices */
    int n_threads;
    float4 edge_mm;          /* edges of a univel; the fourth is 1 */
    float4 lps_of_normal[3]; /* patient direction of a normal along each grid axis */
    bool is_mirrored;
    bool has_normals;
    double univel_mm3;

    float4 *first, *now, *before; /* e_1, e_n, e_(n-1), see smooth.c; free for other use afterwards */
    float4 *strong, *gentle;      /* displacements by the two filters */

    float *shift; /* of each vertex along its own edge, from its middle; clamped to max_shift when it is used */
    float *lean;  /* cosine of edge and normal, in mm: how squarely the edge meets the surface */
};

static inline void smooth_range(const struct smooth_job *job, int part, int n_parts, size_t *from, size_t *end)
{
    *from = job->n * (size_t)part / (size_t)n_parts;
    *end = job->n * (size_t)(part + 1) / (size_t)n_parts;
}

/* Start position of a vertex; the fourth lane is unused. */
static inline float4 smooth_start(const struct marching_point *point)
{
    typedef int16_t short4 __attribute__((vector_size(8)));
    short4 at2;
    memcpy(&at2, point, sizeof at2);
    return __builtin_convertvector(at2, float4) * 0.5f;
}

/* Vector along a grid axis. */
static inline float4 smooth_along(int axis, float length)
{
    static const float4 units[3] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } };
    return units[axis] * length;
}

static inline float4 smooth_turn(float4 v) /* y, z, x */
{
    return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}

static inline float smooth_cut(float value, float most)
{
    return value > most ? most : value < -most ? -most : value;
}

/* Moves each closed piece of the surface along its normals until it encloses the volume of its univels
 * (smooth_volume.c). Errors: ERROR_MEMORY. */
NODISCARD bool smooth_keep_volume(struct smooth_job *job, struct error *err);
