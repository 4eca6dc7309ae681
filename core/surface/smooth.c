/* Constrained smoothing of a marching cubes surface. surface.h says what surface_smooth promises.
 *
 *   1. marching cubes with the graph of its vertices: four links each (marching_cubes.h). Where the slices are far
 *      apart, the vertices start where shape-based interpolation puts them (smooth_slices.c), else at the middles of
 *      their edges
 *   2. two low-pass filters on the graph remove the voxel steps: they give the position of each vertex without
 *      constraints. The strong filter also removes long, flat steps, but would shrink small structures
 *   3. each vertex moves along its own grid edge to where the edge meets the filtered surface: the strongly filtered
 *      one, or more of the gently filtered one where the strong one leaves the edges nearby
 *   4. each closed piece is moved along its normals until it encloses the volume of its univels (smooth_volume.c)
 *   5. no vertex leaves the part of its edge that `most` allows
 *
 * A filter is a polynomial in A, the mean over a vertex' four links (weighted by their lengths where the slices are far
 * apart, so that curvature from slice to slice is not smoothed away), as a sum of Chebyshev polynomials T_n(A) (G.
 * Taubin, T. Zhang, G. Golub, Optimal Surface Smoothing as Filter Design, ECCV 1996). A is symmetric with eigenvalues
 * in [-1, 1], so nothing grows. Stored are the displacements e_n from the start p, T_n(A) p = p + e_n, because small
 * numbers keep more digits: e_0 = 0, e_1 = A p - p, e_(n+1) = 2 (A e_n + e_1) - e_(n-1).
 *
 * Every pass reads the result of the pass before and writes each vertex once, so threads cannot change a byte. The
 * filters work in grid coordinates: they only take means, which are independent of the lengths of the axes. */
#include "core/surface/smooth.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/marching_rows.h"
#include "core/surface/smooth_pass.h"

enum {
    VERTICES_A_THREAD = 8192,
    CAUTIOUS_ROUNDS = 1,
    EVEN_ROUNDS = 2,
    MAX_PASSES_TO_EDGES = 4 + CAUTIOUS_ROUNDS + EVEN_ROUNDS
};

/* Found on tilted ellipsoids with slice distances of 1 to 5.5 pixels, by comparison with the exact normals. */
const struct smooth_options smooth_defaults = { 24, 0.035, 0.15, 0.5 - SURFACE_SMOOTH_MARGIN, 8, 1.2 };

/* The strong filter is fully trusted up to the first shift (in edge lengths), and not at all from the second on. */
static const float trusted_shift = 0.5f, distrusted_shift = 0.8f;

/* Cosines of the angles between the normals of the two filtered surfaces: 26 and 60 degrees. */
static const float agreeing = 0.9f, disagreeing = 0.5f;

/* ---- the filters ------------------------------------------------------------------------------------------------ */

typedef uint16_t short4 __attribute__((vector_size(8))); /* at2 of a marching_point, and one unused lane */

static inline short4 load_point(const struct marching_point *point)
{
    short4 at2;
    memcpy(&at2, point, sizeof at2);
    return at2;
}

static void first_step(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    typedef int16_t signed4 __attribute__((vector_size(8)));
    const struct marching_point *points = job->graph->points;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        short4 sum = load_point(&points[link[0]]) + load_point(&points[link[1]]) + load_point(&points[link[2]]) +
                     load_point(&points[link[3]]);
        signed4 eighths = (signed4)(sum - load_point(&points[v]) * 4); /* fits 16 bits: links are near */
        float4 away = __builtin_convertvector(eighths, float4) * 0.125f;
        job->before[v] = (float4){ 0, 0, 0, 0 };
        job->first[v] = job->now[v] = away;
        job->strong[v] = pass->strong[0] * away;
        job->gentle[v] = pass->gentle[0] * away;
    }
}

/* How a link is weighted: within a slice, from slice to slice, or between a slice and the space beside it. */
enum { WITHIN_SLICE = 0, ACROSS_SLICES = 1, TO_TERRACE = 2 };

