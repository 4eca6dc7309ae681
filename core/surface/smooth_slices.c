/* Shape-based interpolation between slices: where the smoothing starts if the slices are far apart.
 *
 * Between two slices, the surface of a mask is a terrace: the pixels that are inside in one of the two. Shape-based
 * interpolation gives each of them the height at which the signed distances to the contours of the two slices,
 * interpolated, are 0 (S. P. Raya, J. K. Udupa, Shape-based interpolation of multidimensional objects, IEEE Trans. Med.
 * Imaging 9(1), 1990). Marching cubes has one vertex on the edge that crosses the terrace at each pixel. So this vertex
 * moves along its edge, and no slice has to be inserted: the triangles are as many as before.
 *
 *   1. vector distances from each vertex of a terrace to the contour of the slice below and to that of the slice above,
 *      along the links between vertices (P.-E. Danielsson, Euclidean distance mapping, CGIP 14, 1980). So only pixels
 *      of terraces are visited
 *   2. the height is a cubic of the distances. Its slope at a contour follows from the widths of the terraces on both
 *      sides, as the central difference of the contour's place over the slices
 *   3. a cap, a terrace that has a contour on one side only, is extrapolated: it is the solution u of the Poisson
 *      equation with 0 at the contour, scaled so that its slope at the contour follows that of the terrace beyond. This
 *      is exact for a paraboloid with elliptical contours. A cap that would reach the next slice is flattened
 *
 * A slab is the space between two slices. Terraces of different slabs have no link. On sheared grids, distances are
 * measured as if the axes were perpendicular. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/smooth_job.h"

#define NOWHERE UINT32_MAX

/* Heights in slices: that of a cap of unknown height, and the greatest one. */
static const float flat_height = 0.5f, most_height = 0.9f;

/* Height in slices, as a disc, from which only the rim of a cap is not flat: the shape of a disc is good enough there.
 */
static const float steep_height = 3;

enum { MAX_ROUNDS = 60 };

/* A contour without a terrace beyond it is a wall, as if its terrace was this wide, in pixels. */
static const double wall_width = 0.5;

struct cap {
    double flux;      /* slope of the terrace beyond, 1/mm, integrated along the contour */
    double area_mm2;  /* up to the middle of that terrace */
    size_t from, end; /* its vertices in the queue */
};

/* Nearest contours of a vertex of a terrace. */
struct reach {
    uint32_t contour[2]; /* nearest vertex of the contour of the slice below and of that above, or NOWHERE */
    float mm2[2];        /* square of its distance */
};

/* A vertex that has no contour on both sides, and those beside it on its terrace, or NOWHERE. */
struct inner {
    uint32_t vertex, previous, next; /* in its line of the scan */
    uint32_t line_before, line_after;
};

struct terraces {
    const struct smooth_job *job;
    int axis, across[2]; /* of the slices; in the plane */
    float half_mm2[2];   /* squares of half a pixel's edges */
    double pixel_mm2;
    int32_t n_slabs;
    /* scratch; a slab's part of the lists begins at its first vertex */
    uint32_t *list, *queue; /* vertices of the terraces; of the caps */
    size_t *n_listed;       /* [n_slabs] */
    struct reach *reach;    /* [n_vertices] */
    struct inner *inner;
    float *u;         /* [n_vertices] of caps, mm2 */
    uint32_t *cap_of; /* [n_vertices] 1 + number of the cap, or 0 */
    struct cap *caps;
};

static inline int level2(const struct terraces *terraces, size_t v)
{
    return terraces->job->graph->points[v].at2[terraces->axis];
}

static inline bool is_on_terrace(const struct terraces *terraces, size_t v)
{
    return terraces->job->graph->points[v].axis == terraces->axis;
}

/* First vertex of a slab. Only across z, slabs are separate in the list of vertices; else there is one slab. */
static size_t slab_begin(const struct terraces *terraces, int32_t slab)
{
    return terraces->n_slabs > 1 ? terraces->job->begin[slab] : slab ? terraces->job->n : 0;
}

