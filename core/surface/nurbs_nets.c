/* Samples outlines into rows of control points, by traces or by degree bins. */
#include "core/surface/nurbs_nets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/outline.h"
#include "core/surface/nurbs_pieces.h"

enum { MIN_AROUND = 8 };
#define MAX_CONTROL_POINTS ((uint64_t)1 << 26)

struct net_job {
    const struct mask *mask;
    struct outline_set *set;
    int axis;
    struct vec3 across; /* half the vector from slice to slice, mm */
    size_t bins;
    struct vec3 *line; /* [longest] scratch: the points of one outline, mm */
    double *along;     /* [longest + 1] and the length of the outline up to each point */
};

static size_t line_length(const struct net_job *job, uint32_t line)
{
    return job->set->line[line + 1] - job->set->line[line];
}

static size_t load_line(const struct net_job *job, uint32_t line)
{
    const uint32_t *walk = job->set->walk + job->set->line[line];
    size_t n = line_length(job, line);
    for (size_t at = 0; at < n; at++) {
        const float *p = job->set->points_ijk + 3 * (size_t)walk[at];
        job->line[at] = affine_point(&job->mask->lps_mm_from_ijk, vec3((double)p[0], (double)p[1], (double)p[2]));
    }
    return n;
}

/* ---- traces ----------------------------------------------------------------------------------------------------- */

/* Samples n points, evenly spaced, along a line. */
static void sample_line(const struct net_job *job, uint32_t line, size_t n, struct vec3 *out)
{
    size_t n_line = load_line(job, line), at = 0;
    job->along[0] = 0;
    for (size_t p = 0; p < n_line; p++)
        job->along[p + 1] = job->along[p] + vec3_length(vec3_sub(job->line[(p + 1) % n_line], job->line[p]));
    for (size_t s = 0; s < n; s++) {
        double want = job->along[n_line] * (double)s / (double)n;
        while (at + 1 < n_line && job->along[at + 1] <= want)
            at++;
        double part = (want - job->along[at]) / (job->along[at + 1] - job->along[at]);
        struct vec3 from = job->line[at], to = job->line[(at + 1) % n_line];
        out[s] = vec3_add(from, vec3_scale(vec3_sub(to, from), part));
    }
}

/* Rotates the row to start where it is closest to the row below: of all n rotations, the one with the least sum of
 * squared distances. */
static void align(const struct vec3 *below, struct vec3 *row, size_t n, struct vec3 *scratch)
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t shift = 0; shift < n; shift++) {
        double sum = 0;
        for (size_t at = 0; at < n && sum < least; at++) {
            struct vec3 d = vec3_sub(row[(at + shift) % n], below[at]);
            sum += vec3_dot(d, d);
        }
        if (sum < least) {
            least = sum;
            best = shift;
        }
    }
    memcpy(scratch, row, n * sizeof *row);
    for (size_t at = 0; at < n; at++)
        row[at] = scratch[(at + best) % n];
}

/* Repeats the first and last row half a slice further out. */
static void put_ends(const struct net_job *job, const struct nurbs_net *net)
{
    size_t n = net->n_around, last = (net->n_rows - 1) * n;
    for (size_t at = 0; at < n; at++) {
        net->points[at] = vec3_sub(net->points[n + at], job->across);
        net->points[last + at] = vec3_add(net->points[last - n + at], job->across);
    }
}

static void fill_by_traces(const struct net_job *job, uint32_t line, const uint32_t *next, const struct nurbs_net *net)
{
    struct vec3 scratch[NURBS_MAX_BINS];
    struct vec3 *row = net->points + net->n_around;
    for (size_t at = 0; line != UINT32_MAX; at++, row += net->n_around, line = next[line]) {
        sample_line(job, line, net->n_around, row);
        if (at > 0)
            align(row - net->n_around, row, net->n_around, scratch);
    }
    put_ends(job, net);
}

/* Rows and points around of the net that begins with a line. */
static struct nurbs_net net_size(const struct net_job *job, uint32_t line, const uint32_t *next)
{
    struct nurbs_net net = { .n_rows = 2, .n_around = MIN_AROUND };
    for (; line != UINT32_MAX; line = next[line], net.n_rows++)
        if (line_length(job, line) > net.n_around)
            net.n_around = line_length(job, line);
    if (net.n_around > job->bins)
        net.n_around = job->bins;
    return net;
}

