/* Compares the contours of each plane pair by pair, by the lengths that they share on lines across them; from the
 * relations follow holes, islands, repetitions and unions. */
#include "core/region/contour/contour_combine.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define REPEATED_MM 0.35   /* mean distance of the outlines of two contours that are one */
#define REPEATED_SHARE 0.8 /* least area of the smaller, as a share of the larger */
#define ON_OUTLINE_MM 0.1  /* every point of a coarser copy is this near to the outline */
#define UNION_MM 0.002     /* overlaps narrower than this, on the mean of the length, are rounding */
enum { LINES = 128, BUCKETS = 128, LEAST_BUCKETED = 64 };

enum relation { APART, OVERLAPPING, CONTAINING, REPEATED };

/* One contour of a plane, projected. */
struct outline {
    const struct contour *contour;
    const double *uv; /* [n][2] */
    size_t n;
    double low[2], high[2];
    double length_mm, mm2;
    size_t layer;
    uint32_t *starts; /* [BUCKETS + 1] edges by bucket of v, in `edges`; NULL: all are looked at */
    uint32_t *edges;  /* numbers of end points */
    uint32_t depth;
    bool is_measured, is_left_out;
};

/* outer and inner: numbers of outlines; with OVERLAPPING and REPEATED in any sequence. */
struct pair {
    size_t outer, inner;
    enum relation relation;
};

struct plane_work {
    struct outline *outlines;
    size_t n;
    double *crossings[2]; /* room for the points of the largest contour, each */
    struct pair *pairs;
    size_t n_pairs, pairs_room;
    uint64_t *n_steps;
    bool is_said; /* an overlap is wide enough to be reported */
};

static int by_value(const void *a, const void *b)
{
    double one = *(const double *)a, other = *(const double *)b;
    return one < other ? -1 : one > other;
}

static uint32_t bucket_of(const struct outline *outline, double v)
{
    double at = (v - outline->low[1]) / (outline->high[1] - outline->low[1]) * BUCKETS;
    return !(at > 0) ? 0 : at >= BUCKETS ? BUCKETS - 1 : (uint32_t)at;
}

static const double *start_of(const struct outline *outline, size_t edge)
{
    return outline->uv + 2 * (edge > 0 ? edge - 1 : outline->n - 1);
}

/* Sorts the edges of a long outline into buckets, unless many edges are as high as the outline. */
static bool sort_edges(struct outline *outline, struct error *err)
{
    uint32_t counts[BUCKETS + 2] = { 0 };
    size_t n = 0;
    if (outline->n < LEAST_BUCKETED || outline->n > CONTOUR_MAX_POINTS)
        return true;
    for (size_t i = 0; i < outline->n; i++) {
        uint32_t a = bucket_of(outline, start_of(outline, i)[1]), b = bucket_of(outline, outline->uv[2 * i + 1]);
        for (uint32_t k = a < b ? a : b; k <= (a < b ? b : a); k++)
            counts[k + 2]++;
        n += 1 + (a < b ? b - a : a - b);
    }
    if (n > 8 * outline->n + BUCKETS)
        return true;
    for (size_t k = 2; k < BUCKETS + 2; k++)
        counts[k] += counts[k - 1];
    outline->starts = mem_array(BUCKETS + 1 + n, sizeof *outline->starts, UINT64_MAX, err);
    if (!outline->starts)
        return false;
    outline->edges = outline->starts + BUCKETS + 1;
    for (size_t i = 0; i < outline->n; i++) {
        uint32_t a = bucket_of(outline, start_of(outline, i)[1]), b = bucket_of(outline, outline->uv[2 * i + 1]);
        for (uint32_t k = a < b ? a : b; k <= (a < b ? b : a); k++)
            outline->edges[counts[k + 1]++] = (uint32_t)i;
    }
    memcpy(outline->starts, counts, (BUCKETS + 1) * sizeof *counts);
    return true;
}