/* ---- distances -------------------------------------------------------------------------------------------------- */

static inline float square_between(const struct terraces *terraces, uint32_t a, uint32_t b)
{
    const struct marching_point *points = terraces->job->graph->points;
    float x = (float)(points[a].at2[terraces->across[0]] - points[b].at2[terraces->across[0]]);
    float y = (float)(points[a].at2[terraces->across[1]] - points[b].at2[terraces->across[1]]);
    return x * x * terraces->half_mm2[0] + y * y * terraces->half_mm2[1];
}

static inline void take_nearer(const struct terraces *terraces, uint32_t v, int side, uint32_t contour)
{
    float square = square_between(terraces, v, contour);
    if (square < terraces->reach[v].mm2[side]) {
        terraces->reach[v].mm2[side] = square;
        terraces->reach[v].contour[side] = contour;
    }
}

static inline void take_from(const struct terraces *terraces, uint32_t v, uint32_t other)
{
    if (other == NOWHERE)
        return;
    for (int side = 0; side < 2; side++) {
        uint32_t contour = terraces->reach[other].contour[side];
        if (contour != NOWHERE && contour != terraces->reach[v].contour[side])
            take_nearer(terraces, v, side, contour);
    }
}

static inline struct inner inner_of(const struct terraces *terraces, uint32_t v)
{
    const struct marching_point *points = terraces->job->graph->points;
    struct inner inner = { v, NOWHERE, NOWHERE, NOWHERE, NOWHERE };
    for (int i = 0; i < 4; i++) {
        uint32_t other = terraces->job->graph->links[v][i];
        if (!is_on_terrace(terraces, other) || other == v)
            continue;
        bool is_after = other > v;
        if (points[other].at2[terraces->across[1]] == points[v].at2[terraces->across[1]])
            *(is_after ? &inner.next : &inner.previous) = other;
        else
            *(is_after ? &inner.line_after : &inner.line_before) = other;
    }
    return inner;
}

/* Lists the vertices of terraces, each with the contours beside it. Returns the number of inner ones. */
static size_t list_slab(const struct terraces *terraces, int32_t slab)
{
    size_t from = slab_begin(terraces, slab), end = slab_begin(terraces, slab + 1), n = from, n_inner = 0;
    for (size_t v = from; v < end; v++) {
        terraces->job->start[v] = 0;
        if (!is_on_terrace(terraces, v))
            continue;
        struct reach *reach = &terraces->reach[v];
        *reach = (struct reach){ { NOWHERE, NOWHERE }, { INFINITY, INFINITY } };
        terraces->cap_of[v] = 0;
        terraces->list[n++] = (uint32_t)v;
        for (int i = 0; i < 4; i++) {
            uint32_t other = terraces->job->graph->links[v][i];
            if (!is_on_terrace(terraces, other))
                take_nearer(terraces, (uint32_t)v, level2(terraces, other) > level2(terraces, v), other);
        }
        if (reach->contour[0] == NOWHERE || reach->contour[1] == NOWHERE)
            terraces->inner[from + n_inner++] = inner_of(terraces, (uint32_t)v);
    }
    terraces->n_listed[slab] = n - from;
    return n_inner;
}

static inline int line_of(const struct terraces *terraces, const struct inner *inner)
{
    return terraces->job->graph->points[inner->vertex].at2[terraces->across[1]];
}

/* Finds contours that the scan of the lines missed, because the way to them along the terrace turns often, as in a
 * spiral: from vertex to vertex, each once. */