static inline unsigned class_of_link(const struct marching_point *a, const struct marching_point *b, int axis)
{
    bool is_across = a->at2[axis] != b->at2[axis], has_terrace = (a->axis == axis) | (b->axis == axis);
    return (unsigned)is_across << (unsigned)has_terrace; /* a class as above */
}

/* Makes the first step from start positions between slices, with weighted links. */
INLINED void first_step_along(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end,
                              int axis)
{
    const struct marching_point *points = job->graph->points;
    const float4 along = smooth_along(axis, 1);
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        float4 start = smooth_middle(&points[v]) + along * job->start[v], starts[4];
        unsigned classes = 0;
        for (int i = 0; i < 4; i++) {
            starts[i] = smooth_middle(&points[link[i]]) + along * job->start[link[i]];
            classes |= class_of_link(&points[v], &points[link[i]], axis) << 2 * i;
        }
        job->classes[v] = (uint8_t)classes;
        const float *weights = job->weights[classes];
        float4 twice = weights[0] * (starts[0] - start) + weights[1] * (starts[1] - start) +
                       weights[2] * (starts[2] - start) + weights[3] * (starts[3] - start);
        float4 away = 0.5f * twice;
        job->before[v] = (float4){ 0, 0, 0, 0 };
        job->first[v] = twice;
        job->now[v] = away;
        job->strong[v] = pass->strong[0] * away;
        job->gentle[v] = pass->gentle[0] * away;
    }
}

static void first_step_between_slices(const struct smooth_job *job, const struct smooth_pass *pass, size_t from,
                                      size_t end)
{
    if (job->slice_axis == 2)
        first_step_along(job, pass, from, end, 2);
    else
        first_step_along(job, pass, from, end, job->slice_axis);
}

static inline float4 add_terms(float4 sum, const float weights[SMOOTH_MAX_TERMS], float4 next, float4 now,
                               float4 before, int n_terms)
{
    if (n_terms > 2)
        sum += weights[2] * before;
    if (n_terms > 1)
        sum += weights[1] * now;
    return sum + weights[0] * next;
}

INLINED void next_steps(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end,
                        int n_terms, bool has_gentle, bool is_weighted)
{
    const float4 *now = pass->now, *first = job->first;
    float4 *to = pass->next, *strong = job->strong, *gentle = job->gentle;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        float4 twice;
        if (is_weighted) {
            const float *weights = job->weights[job->classes[v]];
            twice = (weights[0] * now[link[0]] + weights[1] * now[link[1]]) +
                    (weights[2] * now[link[2]] + weights[3] * now[link[3]]) + (weights[4] * now[v] + first[v]);
        } else {
            twice = 2 * ((now[link[0]] + now[link[1]] + now[link[2]] + now[link[3]]) * 0.25f + first[v]);
        }
        float4 before = to[v], next = twice - before;
        to[v] = next;
        if (n_terms > 0)
            strong[v] = add_terms(strong[v], pass->strong, next, now[v], before, n_terms);
        if (n_terms > 0 && has_gentle)
            gentle[v] = add_terms(gentle[v], pass->gentle, next, now[v], before, n_terms);
    }
}

INLINED void next_step_of(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end,
                          bool is_weighted)
{
    if (pass->n_terms == 0)
        next_steps(job, pass, from, end, 0, false, is_weighted);
    else if (pass->n_terms == 1)
        next_steps(job, pass, from, end, 1, pass->has_gentle, is_weighted);
    else if (pass->n_terms == 2)
        next_steps(job, pass, from, end, 2, pass->has_gentle, is_weighted);
    else if (pass->has_gentle)
        next_steps(job, pass, from, end, 3, true, is_weighted);
    else
        next_steps(job, pass, from, end, 3, false, is_weighted);
}

static void next_step(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    next_step_of(job, pass, from, end, false);
}

