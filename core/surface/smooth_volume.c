/* Corrects the volume of a smoothed surface, piece by piece. A piece is a connected component: one closed sheet. */
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/smooth_job.h"

enum { CHUNK = 32768, MAX_PIECES_SPLIT = 64, PATIENCE = 4 };
static const double tolerance = 1e-3; /* relative to a piece's volume */

struct piece {
    double wanted, volume, before; /* in univels: target, current, at the step before */
    double area_mm2;
    double offset_mm; /* of the current step */
    bool is_settled;
};

struct volume_job {
    struct smooth_job *smooth;
    struct piece *pieces;
    uint32_t n_pieces;
    uint32_t *piece_of;          /* [n_vertices] */
    float4 *at;                  /* [n_vertices] */
    double *sums;                /* [n_chunks][n_pieces] */
    size_t n_chunks, chunk_size; /* of triangles */
};

static uint32_t root_of(uint32_t *up, uint32_t v)
{
    while (up[v] != v) {
        up[v] = up[up[v]];
        v = up[v];
    }
    return v;
}

/* Union-find with the lowest number as root, so that pieces are numbered by their first vertices. */
static void find_pieces(struct volume_job *job)
{
    uint32_t *up = job->piece_of;
    for (uint32_t v = 0; v < job->smooth->n; v++) {
        const uint32_t *link = job->smooth->graph->links[v];
        uint32_t root = up[v] = v;
        for (int i = 0; i < 4; i++) {
            if (link[i] >= v || up[link[i]] == root)
                continue; /* that vertex comes later and sees the link, or is in this piece already */
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
    for (uint32_t v = 0; v < job->smooth->n; v++) /* a root comes before the vertices attached to it */
        up[v] = up[v] == v ? job->n_pieces++ : up[up[v]];
}

/* Counts the univels within each piece: along a grid row, those between where the piece is entered and left. Also
 * estimates its area: a crossed edge stands for one face of a univel, seen at an angle. */
static void measure_wanted(struct volume_job *job)
{
    const struct smooth_job *smooth = job->smooth;
    float4 edge = smooth->edge_mm;
    const float faces_mm2[3] = { edge[1] * edge[2], edge[2] * edge[0], edge[0] * edge[1] };
    for (size_t v = 0, end; v < smooth->n;
         v = end) { /* a run of vertices of one piece at a time, so that its sums stay in registers */
        uint32_t number = job->piece_of[v];
        struct piece *piece = &job->pieces[number];
        double wanted = piece->wanted, area_mm2 = piece->area_mm2;
        for (end = v; end < smooth->n && job->piece_of[end] == number; end++) {
            const struct marching_point *point = &smooth->graph->points[end];
            if (point->axis == 0)
                wanted += point->outward * (point->at2[0] * 0.5);
            area_mm2 += (double)(faces_mm2[point->axis] * smooth->lean[end]);
        }
        piece->wanted = wanted;
        piece->area_mm2 = area_mm2;
    }
}

static inline void place(const struct volume_job *job, size_t v)
{
    const struct marching_point *point = &job->smooth->graph->points[v];
    job->at[v] = smooth_middle(point) +
                 smooth_along(point->axis, smooth_cut(job->smooth->shift[v], job->smooth->most[point->axis]));
}

static void place_all(void *context, int part, int n_parts)
{
    const struct volume_job *job = context;
    size_t v, end;
    for (smooth_range(job->smooth, part, n_parts, &v, &end); v < end; v++)
        place(job, v);
}

/* In a right-handed grid: volume of the prism along x between a triangle and x = 0, positive if the triangle faces
 * x. */
static inline double prism(const float4 *at, const uint32_t v[3])
{
    float4 a = at[v[0]], u = at[v[1]] - a, w = at[v[2]] - a;
    float4 across = u * smooth_turn(w) - smooth_turn(u) * w; /* z, x, y */
    float4 middle = a + (u + w) / 3;
    return (double)(across[1] * middle[0]) / 2;
}

static void measure_chunk(const struct volume_job *job, size_t chunk)
{
    const uint32_t *indices = job->smooth->mesh->indices;
    double *sums = job->sums + chunk * job->n_pieces;
    size_t end = (chunk + 1) * job->chunk_size, n = job->smooth->mesh->n_triangles;
    end = end < n ? end : n;
    memset(sums, 0, job->n_pieces * sizeof *sums);
    for (size_t t = chunk * job->chunk_size, last; t < end; t = last) { /* a run of triangles of one piece at a time */
        uint32_t piece = job->piece_of[indices[3 * t]];
        bool is_settled = job->pieces[piece].is_settled;
        double sum = sums[piece];
        for (last = t; last < end && job->piece_of[indices[3 * last]] == piece; last++)
            if (!is_settled)
                sum += prism(job->at, indices + 3 * last);
        sums[piece] = sum;
    }
}

static void measure_chunks(void *context, int part, int n_parts)
{
    const struct volume_job *job = context;
    size_t end = job->n_chunks * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t chunk = job->n_chunks * (size_t)part / (size_t)n_parts; chunk < end; chunk++)
        measure_chunk(job, chunk);
}

/* Measures the pieces that are not settled. Chunks are added in ascending sequence, so that threads do not matter. */
static void measure_volumes(struct volume_job *job)
{
    double sign = job->smooth->is_mirrored ? -1 : 1;
    for (uint32_t p = 0; p < job->n_pieces; p++)
        if (!job->pieces[p].is_settled)
            job->pieces[p].volume = 0;
    parallel_run(job->smooth->n_threads, measure_chunks, job);
    for (size_t chunk = 0; chunk < job->n_chunks; chunk++)
        for (uint32_t p = 0; p < job->n_pieces; p++)
            job->pieces[p].volume += sign * job->sums[chunk * job->n_pieces + p];
}

/* Plans the offset of each piece: at first from its area, then from the effect of the last step on the volume. Returns
 * false if no piece is left. */
static bool plan_offsets(struct volume_job *job, int step)
{
    bool is_needed = false;
    for (uint32_t p = 0; p < job->n_pieces; p++) {
        struct piece *piece = &job->pieces[p];
        if (piece->is_settled)
            continue;
        double missing = piece->wanted - piece->volume, univels_a_mm = piece->area_mm2 / job->smooth->univel_mm3;
        if (step > 0 && piece->offset_mm != 0) {
            double seen = (piece->volume - piece->before) / piece->offset_mm;
            /* the effect is much smaller where the ends of the edges hold the surface */
            double least = 0.2 * univels_a_mm;
            univels_a_mm = seen > least ? seen : least;
        }
        bool is_off = fabs(missing) > tolerance * fabs(piece->wanted) && univels_a_mm > 0;
        if (step >= PATIENCE && fabs(piece->volume - piece->before) < 0.02 * fabs(missing))
            is_off = false; /* the edges end here; before, vertices may have been beyond the ends and on the way back */
        piece->before = piece->volume;
        piece->offset_mm = is_off ? missing / univels_a_mm : 0;
        piece->is_settled = !is_off;
        is_needed |= is_off;
    }
    return is_needed;
}

static void offset_pieces(void *context, int part, int n_parts)
{
    struct volume_job *job = context;
    struct smooth_job *smooth = job->smooth;
    size_t v, end;
    for (smooth_range(smooth, part, n_parts, &v, &end); v < end; v++) {
        if (job->pieces[job->piece_of[v]].is_settled)
            continue;
        const struct marching_point *point = &smooth->graph->points[v];
        float lean = smooth->lean[v], mm = (float)job->pieces[job->piece_of[v]].offset_mm;
        /* moves the surface by mm, but by a bounded distance along an edge that is nearly parallel to it */
        smooth->shift[v] += (float)point->outward * mm * lean / ((lean * lean + 0.1f) * smooth->edge_mm[point->axis]);
        place(job, v);
    }
}

bool smooth_keep_volume(struct smooth_job *smooth, struct error *err)
{
    struct volume_job job = {
        .smooth = smooth,
        .at = smooth->now,
        .piece_of = (uint32_t *)smooth->before,
    };
    find_pieces(&job);
    job.pieces = mem_array(job.n_pieces, sizeof *job.pieces, UINT64_MAX, err);
    job.chunk_size = job.n_pieces <= MAX_PIECES_SPLIT
                         ? CHUNK
                         : smooth->mesh->n_triangles + 1; /* many pieces: one thread does it all */
    job.n_chunks = (smooth->mesh->n_triangles + job.chunk_size - 1) / job.chunk_size;
    if (job.pieces)
        job.sums = mem_array(job.n_chunks * job.n_pieces, sizeof *job.sums, UINT64_MAX, err);
    bool is_good = job.pieces && job.sums;
    if (is_good) {
        measure_wanted(&job);
        parallel_run(smooth->n_threads, place_all, &job);
        for (int step = 0; step < smooth->options.n_volume_steps; step++) {
            measure_volumes(&job);
            if (!plan_offsets(&job, step))
                break;
            parallel_run(smooth->n_threads, offset_pieces, &job);
        }
    }
    free(job.pieces);
    free(job.sums);
    return is_good;
}
