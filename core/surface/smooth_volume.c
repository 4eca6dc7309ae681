/* The volume of a smoothed surface, piece by piece. A piece is what hangs together of the surface: one closed sheet. */
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/smooth_job.h"

enum { CHUNK = 32768, MAX_PIECES_SPLIT = 64, PATIENCE = 4 };
static const double tolerance = 1e-3; /* of a piece's volume */

struct piece {
    double wanted, volume, before; /* univels within: to be, now, at the step before */
    double area_mm2;
    double swelling_mm; /* of this step */
    bool is_settled;
};

struct volume_job {
    struct smooth_job *smooth;
    struct piece *pieces;
    uint32_t n_pieces;
    uint32_t *piece_of; /* [n_vertices] */
    float4 *at;         /* [n_vertices] */
    double *sums;       /* [n_chunks][n_pieces] */
    size_t n_chunks;
};

static uint32_t root_of(uint32_t *up, uint32_t v)
{
    while (up[v] != v) {
        up[v] = up[up[v]];
        v = up[v];
    }
    return v;
}

/* The lowest number is the root, so pieces are numbered in the order of their first vertices. */
static void find_pieces(struct volume_job *job)
{
    uint32_t *up = job->piece_of;
    for (uint32_t v = 0; v < job->smooth->n; v++) {
        const uint32_t *link = job->smooth->graph->links[v];
        uint32_t root = up[v] = v;
        for (int i = 0; i < 4; i++) {
            if (link[i] >= v)
                continue; /* seen from there */
            uint32_t other = root_of(up, link[i]);
            if (other < root) {
                up[root] = other;
                root = other;
            } else {
                up[other] = root;
            }
        }
    }
    job->n_pieces = 0;
    for (uint32_t v = 0; v < job->smooth->n; v++) /* a root comes before what hangs on it */
        up[v] = up[v] == v ? job->n_pieces++ : up[up[v]];
}

/* The univels within each piece: along a row of the grid, what lies between where it is entered and where it is left. And its area: a
 * crossed edge stands for one face of a univel, seen aslant. */
static void measure_wanted(struct volume_job *job)
{
    const struct smooth_job *smooth = job->smooth;
    float4 edge = smooth->edge_mm;
    const float faces_mm2[3] = { edge[1] * edge[2], edge[2] * edge[0], edge[0] * edge[1] };
    for (size_t v = 0; v < smooth->n; v++) {
        const struct marching_point *point = &smooth->graph->points[v];
        struct piece *piece = &job->pieces[job->piece_of[v]];
        if (point->axis == 0)
            piece->wanted += point->outward * (point->at2[0] * 0.5);
        piece->area_mm2 += (double)(faces_mm2[point->axis] * smooth->lean[v]);
    }
}

static void place(void *context, int part, int n_parts)
{
    struct volume_job *job = context;
    const struct smooth_job *smooth = job->smooth;
    float most = (float)smooth->options.max_shift;
    size_t v, end;
    for (smooth_range(smooth, part, n_parts, &v, &end); v < end; v++) {
        const struct marching_point *point = &smooth->graph->points[v];
        if (!job->pieces[job->piece_of[v]].is_settled)
            job->at[v] = smooth_start(point) + smooth_along(point->axis, smooth_cut(smooth->shift[v], most));
    }
}

/* In a right-handed grid the volume of the prism along x between a triangle and x = 0, positive where it faces x. */
static double prism(const struct volume_job *job, size_t triangle)
{
    const uint32_t *v = job->smooth->mesh->indices + 3 * triangle;
    float4 a = job->at[v[0]], u = job->at[v[1]] - a, w = job->at[v[2]] - a;
    return (double)((u[1] * w[2] - u[2] * w[1]) * (a[0] + (u[0] + w[0]) / 3)) / 2;
}

static size_t chunk_end(const struct volume_job *job, size_t chunk)
{
    size_t end = (chunk + 1) * CHUNK, n = job->smooth->mesh->n_triangles;
    return end < n ? end : n;
}

static void measure_chunks(void *context, int part, int n_parts)
{
    struct volume_job *job = context;
    size_t end = job->n_chunks * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t chunk = job->n_chunks * (size_t)part / (size_t)n_parts; chunk < end; chunk++) {
        double *sums = job->sums + chunk * job->n_pieces;
        memset(sums, 0, job->n_pieces * sizeof *sums);
        for (size_t t = chunk * CHUNK, last = chunk_end(job, chunk); t < last; t++) {
            uint32_t piece = job->piece_of[job->smooth->mesh->indices[3 * t]];
            if (!job->pieces[piece].is_settled)
                sums[piece] += prism(job, t);
        }
    }
}