static void next_step_weighted(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    next_step_of(job, pass, from, end, true);
}

/* Weights of the Chebyshev polynomials for a step from 1 to 0 at the frequency `band` of 1 - A, times a Hamming window.
 * Their sum is 1, so that flat surfaces stay in place. */
static void make_weights(double band, int n_steps, double weights[SMOOTH_MAX_STEPS + 1])
{
    double edge = acos(1 - band), total = 0;
    for (int n = 0; n <= n_steps; n++) {
        double window = 0.54 + 0.46 * cos(MATH_PI * n / (n_steps + 1));
        weights[n] = window * (n ? 2 * sin(n * edge) / (n * MATH_PI) : edge / MATH_PI);
        total += weights[n];
    }
    for (int n = 0; n <= n_steps; n++)
        weights[n] /= total;
}

/* The weight of a link falls with the distance it bridges; the weights of both directions are equal, so that A stays
 * symmetric. A link to a terrace bridges half of the distance between slices or less. */
static void make_link_weights(struct smooth_job *job)
{
    float pixel_mm = sqrtf(job->edge_mm[(job->slice_axis + 1) % 3] * job->edge_mm[(job->slice_axis + 2) % 3]);
    float across = pixel_mm / job->edge_mm[job->slice_axis];
    const float of_class[4] = {
        [WITHIN_SLICE] = 0.5f, [ACROSS_SLICES] = 0.5f * across, [TO_TERRACE] = 0.5f * sqrtf(across)
    };
    for (unsigned classes = 0; classes < 256; classes++) {
        float *weights = job->weights[classes], rest = 2;
        for (int i = 0; i < 4; i++) {
            weights[i] = of_class[classes >> 2 * i & 3];
            rest -= weights[i];
        }
        weights[4] = rest;
    }
}

/* Lists the passes of both filters; passes has room for SMOOTH_MAX_STEPS. */
static size_t plan_filters(const struct smooth_job *job, struct smooth_pass *passes)
{
    const struct smooth_options *options = &job->options;
    int n_gentle = options->n_steps / 2 > 0 ? options->n_steps / 2 : 1; /* enough for the wider band */
    double strong[SMOOTH_MAX_STEPS + 1], gentle[SMOOTH_MAX_STEPS + 1];
    make_weights(options->strong_band, options->n_steps, strong);
    make_weights(options->gentle_band, n_gentle, gentle);
    passes[0] = (struct smooth_pass){ .run = job->start ? first_step_between_slices : first_step,
                                      .strong = { (float)strong[1] },
                                      .gentle = { (float)gentle[1] } };
    void (*step)(const struct smooth_job *, const struct smooth_pass *, size_t, size_t) =
        job->start ? next_step_weighted : next_step;
    for (int n = 2, added = 1; n <= options->n_steps; n++) {
        struct smooth_pass *pass = &passes[n - 1];
        *pass = (struct smooth_pass){ .run = step,
                                      .now = n % 2 ? job->before : job->now,
                                      .next = n % 2 ? job->now : job->before };
        if (n - added < SMOOTH_MAX_TERMS && n < options->n_steps)
            continue;
        pass->n_terms = n - added;
        pass->has_gentle = added < n_gentle;
        for (int term = 0; term < pass->n_terms; term++) {
            pass->strong[term] = (float)strong[n - term];
            pass->gentle[term] = n - term <= n_gentle ? (float)gentle[n - term] : 0;
        }
        added = n;
    }
    return (size_t)options->n_steps;
}

/* ---- from filters to shifts along the edges --------------------------------------------------------------------- */

static float dot(float4 a, float4 b)
{
    float4 product = a * b;
    return product[0] + product[1] + product[2];
}

/* Perpendicular to the two lines through a vertex, from the positions of their ends; of any length; points outward
 * times the vertex' outward. */
static float4 normal_of(const float4 ends[4])
{
    float4 u = ends[3] - ends[0], w = ends[2] - ends[1];
    return smooth_turn(u * smooth_turn(w) - smooth_turn(u) * w);
}

