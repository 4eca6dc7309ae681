/* Intersects contour edges with the rows of a grid: areas of planes, and the bits of enclosed voxels. */
#include "core/region/contour/contour_raster.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* Offset of the tested points from voxel centres, so that rounding noise does not decide on which side of an edge a
 * centre is. */
#define NUDGE_MM 1e-6
enum { AREA_LINES = 256, MOST_EXACT_EDGES = 4096, MOST_BUCKETS = 8192, MOST_THREADS = 64 };

/* Raster coordinates: u along the rows of voxels projected into a plane, v across them in the plane, d from plane to
 * plane. */
struct edge {
    double v_low, v_high;  /* low < high: edges parallel to a row are dropped */
    double u_low, u_width; /* u at the lower end, so that the direction in which an edge was drawn does not matter */
};

static double edge_u(const struct edge *edge, double v)
{
    return edge->u_low + edge->u_width * ((v - edge->v_low) / (edge->v_high - edge->v_low));
}

/* The edges of a plane, sorted into buckets of v: the edges of one bucket are those that may cross a given v. */
struct plane_edges {
    struct edge *edges;
    size_t n_edges;
    double v_low, v_high, buckets_per_mm;
    uint32_t n_buckets;
    size_t *starts; /* [n_buckets + 1] start of each bucket in its list */
    uint32_t *which;
};

struct contour_raster {
    const struct contour_planes *planes;
    struct vec3 u_lps, v_lps;
    struct contour_combining combining;
    struct plane_edges *layers; /* those of combining */
};

static void layer_edges(struct plane_edges *layer, const struct contour_raster *raster, const struct contour *contour)
{
    const double *p = contour->points_lps_mm + 3 * (contour->n_points - 1);
    struct vec3 last = vec3(p[0], p[1], p[2]);
    double u = vec3_dot(raster->u_lps, last), v = vec3_dot(raster->v_lps, last);
    for (size_t i = 0; i < contour->n_points; i++) {
        p = contour->points_lps_mm + 3 * i;
        struct vec3 point = vec3(p[0], p[1], p[2]);
        double to_u = vec3_dot(raster->u_lps, point), to_v = vec3_dot(raster->v_lps, point);
        if (v != to_v) {
            bool is_up = v < to_v;
            double u_low = is_up ? u : to_u, v_low = is_up ? v : to_v, v_high = is_up ? to_v : v;
            layer->edges[layer->n_edges++] = (struct edge){ v_low, v_high, u_low, (is_up ? to_u : u) - u_low };
            layer->v_low = fmin(layer->v_low, v_low);
            layer->v_high = fmax(layer->v_high, v_high);
        }
        u = to_u;
        v = to_v;
    }
}

static uint32_t bucket_of(const struct plane_edges *layer, double v)
{
    double at = (v - layer->v_low) * layer->buckets_per_mm;
    /* a layer without height gives NaN */
    return !(at > 0) ? 0 : at >= layer->n_buckets ? layer->n_buckets - 1 : (uint32_t)at;
}

static bool layer_sort(struct plane_edges *layer, double row_mm, struct error *err)
{
    double height_mm = layer->v_high - layer->v_low;
    if (layer->n_edges == 0)
        return true;
    double wanted = fmin(fmax(ceil(height_mm / row_mm), 1), MOST_BUCKETS);
    layer->n_buckets = (uint32_t)wanted;
    /* halve the buckets while long edges fill too many of them */
    for (size_t n_entries;; layer->n_buckets = (layer->n_buckets + 1) / 2) {
        layer->buckets_per_mm = layer->n_buckets / height_mm;
        n_entries = 0;
        for (size_t i = 0; i < layer->n_edges; i++)
            n_entries += bucket_of(layer, layer->edges[i].v_high) - bucket_of(layer, layer->edges[i].v_low) + 1;
        if (layer->n_buckets == 1 || n_entries <= 16 * layer->n_edges + 65536)
            break;
    }
    layer->starts = mem_array(layer->n_buckets + 2, sizeof *layer->starts, UINT64_MAX, err);
    if (!layer->starts)
        return false;
    for (size_t i = 0; i < layer->n_edges; i++)
        for (uint32_t b = bucket_of(layer, layer->edges[i].v_low); b <= bucket_of(layer, layer->edges[i].v_high); b++)
            layer->starts[b + 2]++;
    for (uint32_t b = 2; b < layer->n_buckets + 2; b++)
        layer->starts[b] += layer->starts[b - 1];
    layer->which = mem_array(layer->starts[layer->n_buckets + 1], sizeof *layer->which, UINT64_MAX, err);
    if (!layer->which)
        return false;
    /* starts[b + 1] moves from the start of bucket b to its end, which is the start of bucket b + 1 */
    for (size_t i = 0; i < layer->n_edges; i++)
        for (uint32_t b = bucket_of(layer, layer->edges[i].v_low); b <= bucket_of(layer, layer->edges[i].v_high); b++)
            layer->which[layer->starts[b + 1]++] = (uint32_t)i;
    return true;
}

