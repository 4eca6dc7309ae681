/* Constrained smoothing of a marching-cubes surface. See surface_smooth in surface.h for what it promises.
 *
 *   1. marching cubes with the graph of its vertices: four links each (marching_cubes.h)
 *   2. two low-pass filters on the graph take the stairs away: where each vertex would go if nothing held it. The strong one also
 *      takes long, flat stairs, but would pull small things together
 *   3. each vertex goes along its own grid edge to where that edge meets the filtered surface: the strongly filtered one, the more
 *      gently filtered one the less the strong one stays on the edges thereabouts
 *   4. each closed piece is moved along its normals until it encloses the volume of its univels (smooth_volume.c)
 *   5. no vertex leaves the part of its edge that max_shift allows
 *
 * A filter is a polynomial in A, the mean over a vertex' four links, put together from Chebyshev polynomials T_n(A) (G. Taubin,
 * T. Zhang, G. Golub, Optimal Surface Smoothing as Filter Design, ECCV 1996). A is symmetric with eigenvalues within [-1, 1], so
 * nothing grows. What is kept are displacements e_n from the start p, T_n(A) p = p + e_n, as small numbers keep their digits:
 * e_0 = 0, e_1 = A p - p, e_(n+1) = 2 (A e_n + e_1) - e_(n-1).
 *
 * Every pass reads what the pass before wrote and writes each vertex once, so threads cannot change a byte. The filters work in the
 * coordinates of the grid: they only take means, which do not ask how long an axis is. */
#include "core/surface/smooth.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/smooth_job.h"

enum { MAX_THREADS = 64, VERTICES_A_THREAD = 8192, CAUTIOUS_ROUNDS = 1, EVEN_ROUNDS = 2 };

/* Found on tilted ellipsoids with slices of 1 to 5.5 times the pixel, against the exact normals. */
const struct smooth_options smooth_defaults = { 24, 0.035, 0.15, 0.5 - SURFACE_SMOOTH_MARGIN, 8 };

/* The strong filter is trusted where it wants a shift up to the first, not at all from the second on. */
static const float trusted_shift = 0.5f, distrusted_shift = 0.8f;

/* Cosines of the angle, 26 and 60 degrees, between normals of the two filtered surfaces. */
static const float agreeing = 0.9f, disagreeing = 0.5f;

/* ---- the filters --------------------------------------------------------------------------------------------------------- */

/* One step of the recurrence for the vertices from..end. */
struct step {
    int n;                /* gives e_n */
    const float4 *now;    /* e_(n-1) */
    float4 *next;         /* holds e_(n-2), gets e_n */
    float strong, gentle; /* weights of T_n */
};

static void first_step(const struct smooth_job *job, const struct step *step, size_t from, size_t end)
{
    const struct marching_point *points = job->graph->points;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        float4 sum = smooth_start(&points[link[0]]) + smooth_start(&points[link[1]]) + smooth_start(&points[link[2]]) +
                     smooth_start(&points[link[3]]);
        float4 away = sum * 0.25f - smooth_start(&points[v]); /* exact: halves */
        job->first[v] = step->next[v] = away;
        job->strong[v] = step->strong * away;
        job->gentle[v] = step->gentle * away;
    }
}

static void next_step(const struct smooth_job *job, const struct step *step, size_t from, size_t end)
{
    const float4 *now = step->now;
    bool has_gentle = step->gentle != 0;
    for (size_t v = from; v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        float4 mean = (now[link[0]] + now[link[1]] + now[link[2]] + now[link[3]]) * 0.25f;
        float4 next = 2 * (mean + job->first[v]);
        if (step->n > 2) /* e_0 is 0 */
            next -= step->next[v];
        step->next[v] = next;
        job->strong[v] += step->strong * next;
        if (has_gentle)
            job->gentle[v] += step->gentle * next;
    }
}