static void spread_round_corners(const struct terraces *terraces, int32_t slab, size_t n_inner, int side)
{
    size_t from = slab_begin(terraces, slab), end = 0;
    uint32_t *queue = terraces->queue + from;
    for (size_t at = 0; at < n_inner; at++) {
        const struct inner *inner = &terraces->inner[from + at];
        if (terraces->reach[inner->vertex].contour[side] != NOWHERE)
            continue;
        const uint32_t beside[4] = { inner->previous, inner->next, inner->line_before, inner->line_after };
        for (int i = 0; i < 4; i++)
            if (beside[i] != NOWHERE && terraces->reach[beside[i]].contour[side] != NOWHERE)
                take_nearer(terraces, inner->vertex, side, terraces->reach[beside[i]].contour[side]);
        if (terraces->reach[inner->vertex].contour[side] != NOWHERE)
            queue[end++] = inner->vertex;
    }
    for (size_t at = 0; at < end; at++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = terraces->job->graph->links[queue[at]][i];
            if (!is_on_terrace(terraces, other) || terraces->reach[other].contour[side] != NOWHERE)
                continue;
            take_nearer(terraces, other, side, terraces->reach[queue[at]].contour[side]);
            queue[end++] = other;
        }
}

/* Distances spread line by line, and in both directions along each line. */
static void measure_slab(const struct terraces *terraces, int32_t slab)
{
    size_t n = list_slab(terraces, slab);
    const struct inner *inner = terraces->inner + slab_begin(terraces, slab);
    for (size_t from = 0, end; from < n; from = end) {
        int line = line_of(terraces, &inner[from]);
        for (end = from; end < n && line_of(terraces, &inner[end]) == line; end++) {
            take_from(terraces, inner[end].vertex, inner[end].line_before);
            take_from(terraces, inner[end].vertex, inner[end].previous);
        }
        for (size_t at = end; at-- > from;)
            take_from(terraces, inner[at].vertex, inner[at].next);
    }
    for (size_t end = n, from; end > 0; end = from) {
        int line = line_of(terraces, &inner[end - 1]);
        for (from = end; from > 0 && line_of(terraces, &inner[from - 1]) == line; from--) {
            take_from(terraces, inner[from - 1].vertex, inner[from - 1].line_after);
            take_from(terraces, inner[from - 1].vertex, inner[from - 1].next);
        }
        for (size_t at = from; at < end; at++)
            take_from(terraces, inner[at].vertex, inner[at].previous);
    }
    for (int side = 0; side < 2; side++)
        spread_round_corners(terraces, slab, n, side);
}

/* The vertex of a terrace in the slab below (side 0) or above a vertex of a contour; NOWHERE if a wall leads there. */
static uint32_t terrace_at(const struct terraces *terraces, uint32_t contour, int side)
{
    for (int i = 0; i < 4; i++) {
        uint32_t other = terraces->job->graph->links[contour][i];
        if (is_on_terrace(terraces, other) && (level2(terraces, other) > level2(terraces, contour)) == side)
            return other;
    }
    return NOWHERE;
}

/* Width of a terrace at a vertex, mm; INFINITY of a cap. */
static inline float width_at(const struct terraces *terraces, uint32_t v)
{
    return sqrtf(terraces->reach[v].mm2[0]) + sqrtf(terraces->reach[v].mm2[1]);
}

/* Slope at a contour of a terrace that is `width` wide, relative to its mean slope: the contour's place changes from
 * slice to slice by the mean of this width and that of the terrace on the other side. 0: not known */
static float slope_at(const struct terraces *terraces, uint32_t v, int side, float width)
{
    uint32_t other = terrace_at(terraces, terraces->reach[v].contour[side], side);
    const struct marching_point *points = terraces->job->graph->points;
    if (other == NOWHERE)
        return 2 * width / (width + sqrtf(fminf(terraces->half_mm2[0], terraces->half_mm2[1])));
    float beyond = width_at(terraces, other);
    if (!isfinite(beyond) || points[other].outward != points[v].outward)
        return 0;
    return 2 * width / (width + beyond);
}