static bool allot(struct nurbs_nets *nets, size_t n_nets, uint64_t n_points, struct error *err)
{
    if (n_points > MAX_CONTROL_POINTS)
        return error_set(err, ERROR_LIMIT, "splines with %llu control points: at most %llu are allowed",
                         (unsigned long long)n_points, (unsigned long long)MAX_CONTROL_POINTS);
    nets->nets = mem_array(n_nets, sizeof *nets->nets, UINT64_MAX, err);
    nets->store = nets->nets ? mem_array((size_t)n_points, sizeof *nets->store, UINT64_MAX, err) : NULL;
    return nets->store != NULL;
}

static bool make_by_traces(const struct net_job *job, struct nurbs_nets *nets, struct error *err)
{
    const struct outline_set *set = job->set;
    uint32_t *next = nurbs_pieces_link(set, job->axis, err);
    /* [n_lines] the line continues one from the slice below */
    bool *goes_on = next ? mem_array(set->n_lines, sizeof *goes_on, UINT64_MAX, err) : NULL;
    bool good = goes_on != NULL;
    uint64_t n_points = 0;
    size_t n_nets = 0;
    for (uint32_t line = 0; good && line < set->n_lines; line++)
        if (next[line] != UINT32_MAX)
            goes_on[next[line]] = true;
    for (uint32_t line = 0; good && line < set->n_lines; line++)
        if (!goes_on[line]) {
            struct nurbs_net net = net_size(job, line, next);
            n_points += net.n_rows * net.n_around;
            n_nets++;
        }
    good = good && allot(nets, n_nets, n_points, err);
    struct vec3 *store = nets->store;
    for (uint32_t line = 0; good && line < set->n_lines; line++)
        if (!goes_on[line]) {
            struct nurbs_net *net = &nets->nets[nets->n_nets++];
            *net = net_size(job, line, next);
            net->points = store;
            store += net->n_rows * net->n_around;
            fill_by_traces(job, line, next, net);
        }
    free(next);
    free(goes_on);
    return good;
}

/* ---- degree bins ------------------------------------------------------------------------------------------------ */

/* The position of a slice along S, mm, for the error sentence. */
static double slice_s_mm(const struct net_job *job, uint32_t slice)
{
    struct vec3 middle =
        vec3((job->mask->size[0] - 1) / 2.0, (job->mask->size[1] - 1) / 2.0, (job->mask->size[2] - 1) / 2.0);
    double *axis[3] = { &middle.x, &middle.y, &middle.z };
    *axis[job->axis] = slice;
    return affine_point(&job->mask->lps_mm_from_ijk, middle).z;
}

static bool refuse(const struct net_job *job, uint32_t slice, struct error *err, const char *why)
{
    return error_set(err, ERROR_UNSUPPORTED,
                     "degree bins cannot show this region: slice %u (S %.1f mm) %s; sample the traces instead", slice,
                     slice_s_mm(job, slice), why);
}

/* Finds the only outline of a slice; refuses the region if the slice has no outline, a hole or a second piece. */
static bool one_line(const struct net_job *job, uint32_t slice, uint32_t *line, struct error *err)
{
    const struct outline_set *set = job->set;
    uint32_t n_pieces = 0, n_holes = 0;
    for (uint32_t l = set->slice[slice]; l < set->slice[slice + 1]; l++)
        *(nurbs_pieces_twice_area(set, l, job->axis) < 0 ? &n_holes : &n_pieces) += 1;
    *line = set->slice[slice];
    char why[64];
    if (n_pieces == 0)
        return refuse(job, slice, err, "has none of it, but slices on both sides have");
    snprintf(why, sizeof why, "has %u pieces of it", n_pieces);
    if (n_pieces > 1)
        return refuse(job, slice, err, why);
    snprintf(why, sizeof why, "has %u hole%s in it", n_holes, n_holes == 1 ? "" : "s");
    return n_holes == 0 || refuse(job, slice, err, why);
}

/* Axes within a slice: right and up are perpendicular, 1 mm long, and counter-clockwise like the outlines. */
struct plane {
    struct vec3 middle, right, up;
};