static void take_step(const struct smooth_job *job, const struct step *step, size_t from, size_t end)
{
    if (step->n == 1)
        first_step(job, step, from, end);
    else
        next_step(job, step, from, end);
}

/* Of the Chebyshev polynomials for a step from 1 to 0 at the frequency `band` of 1 - A, times a Hamming window. They add up to 1, so
 * that what is flat stays where it is. */
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

struct filter {
    struct smooth_job *job;
    struct step steps[SMOOTH_MAX_STEPS + 1];
    const struct step *step; /* the one that all threads take */
};

static void take_part(void *context, int part, int n_parts)
{
    const struct filter *filter = context;
    size_t from, end;
    smooth_range(filter->job, part, n_parts, &from, &end);
    take_step(filter->job, filter->step, from, end);
}

/* Vertices are in the order of slices and linked within three neighbouring ones. So a step can be taken slice by slice behind the
 * step before it, and what both touch is still in the cache: one thread takes BLOCK steps in one go through the slices. What a step
 * writes over, e_(n-2) of a slice, the step before has read for the slices around it. */
static bool take_all_by_slices(const struct filter *filter)
{
    enum { BLOCK = 6 };
    const struct smooth_job *job = filter->job;
    int32_t n_slices = job->graph->points[job->n - 1].at2[2] / 2 + 1;
    size_t *begin = mem_array((size_t)n_slices + 1, sizeof *begin, UINT64_MAX, NULL);
    if (!begin)
        return false;
    size_t v = 0;
    for (int32_t slice = 0; slice <= n_slices; slice++) {
        while (v < job->n && job->graph->points[v].at2[2] / 2 < slice)
            v++;
        begin[slice] = v;
    }
    for (int first = 1; first <= job->options.n_steps; first += BLOCK)
        for (int32_t front = 0; front < n_slices + BLOCK - 1; front++)
            for (int n = first; n < first + BLOCK && n <= job->options.n_steps; n++) {
                int32_t slice = front - (n - first);
                if (slice >= 0 && slice < n_slices)
                    take_step(job, &filter->steps[n], begin[slice], begin[slice + 1]);
            }
    free(begin);
    return true;
}

static void filter(struct smooth_job *job)
{
    const struct smooth_options *options = &job->options;
    int n_gentle = options->n_steps / 2 > 0 ? options->n_steps / 2 : 1; /* all it takes for the wider band */
    double strong[SMOOTH_MAX_STEPS + 1], gentle[SMOOTH_MAX_STEPS + 1];
    struct filter filter = { .job = job };
    make_weights(options->strong_band, options->n_steps, strong);
    make_weights(options->gentle_band, n_gentle, gentle);
    for (int n = 1; n <= options->n_steps; n++)
        filter.steps[n] = (struct step){ n, n % 2 ? job->before : job->now, n % 2 ? job->now : job->before, (float)strong[n],
                                         n <= n_gentle ? (float)gentle[n] : 0 };
    if (job->n == 0 || (job->n_threads == 1 && take_all_by_slices(&filter)))
        return;
    for (int n = 1; n <= options->n_steps; n++) {
        filter.step = &filter.steps[n];
        parallel_run(job->n_threads, take_part, &filter);
    }
}

/* ---- back to the edges --------------------------------------------------------------------------------------------------- */

static float4 turn(float4 v) /* y, z, x */
{
    return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}

static float dot(float4 a, float4 b)
{
    float4 product = a * b;
    return product[0] + product[1] + product[2];
}

/* Across the two lines through a vertex, from where their ends are; of no length in particular, outward times the vertex' outward. */
static float4 normal_of(const float4 ends[4])
{
    float4 u = ends[3] - ends[0], w = ends[2] - ends[1];
    return turn(u * turn(w) - turn(u) * w);
}

/* Where the edge meets the plane through the displaced vertex. An edge nearly within that plane meets it anywhere: there the vertex'
 * own way along the edge counts. */