/* Heights of a terrace with two contours: a cubic from one to the other. */
static void interpolate_slab(const struct terraces *terraces, int32_t slab)
{
    const uint32_t *list = terraces->list + slab_begin(terraces, slab);
    float narrow = 2.1f * sqrtf(fmaxf(terraces->half_mm2[0], terraces->half_mm2[1])); /* one pixel */
    for (size_t at = 0; at < terraces->n_listed[slab]; at++) {
        uint32_t v = list[at];
        float width = width_at(terraces, v), x = sqrtf(terraces->reach[v].mm2[0]) / width;
        if (!isfinite(width))
            continue;
        float height = x;
        if (width > narrow) {
            float below = slope_at(terraces, v, 0, width), above = slope_at(terraces, v, 1, width), y = 1 - x;
            if (!(below > 0))
                below = above > 0 ? 2 - above : 1;
            if (!(above > 0))
                above = 2 - below;
            height = x * x * (3 - 2 * x) + x * y * (below * y - above * x);
        }
        terraces->job->start[v] = smooth_cut(height - 0.5f, terraces->job->most[terraces->axis]);
    }
}

/* ---- caps ------------------------------------------------------------------------------------------------------- */

/* The side on which a cap has its contour: 0 below, 1 above. */
static inline int cap_side(const struct terraces *terraces, uint32_t v)
{
    return terraces->reach[v].contour[0] == NOWHERE;
}

static inline bool is_cap(const struct terraces *terraces, uint32_t v)
{
    return (terraces->reach[v].contour[0] == NOWHERE) != (terraces->reach[v].contour[1] == NOWHERE);
}

/* Lists the linked vertices of a cap in the queue from `from` on; returns the end. */
static size_t collect_cap(const struct terraces *terraces, uint32_t first, uint32_t number, size_t from)
{
    size_t end = from;
    terraces->queue[end++] = first;
    terraces->cap_of[first] = number;
    for (size_t at = from; at < end; at++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = terraces->job->graph->links[terraces->queue[at]][i];
            if (is_on_terrace(terraces, other) && !terraces->cap_of[other]) {
                terraces->cap_of[other] = number;
                terraces->queue[end++] = other;
            }
        }
    return end;
}

/* Adds what the terraces of a slab say about the slopes at the contours of caps, which have their contour on `side`. */
static void add_slopes(const struct terraces *terraces, int32_t slab, int side, struct cap *caps)
{
    const uint32_t *list = terraces->list + slab_begin(terraces, slab);
    for (size_t at = 0; at < terraces->n_listed[slab]; at++) {
        uint32_t v = list[at], contour = terraces->reach[v].contour[1 - side];
        if (contour == NOWHERE || terraces->reach[v].contour[side] == NOWHERE)
            continue;
        uint32_t cap = terrace_at(terraces, contour, 1 - side);
        if (cap == NOWHERE || !terraces->cap_of[cap])
            continue;
        struct cap *to = &caps[terraces->cap_of[cap] - 1];
        float near = sqrtf(terraces->reach[v].mm2[1 - side]), far = sqrtf(terraces->reach[v].mm2[side]);
        double width = (double)near + (double)far;
        to->flux += terraces->pixel_mm2 / (width * width);
        if (near < far)
            to->area_mm2 += terraces->pixel_mm2;
    }
}

/* Adds the walls at a cap's contour to its flux; returns the greatest distance from the contour. */
static float add_walls(const struct terraces *terraces, struct cap *cap)
{
    const struct marching_point *points = terraces->job->graph->points;
    int side = cap_side(terraces, terraces->queue[cap->from]);
    float most_mm2 = 0;
    for (size_t at = cap->from; at < cap->end; at++) {
        uint32_t v = terraces->queue[at];
        most_mm2 = fmaxf(most_mm2, terraces->reach[v].mm2[side]);
        for (int i = 0; i < 4; i++) {
            uint32_t contour = terraces->job->graph->links[v][i];
            if (is_on_terrace(terraces, contour))
                continue;
            uint32_t beyond = terrace_at(terraces, contour, side);
            if (beyond != NOWHERE && terraces->reach[beyond].contour[side] != NOWHERE)
                continue;
            int across = points[contour].axis == terraces->across[1]; /* the contour is a pixel's other edge */
            cap->flux += sqrt((double)(terraces->half_mm2[!across] / terraces->half_mm2[across])) / wall_width;
        }
    }
    return sqrtf(most_mm2);
}