static bool layer_init(struct plane_edges *layer, const struct contour_raster *raster,
                       const struct even_odd_layer *range, double row_mm, struct error *err)
{
    struct contour const **members = raster->combining.members;
    size_t n_points = 0;
    for (size_t i = range->first; i < range->end; i++)
        n_points += members[i]->n_points;
    *layer = (struct plane_edges){ .v_low = INFINITY, .v_high = -INFINITY };
    layer->edges = mem_array(n_points, sizeof *layer->edges, UINT64_MAX, err);
    if (!layer->edges)
        return false;
    for (size_t i = range->first; i < range->end; i++)
        layer_edges(layer, raster, members[i]);
    return layer_sort(layer, row_mm, err);
}

struct contour_raster *contour_raster_create(const struct contour_planes *planes, const struct grid *grid,
                                             struct error *err)
{
    const struct vec3 *columns = grid->lps_mm_from_ijk.columns;
    struct contour_raster *raster = mem_new(sizeof *raster);
    raster->planes = planes;
    struct vec3 u = vec3(0, 0, 0);
    /* the second axis where rows run along the normal */
    for (int axis = 0; axis < 2 && vec3_length(u) <= 1e-6; axis++) {
        struct vec3 column = vec3_normalize(columns[axis]);
        u = vec3_sub(column, vec3_scale(planes->normal_lps, vec3_dot(planes->normal_lps, column)));
    }
    raster->u_lps = vec3_normalize(u);
    raster->v_lps = vec3_cross(planes->normal_lps, raster->u_lps);
    double row_mm = fmax(fabs(vec3_dot(raster->v_lps, columns[1])), fabs(vec3_dot(raster->v_lps, columns[2])));
    struct contour_combining *combining = &raster->combining;
    bool is_made = contour_combine(combining, planes, raster->u_lps, raster->v_lps, err);
    raster->layers = is_made ? mem_array(combining->n_layers, sizeof *raster->layers, UINT64_MAX, err) : NULL;
    is_made = raster->layers != NULL;
    for (size_t i = 0; is_made && i < combining->n_layers; i++)
        is_made = layer_init(&raster->layers[i], raster, &combining->layers[i], row_mm, err);
    if (!is_made) {
        contour_raster_destroy(raster);
        return NULL;
    }
    return raster;
}

void contour_raster_destroy(struct contour_raster *raster)
{
    if (!raster)
        return;
    for (size_t i = 0; raster->layers && i < raster->combining.n_layers; i++) {
        free(raster->layers[i].edges);
        free(raster->layers[i].starts);
        free(raster->layers[i].which);
    }
    free(raster->layers);
    contour_combining_finish(&raster->combining);
    free(raster);
}

const struct contour_combining *contour_raster_combining(const struct contour_raster *raster)
{
    return &raster->combining;
}

/* ---- areas of planes -------------------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    double one = *(const double *)a, other = *(const double *)b;
    return one < other ? -1 : one > other;
}

/* A place where a line across a plane enters or leaves a layer. */
struct crossing {
    double u;
    size_t layer;
};

static int by_place(const void *a, const void *b)
{
    const struct crossing *one = a, *other = b;
    return one->u < other->u ? -1 : one->u > other->u;
}

static void sort_crossings(struct crossing *crossings, size_t n)
{
    if (n > 32) {
        qsort(crossings, n, sizeof *crossings, by_place);
        return;
    }
    for (size_t i = 1; i < n; i++) {
        struct crossing crossing = crossings[i];
        size_t at = i;
        for (; at > 0 && crossings[at - 1].u > crossing.u; at--)
            crossings[at] = crossings[at - 1];
        crossings[at] = crossing;
    }
}

/* Parts of one plane; of its layers, is_in says which contain the current place. */
struct plane_parts {
    const struct contour_raster *raster;
    const struct contour_part *parts;
    size_t n_parts, first_layer, end_layer;
    bool *is_in; /* indexed by layer - first_layer */
    struct crossing *crossings;
    double *heights;
    uint64_t n_met;
};