static float shift_along_edge(float4 normal, float4 displacement, int axis)
{
    float along = normal[axis], flat = 0.01f * dot(normal, normal);
    if (!(flat > 0))
        return displacement[axis];
    return (along * dot(normal, displacement) + flat * displacement[axis]) / (along * along + flat);
}

/* How far the strong filter is to be trusted at each vertex, 0 to 1. */
static void judge(void *context, int part, int n_parts)
{
    struct smooth_job *job = context;
    size_t v, end;
    for (smooth_range(job, part, n_parts, &v, &end); v < end; v++) {
        const struct marching_point *points = job->graph->points;
        const uint32_t *link = job->graph->links[v];
        float4 ends[4];
        for (int i = 0; i < 4; i++)
            ends[i] = smooth_start(&points[link[i]]) + job->gentle[link[i]];
        float shift = fabsf(shift_along_edge(normal_of(ends), job->strong[v], points[v].axis));
        float trust = (distrusted_shift - shift) / (distrusted_shift - trusted_shift);
        job->trust[v] = trust < 0 ? 0 : trust > 1 ? 1 : trust;
    }
}

/* Whoever has a neighbour that distrusts it does so too. */
static void be_cautious(void *context, int part, int n_parts)
{
    struct smooth_job *job = context;
    const float *trust = job->trust;
    size_t v, end;
    for (smooth_range(job, part, n_parts, &v, &end); v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        float least = trust[v];
        for (int i = 0; i < 4; i++)
            least = trust[link[i]] < least ? trust[link[i]] : least;
        job->next_trust[v] = least;
    }
}

/* So that no step of trust becomes a step of the surface. */
static void even_out(void *context, int part, int n_parts)
{
    struct smooth_job *job = context;
    const float *trust = job->trust;
    size_t v, end;
    for (smooth_range(job, part, n_parts, &v, &end); v < end; v++) {
        const uint32_t *link = job->graph->links[v];
        job->next_trust[v] = (2 * trust[v] + trust[link[0]] + trust[link[1]] + trust[link[2]] + trust[link[3]]) * (1 / 6.0f);
    }
}

static float4 displacement_of(const struct smooth_job *job, size_t v)
{
    float trust = job->trust[v];
    return trust * job->strong[v] + (1 - trust) * job->gentle[v];
}

/* A normal of unit length in patient space; 0 when it has no direction. */
static float4 in_lps(const struct smooth_job *job, float4 normal)
{
    float4 lps = normal[0] * job->lps_of_normal[0] + normal[1] * job->lps_of_normal[1] + normal[2] * job->lps_of_normal[2];
    float square = dot(lps, lps);
    return square > 0 ? lps / sqrtf(square) : lps;
}

/* What light falls on: the strongly filtered surface, as if nothing held it back, but the less the more it turns away from the one that
 * is there. */
static void write_normal(struct smooth_job *job, size_t v, float4 own, float4 strong)
{
    float agreement = dot(own, strong), share = (agreement - disagreeing) / (agreeing - disagreeing);
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    float4 shown = share * strong + (1 - share) * own;
    float square = dot(shown, shown);
    if (!(square > 0)) { /* no direction: the edge's own */
        shown = job->lps_of_normal[job->graph->points[v].axis] * (float)job->graph->points[v].outward;
        square = dot(shown, shown);
    }
    shown /= sqrtf(square);
    memcpy(job->mesh->normals + 3 * v, &shown, 3 * sizeof(float));
}

