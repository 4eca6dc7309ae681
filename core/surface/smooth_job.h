#pragma once
/* Inside surface_smooth: the state shared by its files. */
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "core/surface/marching_cubes.h"
#include "core/surface/smooth_options.h"

/* x, y, z in grid coordinates and one more float, on any processor with 16-byte vectors. */
typedef float float4 __attribute__((vector_size(16)));

enum { SMOOTH_MAX_THREADS = 64 };

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
    uint32_t mask_size[3];
    int32_t n_slices; /* along z */
    size_t *begin;    /* [n_slices + 1] first vertex of each slice */

    int slice_axis;   /* across which the slices are far apart; -1: none */
    float most[3];    /* greatest shift along each axis */
    float *start;     /* [n] start position along slice_axis, from the middle of the edge; NULL without slice_axis */
    uint8_t *classes; /* [n] with slice_axis: two bits for the weight of each link, see smooth.c */
    float weights[256][8]; /* by classes: twice the weights of the four links and of the vertex itself */

    float4 *first, *now, *before; /* e_1, e_n, e_(n-1), see smooth.c; free for other use afterwards */
    float4 *strong, *gentle;      /* displacements by the two filters */

    float *shift; /* of each vertex along its own edge, from its middle; clamped to `most` when it is used */
    float *lean;  /* cosine of edge and normal, in mm: how squarely the edge meets the surface */
};

static inline void smooth_range(const struct smooth_job *job, int part, int n_parts, size_t *from, size_t *end)
{
    *from = job->n * (size_t)part / (size_t)n_parts;
    *end = job->n * (size_t)(part + 1) / (size_t)n_parts;
}

/* Middle of a vertex' edge; the fourth lane is unused. */
static inline float4 smooth_middle(const struct marching_point *point)
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

/* Start position of a vertex. */
static inline float4 smooth_start(const struct smooth_job *job, size_t v)
{
    float4 middle = smooth_middle(&job->graph->points[v]);
    return job->start ? middle + smooth_along(job->slice_axis, job->start[v]) : middle;
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

/* Axis across which the slices are far apart: more than `ratio` times as far as the univels along either other axis;
 * -1 if there is none. */
int smooth_slice_axis(const float edge_mm[3], double ratio);
/* Fills job->start: the start positions between slices (smooth_slices.c). Uses first, now, before and strong. Errors:
 * ERROR_MEMORY. */
NODISCARD bool smooth_interpolate_slices(struct smooth_job *job, struct error *err);