/* The sorted positions where the line v crosses an outline. */
static size_t crossings_at(const struct outline *outline, double v, double *out, uint64_t *n_steps)
{
    size_t n = 0;
    if (v < outline->low[1] || v >= outline->high[1])
        return 0;
    uint32_t bucket = outline->starts ? bucket_of(outline, v) : 0;
    size_t first = outline->starts ? outline->starts[bucket] : 0,
           end = outline->starts ? outline->starts[bucket + 1] : outline->n;
    for (size_t at = first; at < end; at++) {
        size_t i = outline->starts ? outline->edges[at] : at;
        const double *from = start_of(outline, i), *to = outline->uv + 2 * i;
        const double *low = from[1] < to[1] ? from : to, *high = from[1] < to[1] ? to : from;
        if (low[1] <= v && v < high[1])
            out[n++] = low[0] + (high[0] - low[0]) * ((v - low[1]) / (high[1] - low[1]));
    }
    *n_steps += end - first + n;
    if (n == 2 && out[0] > out[1]) {
        double last = out[0];
        out[0] = out[1];
        out[1] = last;
    } else if (n > 2) {
        qsort(out, n, sizeof *out, by_value);
    }
    return n;
}

static double inside_mm(const double *crossings, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < n; i += 2)
        sum += crossings[i + 1] - crossings[i];
    return sum;
}

/* Length that is inside both. */
static double shared_mm(const double *a, size_t n_a, const double *b, size_t n_b)
{
    double sum = 0;
    for (size_t i = 0, k = 0; i + 1 < n_a && k + 1 < n_b;) {
        sum += fmax(0, fmin(a[i + 1], b[k + 1]) - fmax(a[i], b[k]));
        if (a[i + 1] < b[k + 1])
            i += 2;
        else
            k += 2;
    }
    return sum;
}

static double line_at(const struct outline *outline, int line)
{
    return outline->low[1] + (outline->high[1] - outline->low[1]) * (line + 0.5) / LINES;
}

static bool measure(struct plane_work *work, struct outline *outline, struct error *err)
{
    if (outline->is_measured)
        return true;
    if (!sort_edges(outline, err))
        return false;
    double sum = 0, pitch_mm = (outline->high[1] - outline->low[1]) / LINES;
    for (int line = 0; line < LINES; line++) {
        size_t n = crossings_at(outline, line_at(outline, line), work->crossings[0], work->n_steps);
        sum += inside_mm(work->crossings[0], n) * pitch_mm;
    }
    outline->mm2 = sum;
    outline->length_mm = 0;
    for (size_t i = 0; i < outline->n; i++) {
        const double *a = outline->uv + 2 * i, *b = outline->uv + 2 * (i + 1 < outline->n ? i + 1 : 0);
        outline->length_mm += hypot(b[0] - a[0], b[1] - a[1]);
    }
    outline->is_measured = true;
    return true;
}

static double distance_mm(const double *point, const double *a, const double *b)
{
    double along[2] = { b[0] - a[0], b[1] - a[1] }, to[2] = { point[0] - a[0], point[1] - a[1] };
    double length2 = along[0] * along[0] + along[1] * along[1];
    double t = length2 > 0 ? fmin(1, fmax(0, (to[0] * along[0] + to[1] * along[1]) / length2)) : 0;
    return hypot(to[0] - t * along[0], to[1] - t * along[1]);
}

/* Returns true if every point of inner lies on the outline of outer: a copy with fewer points. */
static bool is_coarser_copy(struct plane_work *work, const struct outline *outer, const struct outline *inner)
{
    for (size_t p = 0; p < inner->n; p++) {
        double least = INFINITY;
        for (size_t i = 0; i < outer->n && least > ON_OUTLINE_MM; i++)
            least = fmin(least, distance_mm(inner->uv + 2 * p, outer->uv + 2 * i,
                                            outer->uv + 2 * (i + 1 < outer->n ? i + 1 : 0)));
        *work->n_steps += outer->n;
        if (least > ON_OUTLINE_MM || *work->n_steps > CONTOUR_MAX_COMPARED)
            return false;
    }
    return true;
}

static enum relation compare(struct plane_work *work, struct outline *outer, struct outline *inner)
{
    double shared = 0, pitch_mm = (inner->high[1] - inner->low[1]) / LINES;
    for (int line = 0; line < LINES; line++) {
        double v = line_at(inner, line);
        size_t n_outer = crossings_at(outer, v, work->crossings[0], work->n_steps);
        size_t n_inner = n_outer > 0 ? crossings_at(inner, v, work->crossings[1], work->n_steps) : 0;
        shared += shared_mm(work->crossings[0], n_outer, work->crossings[1], n_inner) * pitch_mm;
    }
    *work->n_steps += LINES;
    double alone_outer = fmax(0, outer->mm2 - shared), alone_inner = fmax(0, inner->mm2 - shared);
    bool is_alike = inner->mm2 >= REPEATED_SHARE * outer->mm2;
    if (is_alike && alone_outer + alone_inner <= REPEATED_MM * (outer->length_mm + inner->length_mm) / 2)
        return REPEATED;
    bool is_inside = alone_inner <= CONTOUR_SAME_MM * inner->length_mm && shared >= inner->mm2 / 2;
    if (is_inside)
        return is_alike && is_coarser_copy(work, outer, inner) ? REPEATED : CONTAINING;
    double least_mm = fmin(outer->length_mm, inner->length_mm);
    if (shared <= UNION_MM * least_mm)
        return APART;
    work->is_said |= shared > CONTOUR_SAME_MM * least_mm;
    return OVERLAPPING;
}