/* u of a disc, by the distance from the contour. */
static void fill_as_disc(const struct terraces *terraces, const struct cap *cap, float depth_mm)
{
    int side = cap_side(terraces, terraces->queue[cap->from]);
    for (size_t at = cap->from; at < cap->end; at++) {
        uint32_t v = terraces->queue[at];
        float mm = sqrtf(terraces->reach[v].mm2[side]);
        terraces->u[v] = mm * (2 * depth_mm - mm) / 4;
    }
}

/* Solves the Poisson equation, u'' = -1, by successive over-relaxation from what it is for a disc. The contour is half
 * a pixel away from the pixels beside it. Returns the greatest u. */
static float solve_cap(const struct terraces *terraces, const struct cap *cap, float depth_mm)
{
    const struct marching_point *points = terraces->job->graph->points;
    float weight[2] = { 0.25f / terraces->half_mm2[0], 0.25f / terraces->half_mm2[1] };
    float pixels = 2 * depth_mm / sqrtf(4 * fminf(terraces->half_mm2[0], terraces->half_mm2[1]));
    float over = 2 / (1 + sinf((float)MATH_PI / (pixels + 2)));
    int n_rounds = (int)fminf(pixels + 4, MAX_ROUNDS);
    float most = 0;
    for (int round = 0; round < n_rounds; round++)
        for (size_t step = cap->from; step < cap->end; step++) {
            size_t at = round % 2 ? cap->end - 1 - (step - cap->from) : step;
            uint32_t v = terraces->queue[at];
            float sum = 1, weights = 0;
            for (int i = 0; i < 4; i++) {
                uint32_t other = terraces->job->graph->links[v][i];
                bool is_second = points[other].at2[terraces->across[0]] == points[v].at2[terraces->across[0]];
                if (is_on_terrace(terraces, other)) {
                    sum += weight[is_second] * terraces->u[other];
                    weights += weight[is_second];
                } else {
                    weights += 2 * weight[is_second];
                }
            }
            terraces->u[v] += over * (sum / weights - terraces->u[v]);
            if (round + 1 == n_rounds)
                most = fmaxf(most, terraces->u[v]);
        }
    return most;
}

/* Is the cap where the scan ends? */
static bool is_at_border(const struct terraces *terraces, const struct cap *cap)
{
    uint32_t v = terraces->queue[cap->from];
    int beyond = terraces->job->graph->start[terraces->axis] + level2(terraces, v) / 2 + !cap_side(terraces, v);
    return beyond < 0 || beyond >= (int)terraces->job->mask_size[terraces->axis];
}

static void raise_cap(const struct terraces *terraces, struct cap *cap)
{
    int side = cap_side(terraces, terraces->queue[cap->from]);
    float depth_mm = add_walls(terraces, cap), slope = (float)(cap->flux / cap->area_mm2);
    if (!(slope > 0))
        return;
    float most = depth_mm * depth_mm / 4;
    fill_as_disc(terraces, cap, depth_mm);
    if (slope * most < steep_height)
        most = solve_cap(terraces, cap, depth_mm);
    float height = slope * most; /* of the paraboloid, in slices */
    /* above most_height, the cap is flatter at the same slope at its contour, and its height gets less certain */
    float shown = height;
    if (height > most_height)
        shown = fmaxf(flat_height, most_height - 0.2f * (height - most_height));
    bool is_cut = is_at_border(terraces, cap);
    for (size_t at = cap->from; at < cap->end; at++) {
        uint32_t v = terraces->queue[at];
        float share = fmaxf(terraces->u[v] / most, 0), up = height * share;
        if (is_cut) /* the region may go on: it is cut off where the scan ends */
            up = fminf(up, flat_height);
        else if (height > most_height)
            up = shown * (1 - powf(fmaxf(1 - share, 0), height / shown));
        terraces->job->start[v] = smooth_cut(side ? 0.5f - up : up - 0.5f, terraces->job->most[terraces->axis]);
    }
}