/* Start of a vertex along its own edge, from the middle. */
static inline float start_along_edge(const struct smooth_job *job, size_t v)
{
    return job->start && job->graph->points[v].axis == job->slice_axis ? job->start[v] : 0;
}

/* Shift to where the edge meets the plane through the displaced vertex. An edge nearly parallel to that plane could
 * meet it anywhere, so there the displacement along the edge counts. */
static float shift_along_edge(float4 normal, float4 displacement, int axis)
{
    float along = normal[axis], flat = 0.01f * dot(normal, normal);
    if (!(flat > 0))
        return displacement[axis];
    return (along * dot(normal, displacement) + flat * displacement[axis]) / (along * along + flat);
}

static void place_gently(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    (void)pass;
    for (size_t v = from; v < end; v++)
        job->first[v] = smooth_start(job, v) + job->gentle[v];
}

/* Trust in the strong filter at each vertex, 0 to 1. */
static void rate_trust(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    const float4 *at = job->first;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        const float4 ends[4] = { at[link[0]], at[link[1]], at[link[2]], at[link[3]] };
        float shift = fabsf(start_along_edge(job, v) +
                            shift_along_edge(normal_of(ends), job->strong[v], job->graph->points[v].axis));
        float trust = (distrusted_shift - shift) / (distrusted_shift - trusted_shift);
        pass->next_trust[v] = trust < 0 ? 0 : trust > 1 ? 1 : trust;
    }
}

/* Lowers the trust of a vertex to the lowest of its links. */
static void lower_trust(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    const float *trust = pass->trust;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        float least = trust[v];
        for (int i = 0; i < 4; i++)
            least = trust[link[i]] < least ? trust[link[i]] : least;
        pass->next_trust[v] = least;
    }
}

/* Averages trust, so that a step of trust does not become a step of the surface. */
static void average_trust(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    const float *trust = pass->trust;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        pass->next_trust[v] =
            (2 * trust[v] + trust[link[0]] + trust[link[1]] + trust[link[2]] + trust[link[3]]) * (1 / 6.0f);
    }
}

/* Blends the two filters into the displacement of each vertex, by its trust. Keeps the strongly filtered positions for
 * the normals. */
static void blend_filters(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    for (size_t v = from; v < end; v++) {
        float trust = pass->trust[v];
        float4 start = smooth_start(job, v), strong = job->strong[v];
        float4 displacement = trust * strong + (1 - trust) * job->gentle[v];
        job->gentle[v] = displacement;
        job->now[v] = start + displacement;
        if (job->has_normals)
            job->first[v] = start + strong;
    }
}

/* Unit normal in patient space; 0 if it has no direction. */
static float4 in_lps(const struct smooth_job *job, float4 normal)
{
    float4 lps =
        normal[0] * job->lps_of_normal[0] + normal[1] * job->lps_of_normal[1] + normal[2] * job->lps_of_normal[2];
    float square = dot(lps, lps);
    return square > 0 ? lps / sqrtf(square) : lps;
}

/* Writes the normal for illumination: that of the strongly filtered surface without constraints, but less of it the
 * more it deviates from that of the blended surface. */
static void write_normal(const struct smooth_job *job, size_t v, float4 own, float4 strong)
{
    float agreement = dot(own, strong), share = (agreement - disagreeing) / (agreeing - disagreeing);
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    float4 shown = share * strong + (1 - share) * own;
    float square = dot(shown, shown);
    if (!(square > 0)) { /* no direction: take the edge's own */
        shown = job->lps_of_normal[job->graph->points[v].axis] * (float)job->graph->points[v].outward;
        square = dot(shown, shown);
    }
    shown /= sqrtf(square);
    memcpy(job->mesh->normals + 3 * v, &shown, 3 * sizeof(float));
}