static bool add_pair(struct plane_work *work, struct pair pair, struct error *err)
{
    if (work->n_pairs == work->pairs_room) {
        size_t room = 2 * work->pairs_room + 16;
        struct pair *larger = realloc(work->pairs, room * sizeof *larger);
        if (!larger)
            return error_set(err, ERROR_MEMORY, "no memory for %zu pairs of contours", room);
        work->pairs = larger;
        work->pairs_room = room;
    }
    work->pairs[work->n_pairs++] = pair;
    return true;
}

static int by_left_side(const void *a, const void *b)
{
    const struct outline *one = *(struct outline *const *)a, *other = *(struct outline *const *)b;
    if (one->low[0] != other->low[0])
        return one->low[0] < other->low[0] ? -1 : 1;
    return one->contour < other->contour ? -1 : one->contour > other->contour;
}

/* Compares two outlines and keeps their relation unless they are apart. */
static bool relate(struct plane_work *work, struct outline *a, struct outline *b, struct error *err)
{
    if (!measure(work, a, err) || !measure(work, b, err))
        return false;
    struct outline *outer = a->mm2 >= b->mm2 ? a : b, *inner = a->mm2 >= b->mm2 ? b : a;
    enum relation relation = compare(work, outer, inner);
    struct pair pair = { (size_t)(outer - work->outlines), (size_t)(inner - work->outlines), relation };
    return relation == APART || add_pair(work, pair, err);
}

static bool find_pairs(struct plane_work *work, struct error *err)
{
    struct outline **order = mem_array(work->n, sizeof *order, UINT64_MAX, err);
    if (!order)
        return false;
    for (size_t i = 0; i < work->n; i++)
        order[i] = &work->outlines[i];
    qsort(order, work->n, sizeof *order, by_left_side);
    bool is_found = true;
    for (size_t i = 0; is_found && i < work->n; i++)
        for (size_t k = i + 1; is_found && k < work->n && order[k]->low[0] < order[i]->high[0]; k++) {
            ++*work->n_steps;
            if (order[k]->low[1] < order[i]->high[1] && order[i]->low[1] < order[k]->high[1])
                is_found = relate(work, order[i], order[k], err);
            if (is_found && *work->n_steps > CONTOUR_MAX_COMPARED)
                is_found = error_set(err, ERROR_LIMIT,
                                     "contours too intricate: comparing those of one plane takes over %llu steps",
                                     (unsigned long long)CONTOUR_MAX_COMPARED);
        }
    free(order);
    return is_found;
}

static int by_later(const void *a, const void *b)
{
    const struct pair *one = a, *other = b;
    size_t later = one->outer > one->inner ? one->outer : one->inner,
           other_later = other->outer > other->inner ? other->outer : other->inner;
    return later < other_later ? -1 : later > other_later;
}

/* Leaves out each outline that repeats an earlier one that stays. */
static size_t leave_out_repeated(struct plane_work *work)
{
    size_t n = 0;
    if (work->n_pairs > 0)
        qsort(work->pairs, work->n_pairs, sizeof *work->pairs, by_later);
    for (size_t i = 0; i < work->n_pairs; i++) {
        const struct pair *pair = &work->pairs[i];
        size_t later = pair->outer > pair->inner ? pair->outer : pair->inner,
               earlier = pair->outer > pair->inner ? pair->inner : pair->outer;
        if (pair->relation != REPEATED || work->outlines[earlier].is_left_out || work->outlines[later].is_left_out)
            continue;
        work->outlines[later].is_left_out = true;
        n++;
    }
    return n;
}

static bool is_kept(const struct plane_work *work, const struct pair *pair)
{
    return !work->outlines[pair->outer].is_left_out && !work->outlines[pair->inner].is_left_out;
}

/* Depth of each outline: the length of the longest chain of outlines around it. A chain's areas descend, so that at
 * most n passes are needed; few are, as chains are short. */