static void extrapolate_slab(const struct terraces *terraces, int32_t slab)
{
    size_t from = slab_begin(terraces, slab), queued = from;
    struct cap *caps = terraces->caps + from;
    uint32_t n_caps = 0;
    for (size_t at = 0; at < terraces->n_listed[slab]; at++) {
        uint32_t v = terraces->list[from + at];
        if (terraces->cap_of[v] || !is_cap(terraces, v))
            continue;
        struct cap *cap = &caps[n_caps++];
        *cap = (struct cap){ .from = queued, .end = collect_cap(terraces, v, n_caps, queued) };
        cap->area_mm2 = (double)(cap->end - queued) * terraces->pixel_mm2;
        queued = cap->end;
    }
    if (n_caps == 0)
        return;
    for (int side = 0; side < 2; side++) {
        int32_t other = terraces->n_slabs > 1 ? slab + (side ? 1 : -1) : slab;
        if (other >= 0 && other < terraces->n_slabs)
            add_slopes(terraces, other, side, caps);
    }
    for (struct cap *cap = caps; cap < caps + n_caps; cap++)
        raise_cap(terraces, cap);
}

/* ---- smooth_interpolate_slices ---------------------------------------------------------------------------------- */

static void measure_part(void *context, int part, int n_parts)
{
    const struct terraces *terraces = context;
    for (int32_t slab = part; slab < terraces->n_slabs; slab += n_parts) {
        measure_slab(terraces, slab);
    }
}

static void extrapolate_part(void *context, int part, int n_parts)
{
    const struct terraces *terraces = context;
    for (int32_t slab = part; slab < terraces->n_slabs; slab += n_parts) {
        interpolate_slab(terraces, slab);
        extrapolate_slab(terraces, slab);
    }
}

int smooth_slice_axis(const float edge_mm[3], double ratio)
{
    int axis = edge_mm[0] > edge_mm[1] ? 0 : 1;
    axis = edge_mm[2] >= edge_mm[axis] ? 2 : axis;
    for (int other = 0; other < 3; other++)
        if (other != axis && !((double)edge_mm[axis] > ratio * (double)edge_mm[other]))
            return -1;
    return axis;
}

bool smooth_interpolate_slices(struct smooth_job *job, struct error *err)
{
    int axis = job->slice_axis, across[2] = { axis == 0, axis == 2 ? 1 : 2 };
    float half_mm[2] = { job->edge_mm[across[0]] / 2, job->edge_mm[across[1]] / 2 };
    struct terraces terraces = {
        .job = job,
        .axis = axis,
        .across = { across[0], across[1] },
        .half_mm2 = { half_mm[0] * half_mm[0], half_mm[1] * half_mm[1] },
        .pixel_mm2 = 4 * (double)(half_mm[0] * half_mm[1]),
        .n_slabs = axis == 2 ? job->n_slices : 1,
        .list = (uint32_t *)job->first,
        .queue = (uint32_t *)job->first + job->n,
        .cap_of = (uint32_t *)job->first + 2 * job->n,
        .u = (float *)job->first + 3 * job->n,
        .caps = (struct cap *)job->now, /* and `before` */
        .reach = (struct reach *)job->strong,
        .inner = (struct inner *)job->now, /* and `before`, before there are caps */
    };
    static_assert(sizeof(struct reach) <= sizeof(float4) && sizeof(struct inner) <= 2 * sizeof(float4), "scratch");
    static_assert(sizeof(struct cap) <= 2 * sizeof(float4), "caps are as many as vertices in the worst case");
    if (terraces.n_slabs < 1)
        return true;
    terraces.n_listed = mem_array((size_t)terraces.n_slabs, sizeof *terraces.n_listed, UINT64_MAX, err);
    if (!terraces.n_listed)
        return false;
    int n_parts = job->n_threads < terraces.n_slabs ? job->n_threads : terraces.n_slabs;
    parallel_run(n_parts, measure_part, &terraces);
    parallel_run(n_parts, extrapolate_part, &terraces);
    free(terraces.n_listed);
    return true;
}