static void shift_to_edges(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end)
{
    (void)pass;
    for (size_t v = from; v < end; v++) {
        const struct marching_point *point = &job->graph->points[v];
        const uint32_t *link = job->graph->links[v];
        const float4 *at = job->now;
        float4 normal =
            normal_of((float4[4]){ at[link[0]], at[link[1]], at[link[2]], at[link[3]] }) * (float)point->outward;
        job->shift[v] = start_along_edge(job, v) + shift_along_edge(normal, job->gentle[v], point->axis);
        if (job->has_normals) {
            at = job->first;
            float4 strong =
                normal_of((float4[4]){ at[link[0]], at[link[1]], at[link[2]], at[link[3]] }) * (float)point->outward;
            write_normal(job, v, in_lps(job, normal), in_lps(job, strong));
        }
        normal /= job->edge_mm; /* from grid coordinates to mm */
        float square = dot(normal, normal);
        job->lean[v] = square > 0 ? fabsf(normal[point->axis]) / sqrtf(square) : 1;
    }
}

/* Lists the passes; passes has room for MAX_PASSES_TO_EDGES. */
static size_t plan_way_to_edges(const struct smooth_job *job, struct smooth_pass *passes)
{
    size_t n = 0;
    float *trust = job->shift, *next_trust = job->lean; /* free until the last pass */
    passes[n++] = (struct smooth_pass){ .run = place_gently };
    passes[n++] = (struct smooth_pass){ .run = rate_trust, .next_trust = trust };
    for (int round = 0; round < CAUTIOUS_ROUNDS + EVEN_ROUNDS; round++) {
        passes[n++] = (struct smooth_pass){ .run = round < CAUTIOUS_ROUNDS ? lower_trust : average_trust,
                                            .trust = trust,
                                            .next_trust = next_trust };
        float *written = next_trust;
        next_trust = trust;
        trust = written;
    }
    passes[n++] = (struct smooth_pass){ .run = blend_filters, .trust = trust };
    passes[n++] = (struct smooth_pass){ .run = shift_to_edges };
    return n;
}

/* ---- smooth_with ------------------------------------------------------------------------------------------------ */

static void write_positions(void *context, int part, int n_parts)
{
    struct smooth_job *job = context;
    const struct affine *map = &job->graph->lps_mm_from_at;
    size_t v, end;
    for (smooth_range(job, part, n_parts, &v, &end); v < end; v++) {
        const struct marching_point *point = &job->graph->points[v];
        double at[3] = { point->at2[0] * 0.5, point->at2[1] * 0.5, point->at2[2] * 0.5 };
        at[point->axis] += (double)smooth_cut(job->shift[v], job->most[point->axis]);
        struct vec3 p = affine_point(map, vec3(at[0], at[1], at[2]));
        float *to = job->mesh->positions_lps_mm + 3 * v;
        to[0] = (float)p.x;
        to[1] = (float)p.y;
        to[2] = (float)p.z;
    }
}

static bool smooth(struct smooth_job *job, struct error *err)
{
    enum { N_VECTORS = 5, N_FLOATS = 2 };
    if (job->has_normals && !(job->mesh->normals = mem_large_array(job->n, 3 * sizeof(float), UINT64_MAX, err)))
        return false;
    size_t more = job->slice_axis >= 0 ? sizeof *job->start + sizeof *job->classes : 0;
    float4 *vectors =
        mem_large_array(job->n, N_VECTORS * sizeof(float4) + N_FLOATS * sizeof(float) + more, UINT64_MAX, err);
    if (!vectors)
        return false;
    job->first = vectors;
    job->now = vectors + job->n;
    job->before = vectors + 2 * job->n;
    job->strong = vectors + 3 * job->n;
    job->gentle = vectors + 4 * job->n;
    job->shift = (float *)(vectors + N_VECTORS * job->n);
    job->lean = job->shift + job->n;
    bool is_good = smooth_find_slices(job, err);
    if (is_good && job->slice_axis >= 0) {
        job->start = job->lean + job->n;
        job->classes = (uint8_t *)(job->start + job->n);
        make_link_weights(job);
        is_good = smooth_interpolate_slices(job, err);
    }
    if (is_good) {
        struct smooth_pass passes[SMOOTH_MAX_STEPS + MAX_PASSES_TO_EDGES];
        size_t n_passes = plan_filters(job, passes);
        n_passes += plan_way_to_edges(job, passes + n_passes);
        smooth_run_passes(job, passes, n_passes);
        is_good = job->options.n_volume_steps == 0 || smooth_keep_volume(job, err);
        parallel_run(job->n_threads, write_positions, job);
        mesh_measure_bounds(job->mesh);
    }
    free(job->begin);
    free(vectors);
    return is_good;
}