static struct plane plane_of(const struct net_job *job, size_t n_line)
{
    const struct vec3 *columns = job->mask->lps_mm_from_ijk.columns;
    struct vec3 u = columns[job->axis == 0 ? 1 : 0], v = columns[job->axis == 2 ? 1 : 2], normal = vec3_cross(u, v);
    struct plane plane = { job->line[0], vec3_normalize(u), vec3_normalize(vec3_cross(normal, u)) };
    struct vec3 sum = vec3(0, 0, 0);
    double twice = 0;
    for (size_t at = 0; at < n_line; at++) { /* fan of triangles from the first point */
        struct vec3 a = vec3_sub(job->line[at], job->line[0]), b = vec3_sub(job->line[(at + 1) % n_line], job->line[0]);
        double area = vec3_dot(vec3_cross(a, b), vec3_normalize(normal));
        sum = vec3_add(sum, vec3_scale(vec3_add(a, b), area / 3));
        twice += area;
    }
    plane.middle = vec3_add(job->line[0], vec3_scale(sum, 1 / twice));
    return plane;
}

/* Angle from one point to the next as seen from the middle, -pi .. pi. */
static double turn(const struct plane *plane, struct vec3 from, struct vec3 to)
{
    struct vec3 a = vec3_sub(from, plane->middle), b = vec3_sub(to, plane->middle);
    double ax = vec3_dot(a, plane->right), ay = vec3_dot(a, plane->up), bx = vec3_dot(b, plane->right),
           by = vec3_dot(b, plane->up);
    return atan2(ax * by - ay * bx, ax * bx + ay * by);
}

static bool is_star(const struct net_job *job, size_t n_line, const struct plane *plane, uint32_t slice,
                    struct error *err)
{
    double allowed = NURBS_MAX_BACK_DEG * MATH_PI / 180, angle = 0, farthest = 0, back = 0;
    allowed = allowed > 2 * MATH_PI / (double)job->bins ? allowed : 2 * MATH_PI / (double)job->bins;
    /* twice around, because the first point may be within a stretch that goes back */
    for (size_t at = 0; at < 2 * n_line; at++) {
        angle += turn(plane, job->line[at % n_line], job->line[(at + 1) % n_line]);
        farthest = angle > farthest ? angle : farthest;
        back = farthest - angle > back ? farthest - angle : back;
    }
    char why[96];
    if (!(fabs(angle - 4 * MATH_PI) < 0.1))
        return refuse(job, slice, err, "is so hollow that its middle lies outside it");
    snprintf(why, sizeof why, "is hollow: around the middle its outline goes back by %.0f degrees",
             back * 180 / MATH_PI);
    return back <= allowed || refuse(job, slice, err, why);
}

/* The outermost crossing of the outline with the ray from the middle at an angle. */
static struct vec3 crossing_at(const struct net_job *job, size_t n_line, const struct plane *plane, double angle)
{
    double c = cos(angle), s = sin(angle), farthest = 0;
    for (size_t at = 0; at < n_line; at++) {
        struct vec3 a = vec3_sub(job->line[at], plane->middle),
                    b = vec3_sub(job->line[(at + 1) % n_line], plane->middle);
        double ax = vec3_dot(a, plane->right), ay = vec3_dot(a, plane->up), bx = vec3_dot(b, plane->right),
               by = vec3_dot(b, plane->up);
        double off_a = c * ay - s * ax, off_b = c * by - s * bx; /* distances to the left of the ray */
        if ((off_a <= 0) == (off_b <= 0))
            continue;
        double part = off_a / (off_a - off_b), out = (1 - part) * (c * ax + s * ay) + part * (c * bx + s * by);
        farthest = out > farthest ? out : farthest;
    }
    return vec3_add(plane->middle,
                    vec3_add(vec3_scale(plane->right, farthest * c), vec3_scale(plane->up, farthest * s)));
}