static void find_depths(struct plane_work *work)
{
    for (bool is_changed = true; is_changed && *work->n_steps <= CONTOUR_MAX_COMPARED;) {
        is_changed = false;
        for (size_t i = 0; i < work->n_pairs; i++) {
            const struct pair *pair = &work->pairs[i];
            struct outline *outer = &work->outlines[pair->outer], *inner = &work->outlines[pair->inner];
            if (pair->relation != CONTAINING || !is_kept(work, pair) || inner->depth > outer->depth ||
                outer->depth >= work->n)
                continue;
            inner->depth = outer->depth + 1;
            is_changed = true;
        }
        *work->n_steps += work->n_pairs;
    }
}

static bool add_part(struct contour_combining *combining, size_t layer, bool is_cut, struct error *err)
{
    if (combining->n_parts == combining->parts_room) {
        size_t room = 2 * combining->parts_room + 64;
        struct contour_part *larger = realloc(combining->parts, room * sizeof *larger);
        if (!larger)
            return error_set(err, ERROR_MEMORY, "no memory for %zu parts of regions", room);
        combining->parts = larger;
        combining->parts_room = room;
    }
    combining->parts[combining->n_parts++] = (struct contour_part){ layer, is_cut };
    return true;
}

/* Puts the outlines that stay into one layer; n_members counts the members so far. */
static void add_layer(struct contour_combining *combining, struct outline *outlines, size_t n, size_t *n_members)
{
    struct even_odd_layer layer = { .first = *n_members };
    for (size_t i = 0; i < n; i++)
        if (!outlines[i].is_left_out) {
            combining->members[(*n_members)++] = outlines[i].contour;
            outlines[i].layer = combining->n_layers;
        }
    layer.end = *n_members;
    combining->layers[combining->n_layers++] = layer;
}

/* Each solid outline is a piece, from which the holes inside it are cut. */
static bool add_pieces(struct contour_combining *combining, struct plane_work *work, size_t *n_members,
                       struct error *err)
{
    bool is_added = true;
    for (size_t i = 0; i < work->n; i++)
        if (!work->outlines[i].is_left_out)
            add_layer(combining, &work->outlines[i], 1, n_members);
    for (size_t i = 0; is_added && i < work->n; i++) {
        const struct outline *solid = &work->outlines[i];
        if (solid->is_left_out || solid->depth % 2 == 1)
            continue;
        is_added = add_part(combining, solid->layer, false, err);
        for (size_t p = 0; is_added && p < work->n_pairs; p++) {
            const struct outline *inner = &work->outlines[work->pairs[p].inner];
            if (work->pairs[p].relation == CONTAINING && work->pairs[p].outer == i && is_kept(work, &work->pairs[p]) &&
                inner->depth % 2 == 1)
                is_added = add_part(combining, inner->layer, true, err);
        }
        *work->n_steps += work->n_pairs;
        if (is_added && *work->n_steps > CONTOUR_MAX_COMPARED)
            is_added = error_set(err, ERROR_LIMIT, "contours too intricate: %zu pairs of them overlap on one plane",
                                 work->n_pairs);
    }
    return is_added;
}

static int by_address(const void *a, const void *b)
{
    const struct contour *one = *(const struct contour *const *)a, *other = *(const struct contour *const *)b;
    return one < other ? -1 : one > other;
}

static void project(struct outline *outline, const struct contour *contour, double *uv, struct vec3 u, struct vec3 v)
{
    *outline = (struct outline){ .contour = contour,
                                 .uv = uv,
                                 .n = contour->n_points,
                                 .low = { INFINITY, INFINITY },
                                 .high = { -INFINITY, -INFINITY } };
    for (size_t i = 0; i < contour->n_points; i++) {
        const double *p = contour->points_lps_mm + 3 * i;
        struct vec3 point = vec3(p[0], p[1], p[2]);
        uv[2 * i] = vec3_dot(u, point);
        uv[2 * i + 1] = vec3_dot(v, point);
        for (int a = 0; a < 2; a++) {
            outline->low[a] = fmin(outline->low[a], uv[2 * i + (size_t)a]);
            outline->high[a] = fmax(outline->high[a], uv[2 * i + (size_t)a]);
        }
    }
}