/* A normal is perpendicular to the surface, so it is mapped by the reciprocal axes of the grid: each perpendicular to
 * the two others. */
static void reciprocals_of(const struct affine *map, float4 axes[3])
{
    double determinant = affine_determinant(map);
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 across = vec3_cross(map->columns[(axis + 1) % 3], map->columns[(axis + 2) % 3]);
        across = vec3_scale(across, 1 / determinant);
        axes[axis] = (float4){ (float)across.x, (float)across.y, (float)across.z, 0 };
    }
}

static int threads_for(size_t n_vertices, int n_threads)
{
    size_t n = n_threads > 0 ? (size_t)n_threads : (size_t)parallel_cores();
    size_t worth = n_vertices / VERTICES_A_THREAD + 1; /* with fewer vertices a thread does not pay for its start */
    n = n < worth ? n : worth;
    return n < SMOOTH_MAX_THREADS ? (int)n : SMOOTH_MAX_THREADS;
}

struct mesh *smooth_with(const struct smooth_options *smoothing, const struct mask *mask,
                         const struct surface_options *options, struct error *err)
{
    assert(smoothing->n_steps >= 1 && smoothing->n_steps <= SMOOTH_MAX_STEPS && smoothing->max_shift < 0.5);
    struct marching_graph graph = { .has_no_positions = true };
    struct mesh *mesh = marching_cubes_run(MARCHING_CUBES_BEST, mask, options, &graph, err);
    if (!mesh)
        return NULL;
    const struct affine *map = &mask->lps_mm_from_ijk;
    struct smooth_job job = {
        .options = *smoothing,
        .graph = &graph,
        .mesh = mesh,
        .n = mesh->n_vertices,
        .n_threads = threads_for(mesh->n_vertices, options->n_threads),
        .edge_mm = { (float)vec3_length(map->columns[0]), (float)vec3_length(map->columns[1]),
                     (float)vec3_length(map->columns[2]), 1 },
        .is_mirrored = affine_determinant(map) < 0,
        .has_normals = !options->without_normals,
        .univel_mm3 = fabs(affine_determinant(map)),
        .mask_size = { mask->size[0], mask->size[1], mask->size[2] },
    };
    job.slice_axis =
        smooth_slice_axis((float[3]){ job.edge_mm[0], job.edge_mm[1], job.edge_mm[2] }, smoothing->slice_ratio);
    float least = fminf(job.edge_mm[0], fminf(job.edge_mm[1], job.edge_mm[2]));
    for (int axis = 0; axis < 3; axis++)
        job.most[axis] = axis == job.slice_axis
                             ? 0.5f - (0.5f - (float)smoothing->max_shift) * least / job.edge_mm[axis]
                             : (float)smoothing->max_shift;
    reciprocals_of(map, job.lps_of_normal);
    if (!options->close_at_border)
        job.options.n_volume_steps = 0; /* an open surface encloses no volume */
    bool is_smooth = smooth(&job, err);
    marching_graph_finish(&graph);
    if (!is_smooth) {
        mesh_unref(mesh);
        return NULL;
    }
    return mesh;
}

struct mesh *surface_smooth(const struct mask *mask, const struct surface_options *options, struct error *err)
{
    return smooth_with(&smooth_defaults, mask, options, err);
}