static bool is_enclosed(const struct plane_parts *plane)
{
    bool is_in_piece = false;
    for (size_t i = 0; i < plane->n_parts; i++) {
        bool is_in_layer = plane->is_in[plane->parts[i].layer - plane->first_layer];
        if (plane->parts[i].is_cut)
            is_in_piece = is_in_piece && !is_in_layer;
        else if (is_in_piece)
            return true;
        else
            is_in_piece = is_in_layer;
    }
    return is_in_piece;
}

/* Length of the part of the line v that is enclosed. */
static double enclosed_mm(struct plane_parts *plane, double v)
{
    size_t n = 0;
    for (size_t l = plane->first_layer; l < plane->end_layer; l++) {
        const struct plane_edges *layer = &plane->raster->layers[l];
        if (layer->n_edges == 0 || v < layer->v_low || v >= layer->v_high)
            continue;
        uint32_t bucket = bucket_of(layer, v);
        for (size_t at = layer->starts[bucket]; at < layer->starts[bucket + 1]; at++) {
            const struct edge *edge = &layer->edges[layer->which[at]];
            if (edge->v_low <= v && v < edge->v_high)
                plane->crossings[n++] = (struct crossing){ edge_u(edge, v), l };
        }
        plane->n_met += layer->starts[bucket + 1] - layer->starts[bucket];
    }
    plane->n_met += n * (plane->n_parts + (n > 32 ? 16 : 0)); /* count the sorting too */
    sort_crossings(plane->crossings, n);
    double sum = 0, from = 0;
    bool was_enclosed = false;
    for (size_t i = 0; i < n; i++) {
        bool *is_in = &plane->is_in[plane->crossings[i].layer - plane->first_layer];
        *is_in = !*is_in; /* an even number of times on each line, so that all are false at its end */
        bool is_now = is_enclosed(plane);
        if (is_now && !was_enclosed)
            from = plane->crossings[i].u;
        else if (!is_now && was_enclosed)
            sum += plane->crossings[i].u - from;
        was_enclosed = is_now;
    }
    return sum;
}

/* Values of v between which enclosed_mm is linear: those of all points, and evenly spaced ones because edges may cross.
 * Ascending; returns how many. */
static size_t area_heights(const struct plane_parts *plane)
{
    double v_low = INFINITY, v_high = -INFINITY;
    size_t n = 0, n_edges = 0;
    for (size_t l = plane->first_layer; l < plane->end_layer; l++) {
        const struct plane_edges *layer = &plane->raster->layers[l];
        v_low = fmin(v_low, layer->v_low);
        v_high = fmax(v_high, layer->v_high);
        n_edges += layer->n_edges;
    }
    if (n_edges == 0)
        return 0;
    for (size_t line = 0; line <= AREA_LINES; line++)
        plane->heights[n++] = v_low + (v_high - v_low) * (double)line / AREA_LINES;
    for (size_t l = plane->first_layer; l < plane->end_layer && n_edges <= MOST_EXACT_EDGES; l++)
        for (size_t i = 0; i < plane->raster->layers[l].n_edges; i++) {
            plane->heights[n++] = plane->raster->layers[l].edges[i].v_low;
            plane->heights[n++] = plane->raster->layers[l].edges[i].v_high;
        }
    qsort(plane->heights, n, sizeof *plane->heights, by_value);
    return n;
}

static void look_at_plane(struct plane_parts *plane, const struct contour_raster *raster, size_t at)
{
    const struct contour_combining *combining = &raster->combining;
    plane->raster = raster;
    plane->parts = combining->parts + combining->part_starts[at];
    plane->n_parts = combining->part_starts[at + 1] - combining->part_starts[at];
    plane->first_layer = combining->layer_starts[at];
    plane->end_layer = combining->layer_starts[at + 1];
}