static void settle(void *context, int part, int n_parts)
{
    struct smooth_job *job = context;
    size_t v, end;
    for (smooth_range(job, part, n_parts, &v, &end); v < end; v++) {
        const struct marching_point *points = job->graph->points;
        const uint32_t *link = job->graph->links[v];
        int axis = points[v].axis;
        float4 ends[4];
        for (int i = 0; i < 4; i++)
            ends[i] = smooth_start(&points[link[i]]) + displacement_of(job, link[i]);
        float4 normal = normal_of(ends) * (float)points[v].outward;
        job->shift[v] = shift_along_edge(normal, displacement_of(job, v), axis);
        if (job->mesh->normals) {
            for (int i = 0; i < 4; i++)
                ends[i] = smooth_start(&points[link[i]]) + job->strong[link[i]];
            write_normal(job, v, in_lps(job, normal), in_lps(job, normal_of(ends) * (float)points[v].outward));
        }
        normal /= job->edge_mm; /* of the grid's coordinates to of mm */
        float square = dot(normal, normal);
        job->lean[v] = square > 0 ? fabsf(normal[axis]) / sqrtf(square) : 1;
    }
}

static void go_to_edges(struct smooth_job *job)
{
    job->trust = (float *)job->now; /* the steps are over */
    job->next_trust = (float *)job->before;
    parallel_run(job->n_threads, judge, job);
    for (int round = 0; round < CAUTIOUS_ROUNDS + EVEN_ROUNDS; round++) {
        parallel_run(job->n_threads, round < CAUTIOUS_ROUNDS ? be_cautious : even_out, job);
        float *written = job->next_trust;
        job->next_trust = job->trust;
        job->trust = written;
    }
    parallel_run(job->n_threads, settle, job);
}

/* ---- the whole ----------------------------------------------------------------------------------------------------------- */

static void write_positions(void *context, int part, int n_parts)
{
    struct smooth_job *job = context;
    const struct affine *map = &job->graph->lps_mm_from_at;
    float most = (float)job->options.max_shift;
    size_t v, end;
    for (smooth_range(job, part, n_parts, &v, &end); v < end; v++) {
        const struct marching_point *point = &job->graph->points[v];
        double at[3] = { point->at2[0] * 0.5, point->at2[1] * 0.5, point->at2[2] * 0.5 };
        at[point->axis] += (double)smooth_cut(job->shift[v], most);
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
    float4 *vectors = mem_large_array(job->n, N_VECTORS * sizeof(float4) + N_FLOATS * sizeof(float), UINT64_MAX, err);
    if (!vectors)
        return false;
    job->first = vectors;
    job->now = vectors + job->n;
    job->before = vectors + 2 * job->n;
    job->strong = vectors + 3 * job->n;
    job->gentle = vectors + 4 * job->n;
    job->shift = (float *)(vectors + N_VECTORS * job->n);
    job->lean = job->shift + job->n;
    filter(job);
    go_to_edges(job);
    bool is_good = job->options.n_volume_steps == 0 || smooth_keep_volume(job, err);
    parallel_run(job->n_threads, write_positions, job);
    mesh_measure_bounds(job->mesh);
    free(vectors);
    return is_good;
}

/* A normal is square to what lies in the surface, so it is mapped by the grid's reciprocal axes: each square to the two others. */
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
    size_t worth = n_vertices / VERTICES_A_THREAD + 1; /* fewer vertices are done before a thread has started */
    n = n < worth ? n : worth;
    return n < MAX_THREADS ? (int)n : MAX_THREADS;
}

struct mesh *smooth_with(const struct smooth_options *smoothing, const struct mask *mask, const struct surface_options *options,
                         struct error *err)
{
    assert(smoothing->n_steps >= 1 && smoothing->n_steps <= SMOOTH_MAX_STEPS && smoothing->max_shift < 0.5);
    struct marching_graph graph = { 0 };
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
        .edge_mm = { (float)vec3_length(map->columns[0]), (float)vec3_length(map->columns[1]), (float)vec3_length(map->columns[2]), 1 },
        .is_mirrored = affine_determinant(map) < 0,
        .has_normals = !options->without_normals,
        .univel_mm3 = fabs(affine_determinant(map)),
    };
    reciprocals_of(map, job.lps_of_normal);
    if (!options->close_at_border)
        job.options.n_volume_steps = 0; /* what is open encloses nothing */
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