static void fill_row_by_bins(const struct net_job *job, size_t n_line, const struct plane *plane, struct vec3 *row)
{
    double farthest[NURBS_MAX_BINS];
    for (size_t b = 0; b < job->bins; b++)
        farthest[b] = -1;
    for (size_t at = 0; at < n_line; at++) {
        struct vec3 d = vec3_sub(job->line[at], plane->middle);
        double angle = atan2(vec3_dot(d, plane->up), vec3_dot(d, plane->right));
        double share = (angle < 0 ? angle + 2 * MATH_PI : angle) / (2 * MATH_PI);
        size_t bin = (size_t)(share * (double)job->bins) % job->bins;
        if (vec3_length(d) > farthest[bin]) {
            farthest[bin] = vec3_length(d);
            row[bin] = job->line[at];
        }
    }
    for (size_t b = 0; b < job->bins; b++)
        if (farthest[b] < 0)
            row[b] = crossing_at(job, n_line, plane, 2 * MATH_PI * ((double)b + 0.5) / (double)job->bins);
}

static bool make_by_bins(const struct net_job *job, struct nurbs_nets *nets, struct error *err)
{
    const struct outline_set *set = job->set;
    uint32_t first = 0, end = (uint32_t)set->n_slices;
    while (set->slice[first] == set->slice[first + 1])
        first++;
    while (set->slice[end] == set->slice[end - 1])
        end--;
    if (!allot(nets, 1, (uint64_t)(end - first + 2) * job->bins, err))
        return false;
    nets->n_nets = 1;
    nets->nets[0] = (struct nurbs_net){ nets->store, job->bins, end - first + 2 };
    for (uint32_t slice = first; slice < end; slice++) {
        uint32_t line;
        if (!one_line(job, slice, &line, err))
            return false;
        size_t n_line = load_line(job, line);
        struct plane plane = plane_of(job, n_line);
        if (!is_star(job, n_line, &plane, slice, err))
            return false;
        fill_row_by_bins(job, n_line, &plane, nets->store + (size_t)(slice - first + 1) * job->bins);
    }
    put_ends(job, &nets->nets[0]);
    return true;
}

/* ---- nurbs_nets_make -------------------------------------------------------------------------------------------- */

static bool net_job_init(struct net_job *job, const struct mask *mask, int bins, int n_threads, struct error *err)
{
    struct grid grid;
    if (bins < NURBS_MIN_BINS || bins > NURBS_MAX_BINS)
        return error_set(err, ERROR_RANGE, "a spline with %d points around: expected %d to %d", bins, NURBS_MIN_BINS,
                         NURBS_MAX_BINS);
    if (!grid_init(&grid, mask->size, &mask->lps_mm_from_ijk, err))
        return false;
    *job = (struct net_job){ .mask = mask, .axis = grid_index_axis(&grid, 2, NULL), .bins = (size_t)bins };
    job->across = vec3_scale(mask->lps_mm_from_ijk.columns[job->axis], 0.5);
    job->set =
        outline_walk(mask, job->axis, (struct outline_rule){ .is_joined = true, .is_between = true }, n_threads, err);
    if (!job->set)
        return false;
    size_t longest = 0;
    for (uint32_t line = 0; line < job->set->n_lines; line++)
        longest = line_length(job, line) > longest ? line_length(job, line) : longest;
    job->line = mem_array(longest, sizeof *job->line, UINT64_MAX, err);
    job->along = job->line ? mem_array(longest + 1, sizeof *job->along, UINT64_MAX, err) : NULL;
    return job->along != NULL;
}

bool nurbs_nets_make(const struct mask *mask, enum nurbs_sampling sampling, int bins, int n_threads,
                     struct nurbs_nets *nets, struct error *err)
{
    struct net_job job = { .set = NULL };
    *nets = (struct nurbs_nets){ NULL, 0, NULL };
    bool good = net_job_init(&job, mask, bins, n_threads, err);
    if (good && job.set->n_lines == 0)
        good = error_set(err, ERROR_RANGE, "a spline around a region without a voxel");
    good = good && (sampling == NURBS_TRACES ? make_by_traces(&job, nets, err) : make_by_bins(&job, nets, err));
    outline_set_destroy(job.set);
    free(job.line);
    free(job.along);
    if (!good)
        nurbs_nets_finish(nets);
    return good;
}

void nurbs_nets_finish(struct nurbs_nets *nets)
{
    free(nets->nets);
    free(nets->store);
    *nets = (struct nurbs_nets){ NULL, 0, NULL };
}