bool contour_raster_areas(const struct contour_raster *raster, double *areas_mm2, struct error *err)
{
    size_t n_planes = raster->planes->n_planes, most_edges = 0, most_layers = 0;
    const struct contour_combining *combining = &raster->combining;
    for (size_t i = 0; i < n_planes; i++) {
        size_t n_layers = combining->layer_starts[i + 1] - combining->layer_starts[i], n_edges = 0;
        for (size_t l = combining->layer_starts[i]; l < combining->layer_starts[i + 1]; l++)
            n_edges += raster->layers[l].n_edges;
        most_edges = n_edges > most_edges ? n_edges : most_edges;
        most_layers = n_layers > most_layers ? n_layers : most_layers;
    }
    struct plane_parts plane = { 0 };
    plane.crossings = mem_array(most_edges, sizeof *plane.crossings, UINT64_MAX, err);
    plane.heights = mem_array(2 * MOST_EXACT_EDGES + AREA_LINES + 1, sizeof *plane.heights, UINT64_MAX, err);
    plane.is_in = mem_array(most_layers, sizeof *plane.is_in, UINT64_MAX, err);
    bool is_made = plane.crossings && plane.heights && plane.is_in;
    for (size_t i = 0; is_made && i < n_planes; i++) {
        look_at_plane(&plane, raster, i);
        size_t n = area_heights(&plane);
        areas_mm2[i] = 0;
        for (size_t line = 1; line < n && plane.n_met <= CONTOUR_MAX_MEETINGS; line++) {
            double from = plane.heights[line - 1], to = plane.heights[line];
            if (to > from)
                areas_mm2[i] += (to - from) * enclosed_mm(&plane, (from + to) / 2);
        }
    }
    free(plane.crossings);
    free(plane.heights);
    free(plane.is_in);
    if (!is_made)
        return false;
    if (plane.n_met > CONTOUR_MAX_MEETINGS)
        return error_set(err, ERROR_LIMIT, "contours too intricate: lines across them meet more than %llu edges",
                         (unsigned long long)CONTOUR_MAX_MEETINGS);
    return true;
}

/* ---- bits of voxels --------------------------------------------------------------------------------------------- */

/* A voxel position in raster coordinates: at (i, j, k), u is at.u + i step[0].u + ... */
struct raster_point {
    double u, v, d;
};

struct filling {
    const struct contour_raster *raster;
    const struct grid *grid;
    struct raster_point origin, step[3];
    bool is_aligned; /* each slice of the grid is in one plane, and slices are stacked along the normal */
    uint64_t *bits;
    uint32_t words;
    uint64_t most;
    uint64_t n_voxels[MOST_THREADS], n_met[MOST_THREADS]; /* per thread */
};

static struct raster_point place_of(const struct contour_raster *raster, struct vec3 v)
{
    return (struct raster_point){ vec3_dot(raster->u_lps, v), vec3_dot(raster->v_lps, v),
                                  vec3_dot(raster->planes->normal_lps, v) };
}

/* Replaces a step by 0 if it moves nothing over the whole grid, so that grids meant to be aligned are. */
static double without_noise(double step_mm, uint32_t n)
{
    return fabs(step_mm) * n < NUDGE_MM ? 0 : step_mm;
}

static void filling_init(struct filling *filling, const struct contour_raster *raster, const struct grid *grid)
{
    *filling = (struct filling){ .raster = raster, .grid = grid, .words = (grid->size[0] + 63) / 64 };
    filling->origin = place_of(raster, grid->lps_mm_from_ijk.origin);
    filling->origin.u += NUDGE_MM;
    filling->origin.v += NUDGE_MM;
    filling->origin.d += NUDGE_MM;
    for (int axis = 0; axis < 3; axis++) {
        struct raster_point *step = &filling->step[axis];
        *step = place_of(raster, grid->lps_mm_from_ijk.columns[axis]);
        step->u = without_noise(step->u, grid->size[axis]);
        step->v = axis == 0 ? 0 : without_noise(step->v, grid->size[axis]);
        step->d = without_noise(step->d, grid->size[axis]);
    }
    filling->is_aligned =
        filling->step[0].d == 0 && filling->step[1].d == 0 && filling->step[2].u == 0 && filling->step[2].v == 0;
}