static bool combine_outlines(struct contour_combining *combining, struct plane_work *work, size_t *n_members,
                             struct error *err)
{
    if (!find_pairs(work, err))
        return false;
    combining->n_repeated += leave_out_repeated(work);
    find_depths(work);
    bool has_overlap = false, is_xor = true;
    for (size_t i = 0; i < work->n; i++)
        is_xor &= work->outlines[i].contour->is_xor;
    for (size_t i = 0; i < work->n_pairs && !is_xor; i++)
        has_overlap |= work->pairs[i].relation == OVERLAPPING && is_kept(work, &work->pairs[i]);
    combining->n_overlap_planes += has_overlap && work->is_said;
    if (has_overlap)
        return add_pieces(combining, work, n_members, err);
    add_layer(combining, work->outlines, work->n, n_members);
    return add_part(combining, combining->n_layers - 1, false, err);
}

static bool combine_plane(struct contour_combining *combining, const struct contour_planes *planes,
                          const struct contour_plane *plane, struct vec3 u, struct vec3 v, size_t *n_members,
                          uint64_t *n_steps, struct error *err)
{
    size_t n = plane->end - plane->first, n_points = 0, most = 0;
    struct contour const **contours = planes->contours + plane->first;
    if (n == 1) {
        combining->members[*n_members] = contours[0];
        combining->layers[combining->n_layers] = (struct even_odd_layer){ *n_members, *n_members + 1 };
        ++*n_members;
        return add_part(combining, combining->n_layers++, false, err);
    }
    struct contour const **in_order = mem_array(n, sizeof *in_order, UINT64_MAX, err);
    struct plane_work work = { .n = n, .n_steps = n_steps };
    for (size_t i = 0; i < n; i++) {
        n_points += contours[i]->n_points;
        most = contours[i]->n_points > most ? contours[i]->n_points : most;
    }
    double *uv = in_order ? mem_array(n_points, 2 * sizeof *uv, UINT64_MAX, err) : NULL;
    work.outlines = uv ? mem_array(n, sizeof *work.outlines, UINT64_MAX, err) : NULL;
    work.crossings[0] = work.outlines ? mem_array(most, 2 * sizeof *uv, UINT64_MAX, err) : NULL;
    bool is_combined = work.crossings[0] != NULL;
    if (is_combined) {
        work.crossings[1] = work.crossings[0] + most;
        memcpy(in_order, contours, n * sizeof *in_order);
        qsort(in_order, n, sizeof *in_order, by_address); /* as in the file: of two copies the first stays */
        for (size_t i = 0, at = 0; i < n; at += in_order[i++]->n_points)
            project(&work.outlines[i], in_order[i], uv + 2 * at, u, v);
        is_combined = combine_outlines(combining, &work, n_members, err);
    }
    for (size_t i = 0; work.outlines && i < n; i++)
        free(work.outlines[i].starts);
    free(work.crossings[0]);
    free(work.outlines);
    free(work.pairs);
    free(uv);
    free(in_order);
    return is_combined;
}

bool contour_combine(struct contour_combining *combining, const struct contour_planes *planes, struct vec3 u_lps,
                     struct vec3 v_lps, struct error *err)
{
    *combining = (struct contour_combining){ 0 };
    size_t n = planes->n_contours + planes->n_planes + 1, n_members = 0;
    uint64_t n_steps = 0;
    combining->members = mem_array(n, sizeof *combining->members, UINT64_MAX, err);
    combining->layers = combining->members ? mem_array(n, sizeof *combining->layers, UINT64_MAX, err) : NULL;
    combining->part_starts = combining->layers ? mem_array(n, sizeof *combining->part_starts, UINT64_MAX, err) : NULL;
    combining->layer_starts =
        combining->part_starts ? mem_array(n, sizeof *combining->layer_starts, UINT64_MAX, err) : NULL;
    bool is_combined = combining->layer_starts != NULL;
    for (size_t i = 0; is_combined && i < planes->n_planes; i++) {
        combining->part_starts[i] = combining->n_parts;
        combining->layer_starts[i] = combining->n_layers;
        is_combined = combine_plane(combining, planes, &planes->planes[i], u_lps, v_lps, &n_members, &n_steps, err);
    }
    if (!is_combined) {
        contour_combining_finish(combining);
        return false;
    }
    combining->part_starts[planes->n_planes] = combining->n_parts;
    combining->layer_starts[planes->n_planes] = combining->n_layers;
    return true;
}

void contour_combining_finish(struct contour_combining *combining)
{
    free(combining->members);
    free(combining->layers);
    free(combining->parts);
    free(combining->part_starts);
    free(combining->layer_starts);
    *combining = (struct contour_combining){ 0 };
}