/* Of the pieces that are not settled. By chunks that are added in their order, so that threads do not matter; with many pieces by one thread. */
static void measure_volumes(struct volume_job *job)
{
    double sign = job->smooth->is_mirrored ? -1 : 1;
    for (uint32_t p = 0; p < job->n_pieces; p++)
        if (!job->pieces[p].is_settled)
            job->pieces[p].volume = 0;
    parallel_run(job->smooth->n_threads, place, job);
    if (!job->sums) {
        for (size_t t = 0; t < job->smooth->mesh->n_triangles; t++) {
            struct piece *piece = &job->pieces[job->piece_of[job->smooth->mesh->indices[3 * t]]];
            if (!piece->is_settled)
                piece->volume += sign * prism(job, t);
        }
        return;
    }
    parallel_run(job->smooth->n_threads, measure_chunks, job);
    for (size_t chunk = 0; chunk < job->n_chunks; chunk++)
        for (uint32_t p = 0; p < job->n_pieces; p++)
            job->pieces[p].volume += sign * job->sums[chunk * job->n_pieces + p];
}

/* How far each piece is to swell: at first what its area says, then what the volume's answer to the last step says. False: none. */
static bool plan_swelling(struct volume_job *job, int step)
{
    bool is_needed = false;
    for (uint32_t p = 0; p < job->n_pieces; p++) {
        struct piece *piece = &job->pieces[p];
        if (piece->is_settled)
            continue;
        double missing = piece->wanted - piece->volume, univels_a_mm = piece->area_mm2 / job->smooth->univel_mm3;
        if (step > 0 && piece->swelling_mm != 0) {
            double seen = (piece->volume - piece->before) / piece->swelling_mm;
            double least = 0.2 * univels_a_mm; /* much less is seen where the ends of the edges hold the surface */
            univels_a_mm = seen > least ? seen : least;
        }
        bool is_off = fabs(missing) > tolerance * fabs(piece->wanted) && univels_a_mm > 0;
        if (step >= PATIENCE && fabs(piece->volume - piece->before) < 0.02 * fabs(missing))
            is_off = false; /* the edges end here; before, vertices may have been beyond the ends, coming back */
        piece->before = piece->volume;
        piece->swelling_mm = is_off ? missing / univels_a_mm : 0;
        piece->is_settled = !is_off;
        is_needed |= is_off;
    }
    return is_needed;
}

static void swell(void *context, int part, int n_parts)
{
    struct volume_job *job = context;
    struct smooth_job *smooth = job->smooth;
    size_t v, end;
    for (smooth_range(smooth, part, n_parts, &v, &end); v < end; v++) {
        if (job->pieces[job->piece_of[v]].is_settled)
            continue;
        const struct marching_point *point = &smooth->graph->points[v];
        float lean = smooth->lean[v], mm = (float)job->pieces[job->piece_of[v]].swelling_mm;
        /* as far along the edge as moves the surface by mm, but not without end where edge and surface are nearly parallel */
        smooth->shift[v] += (float)point->outward * mm * lean / ((lean * lean + 0.1f) * smooth->edge_mm[point->axis]);
    }
}

bool smooth_keep_volume(struct smooth_job *smooth, struct error *err)
{
    struct volume_job job = {
        .smooth = smooth,
        .at = smooth->now,
        .piece_of = (uint32_t *)smooth->before,
        .n_chunks = (smooth->mesh->n_triangles + CHUNK - 1) / CHUNK,
    };
    find_pieces(&job);
    job.pieces = mem_array(job.n_pieces, sizeof *job.pieces, UINT64_MAX, err);
    bool is_split = job.n_pieces <= MAX_PIECES_SPLIT;
    if (job.pieces && is_split)
        job.sums = mem_array(job.n_chunks * job.n_pieces, sizeof *job.sums, UINT64_MAX, err);
    bool is_good = job.pieces && (!is_split || job.sums);
    if (is_good) {
        measure_wanted(&job);
        for (int step = 0; step < smooth->options.n_volume_steps; step++) {
            measure_volumes(&job);
            if (!plan_swelling(&job, step))
                break;
            parallel_run(smooth->n_threads, swell, &job);
        }
    }
    free(job.pieces);
    free(job.sums);
    return is_good;
}