/* The first plane whose slab ends after d. */
static size_t plane_after(const struct contour_planes *planes, double d)
{
    size_t low = 0, high = planes->n_planes;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (planes->planes[middle].high_mm > d)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* The first index in 0..n with from + index * step >= to; step > 0. */
static uint32_t first_index(double from, double step, double to, uint32_t n)
{
    double at = ceil((to - from) / step);
    return at <= 0 ? 0 : at >= n ? n : (uint32_t)at;
}

/* The part of a row inside a slab: from <= index < end. */
static void run_in_slab(const struct contour_plane *plane, double d, double step, uint32_t n, uint32_t *from,
                        uint32_t *end)
{
    if (step > 0) {
        *from = first_index(d, step, plane->low_mm, n);
        *end = first_index(d, step, plane->high_mm, n);
    } else if (step < 0) { /* low <= d + i step < high means floor((high - d) / step) < i <= floor((low - d) / step) */
        double after = floor((plane->high_mm - d) / step) + 1, last = floor((plane->low_mm - d) / step) + 1;
        *from = after <= 0 ? 0 : after >= n ? n : (uint32_t)after;
        *end = last <= 0 ? 0 : last >= n ? n : (uint32_t)last;
    } else {
        bool is_in = plane->low_mm <= d && d < plane->high_mm;
        *from = 0;
        *end = is_in ? n : 0;
    }
}

/* The part of a row in the slab of one plane. */
struct row_run {
    struct raster_point start;
    double u_step;
    uint32_t from, end;
};

/* Toggles a bit at the first index after each crossing, then takes the running parity of the bits: words from/64 ..
 * (end-1)/64 of `inside`. Returns false, with the words unset, if the layer does not reach the row. */
static bool inside_run(const struct plane_edges *layer, const struct row_run *run, uint64_t *inside, uint64_t *n_met)
{
    double v = run->start.v;
    if (layer->n_edges == 0 || v < layer->v_low || v >= layer->v_high)
        return false;
    uint32_t first_word = run->from / 64, last_word = (run->end - 1) / 64;
    memset(inside + first_word, 0, (last_word - first_word + 1) * sizeof *inside);
    uint32_t bucket = bucket_of(layer, v);
    *n_met += layer->starts[bucket + 1] - layer->starts[bucket];
    for (size_t at = layer->starts[bucket]; at < layer->starts[bucket + 1]; at++) {
        const struct edge *edge = &layer->edges[layer->which[at]];
        if (v < edge->v_low || v >= edge->v_high)
            continue;
        double u = edge_u(edge, v);
        uint32_t index = run->u_step > 0     ? first_index(run->start.u, run->u_step, u, run->end)
                         : u <= run->start.u ? 0
                                             : run->end;
        index = index < run->from ? run->from : index;
        if (index < run->end)
            inside[index / 64] ^= (uint64_t)1 << index % 64;
    }
    uint64_t carry = 0;
    for (uint32_t word = first_word; word <= last_word; word++) {
        for (int shift = 1; shift < 64; shift *= 2)
            inside[word] ^= inside[word] << shift;
        inside[word] ^= carry;
        carry = inside[word] >> 63 ? UINT64_MAX : 0;
        if (word == last_word && run->end % 64 != 0)
            inside[word] &= ((uint64_t)1 << run->end % 64) - 1;
    }
    return true;
}

static uint64_t count_and_add(const uint64_t *inside, const struct row_run *run, uint64_t *row)
{
    uint64_t n = 0;
    for (uint32_t word = run->from / 64; word <= (run->end - 1) / 64; word++) {
        n += (uint64_t)__builtin_popcountll(inside[word]);
        if (row)
            row[word] |= inside[word];
    }
    return n;
}

/* Adds the piece that parts[at] begins to `all`. Returns the index after its last part. */
static size_t add_piece(const struct contour_raster *raster, size_t at, size_t end, const struct row_run *run,
                        uint64_t *all, uint64_t *n_met)
{
    const struct contour_part *parts = raster->combining.parts;
    uint64_t piece[VOLUME_MAX_SIDE / 64], cut[VOLUME_MAX_SIDE / 64];
    uint32_t first_word = run->from / 64, last_word = (run->end - 1) / 64;
    bool is_met = inside_run(&raster->layers[parts[at].layer], run, piece, n_met);
    for (at++; at < end && parts[at].is_cut; at++)
        if (is_met && inside_run(&raster->layers[parts[at].layer], run, cut, n_met))
            for (uint32_t word = first_word; word <= last_word; word++)
                piece[word] &= ~cut[word];
    for (uint32_t word = first_word; is_met && word <= last_word; word++)
        all[word] |= piece[word];
    return at;
}

static uint64_t fill_run(const struct contour_raster *raster, size_t plane, const struct row_run *run, uint64_t *row,
                         uint64_t *n_met)
{
    const struct contour_combining *combining = &raster->combining;
    size_t at = combining->part_starts[plane], end = combining->part_starts[plane + 1];
    uint64_t inside[VOLUME_MAX_SIDE / 64];
    if (run->from >= run->end)
        return 0;
    if (end - at == 1) {
        const struct plane_edges *layer = &raster->layers[combining->parts[at].layer];
        return inside_run(layer, run, inside, n_met) ? count_and_add(inside, run, row) : 0;
    }
    uint32_t first_word = run->from / 64, last_word = (run->end - 1) / 64;
    memset(inside + first_word, 0, (last_word - first_word + 1) * sizeof *inside);
    *n_met += end - at;
    while (at < end)
        at = add_piece(raster, at, end, run, inside, n_met);
    return count_and_add(inside, run, row);
}

static uint64_t fill_row(const struct filling *filling, const struct raster_point *start, uint64_t *row,
                         uint64_t *n_met)
{
    const struct contour_planes *planes = filling->raster->planes;
    uint32_t n = filling->grid->size[0];
    double d_step = filling->step[0].d, d_last = start->d + (n - 1) * d_step;
    double d_low = fmin(start->d, d_last), d_high = fmax(start->d, d_last);
    uint64_t n_voxels = 0;
    for (size_t i = plane_after(planes, d_low); i < planes->n_planes && planes->planes[i].low_mm <= d_high; i++) {
        struct row_run run = { .start = *start, .u_step = filling->step[0].u };
        run_in_slab(&planes->planes[i], start->d, d_step, n, &run.from, &run.end);
        n_voxels += fill_run(filling->raster, i, &run, row, n_met);
    }
    return n_voxels;
}

static struct raster_point row_start(const struct filling *filling, uint32_t j, uint32_t k)
{
    const struct raster_point *o = &filling->origin, *sj = &filling->step[1], *sk = &filling->step[2];
    return (struct raster_point){ o->u + j * sj->u + k * sk->u, o->v + j * sj->v + k * sk->v,
                                  o->d + j * sj->d + k * sk->d };
}

static void fill_slices(void *context, int part, int n_parts)
{
    struct filling *filling = context;
    const struct contour_planes *planes = filling->raster->planes;
    const uint32_t *size = filling->grid->size;
    size_t slice_words = (size_t)size[1] * filling->words;
    uint32_t first = (uint32_t)((uint64_t)size[2] * (uint32_t)part / (uint32_t)n_parts);
    uint32_t end = (uint32_t)((uint64_t)size[2] * ((uint32_t)part + 1) / (uint32_t)n_parts);
    uint64_t n_voxels = 0, n_met = 0, n_slice_voxels = 0, n_slice_met = 0;
    size_t last_plane = SIZE_MAX;
    for (uint32_t k = first; k < end && n_met <= filling->most; k++) {
        uint64_t *slice = filling->bits ? filling->bits + k * slice_words : NULL;
        size_t plane = filling->is_aligned ? plane_after(planes, row_start(filling, 0, k).d) : SIZE_MAX;
        bool is_same = plane != SIZE_MAX && plane == last_plane && plane < planes->n_planes &&
                       row_start(filling, 0, k).d >= planes->planes[plane].low_mm;
        if (is_same) {
            if (slice)
                memcpy(slice, slice - slice_words, slice_words * sizeof *slice);
        } else {
            n_slice_voxels = n_slice_met = 0;
            for (uint32_t j = 0; j < size[1] && n_met + n_slice_met <= filling->most; j++) {
                struct raster_point start = row_start(filling, j, k);
                n_slice_voxels +=
                    fill_row(filling, &start, slice ? slice + (size_t)j * filling->words : NULL, &n_slice_met);
            }
            /* a slice filled before the slab begins does not show what the slices of the slab look like */
            bool is_in_slab = plane < planes->n_planes && row_start(filling, 0, k).d >= planes->planes[plane].low_mm;
            last_plane = is_in_slab ? plane : SIZE_MAX;
        }
        n_voxels += n_slice_voxels;
        n_met += n_slice_met;
    }
    filling->n_voxels[part] = n_voxels;
    filling->n_met[part] = n_met;
}

bool contour_raster_fill(const struct contour_raster *raster, const struct grid *grid, uint64_t *bits, int n_threads,
                         uint64_t most, uint64_t *n_voxels, struct error *err)
{
    struct filling *filling = mem_new(sizeof *filling);
    filling_init(filling, raster, grid);
    filling->bits = bits;
    filling->most = most;
    parallel_run(n_threads < 1 ? 1 : n_threads > MOST_THREADS ? MOST_THREADS : n_threads, fill_slices, filling);
    uint64_t n_met = 0;
    *n_voxels = 0;
    for (int part = 0; part < MOST_THREADS; part++) {
        *n_voxels += filling->n_voxels[part];
        n_met += filling->n_met[part];
    }
    free(filling);
    return n_met <= most ||
           error_set(err, ERROR_LIMIT, "contours too intricate: the rows of voxels meet more than %llu edges",
                     (unsigned long long)most);
}
