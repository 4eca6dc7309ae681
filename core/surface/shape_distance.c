/* Around each position, inside voxels within a radius are asked for their faces; the radius grows until it holds the nearest one. */
#include "core/surface/shape_distance.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/boundary.h"

enum { MAX_THREADS = 64, BLOCK = 1024 }; /* positions whose sum is taken together, so that threads do not change it */

struct block {
    double sum, max;
    bool is_finite;
};

struct job {
    const struct mask *mask, *border; /* border: inside voxels that have a face */
    struct affine ijk_from_lps_mm;
    double reach[3];  /* index steps that 1 mm can go along each axis, whatever its direction */
    double start_mm;  /* first radius */
    bool is_square;   /* the grid's axes are */
    double spacing_mm[3];
    const float *positions_lps_mm;
    size_t n_positions, n_blocks;
    struct block *blocks;
    atomic_size_t next;
};

static bool has_voxel(const struct mask *mask, int64_t i, int64_t j, int64_t k)
{
    return i >= 0 && j >= 0 && k >= 0 && i < mask->size[0] && j < mask->size[1] && k < mask->size[2] &&
           (mask->bits[((size_t)k * mask->size[1] + (size_t)j) * mask->words + (size_t)i / 64] >> i % 64 & 1);
}

static double square(double x)
{
    return x * x;
}

/* To the points m + s u, |s| <= 1/2; offset = p - m. */
static double edge_distance_2(struct vec3 offset, struct vec3 u)
{
    double s = vec3_dot(offset, u) / vec3_dot(u, u);
    s = s < -0.5 ? -0.5 : s > 0.5 ? 0.5 : s;
    struct vec3 left = vec3_sub(offset, vec3_scale(u, s));
    return vec3_dot(left, left);
}

/* To the points m + s u + t v, |s|, |t| <= 1/2. */
static double face_distance_2(struct vec3 offset, struct vec3 u, struct vec3 v)
{
    double uu = vec3_dot(u, u), vv = vec3_dot(v, v), uv = vec3_dot(u, v), ou = vec3_dot(offset, u), ov = vec3_dot(offset, v);
    double det = uu * vv - uv * uv, s = (ou * vv - ov * uv) / det, t = (ov * uu - ou * uv) / det;
    if (fabs(s) <= 0.5 && fabs(t) <= 0.5) {
        struct vec3 left = vec3_sub(offset, vec3_add(vec3_scale(u, s), vec3_scale(v, t)));
        return vec3_dot(left, left);
    }
    double least = INFINITY;
    for (int side = -1; side <= 1; side += 2) {
        double along_u = edge_distance_2(vec3_sub(offset, vec3_scale(v, side * 0.5)), u);
        double along_v = edge_distance_2(vec3_sub(offset, vec3_scale(u, side * 0.5)), v);
        least = along_u < least ? along_u : least;
        least = along_v < least ? along_v : least;
    }
    return least;
}

/* The least square of the distance to the faces of one voxel; d is the position less the voxel, in index steps. */
static double voxel_distance_2(const struct job *job, const int64_t ijk[3], const double d[3], double least)
{
    const struct vec3 *columns = job->mask->lps_mm_from_ijk.columns;
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            int b = (axis + 1) % 3, c = (axis + 2) % 3;
            int64_t n[3] = { ijk[0], ijk[1], ijk[2] };
            n[axis] += side;
            if (has_voxel(job->mask, n[0], n[1], n[2]))
                continue;
            double off[3] = { d[0], d[1], d[2] }, here;
            off[axis] -= side * 0.5;
            if (job->is_square) {
                double past_b = fabs(off[b]) - 0.5, past_c = fabs(off[c]) - 0.5;
                here = square(off[axis] * job->spacing_mm[axis]) + (past_b > 0 ? square(past_b * job->spacing_mm[b]) : 0) +
                       (past_c > 0 ? square(past_c * job->spacing_mm[c]) : 0);
            } else {
                here = face_distance_2(affine_vector(&job->mask->lps_mm_from_ijk, vec3(off[0], off[1], off[2])), columns[b], columns[c]);
            }
            least = here < least ? here : least;
        }
    return least;
}

/* Index range of voxels that reach to within `steps` of x; false when none of the grid does. */
static bool range_of(double x, double steps, uint32_t size, int64_t *first, int64_t *last)
{
    double low = ceil(x - steps - 0.5), high = floor(x + steps + 0.5);
    if (high < 0 || low > size - 1.0)
        return false;
    *first = low > 0 ? (int64_t)low : 0;
    *last = high < size - 1.0 ? (int64_t)high : (int64_t)size - 1;
    return true;
}

/* Exact when the answer is at most the radius; INFINITY when nothing was met. */
static double search_2(const struct job *job, const double x[3], double radius_mm)
{
    int64_t first[3], last[3];
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        if (!range_of(x[axis], radius_mm * job->reach[axis], job->mask->size[axis], &first[axis], &last[axis]))
            return INFINITY;
    for (int64_t k = first[2]; k <= last[2]; k++)
        for (int64_t j = first[1]; j <= last[1]; j++) {
            const uint64_t *row = job->border->bits + ((size_t)k * job->border->size[1] + (size_t)j) * job->border->words;
            for (int64_t w = first[0] / 64; w <= last[0] / 64; w++) {
                uint64_t bits = row[w];
                if (w == first[0] / 64)
                    bits &= ~(uint64_t)0 << first[0] % 64;
                if (w == last[0] / 64)
                    bits &= ~(uint64_t)0 >> (63 - last[0] % 64);
                for (; bits; bits &= bits - 1) {
                    int64_t ijk[3] = { 64 * w + __builtin_ctzll(bits), j, k };
                    double d[3] = { x[0] - (double)ijk[0], x[1] - (double)j, x[2] - (double)k };
                    least = voxel_distance_2(job, ijk, d, least);
                }
            }
        }
    return least;
}

static double distance_mm(const struct job *job, struct vec3 position)
{
    struct vec3 at = affine_point(&job->ijk_from_lps_mm, position);
    double x[3] = { at.x, at.y, at.z };
    for (double radius = job->start_mm;; radius *= 2) {
        double least = sqrt(search_2(job, x, radius));
        if (least <= radius)
            return least;
        if (isfinite(least)) /* there is one this near: nothing beyond it matters */
            return sqrt(search_2(job, x, least * (1 + 1e-9)));
    }
}

static void measure_part(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct job *job = context;
    for (size_t b; (b = atomic_fetch_add(&job->next, 1)) < job->n_blocks;) {
        struct block block = { .is_finite = true };
        size_t end = (b + 1) * BLOCK < job->n_positions ? (b + 1) * BLOCK : job->n_positions;
        for (size_t at = b * BLOCK; block.is_finite && at < end; at++) {
            const float *p = job->positions_lps_mm + 3 * at;
            struct vec3 position = vec3((double)p[0], (double)p[1], (double)p[2]);
            block.is_finite = vec3_is_finite(position);
            double d = block.is_finite ? distance_mm(job, position) : 0;
            block.sum += d;
            block.max = d > block.max ? d : block.max;
        }
        job->blocks[b] = block;
    }
}

static void prepare(struct job *job)
{
    const struct affine *map = &job->mask->lps_mm_from_ijk, *back = &job->ijk_from_lps_mm;
    job->is_square = true;
    job->start_mm = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 a = map->columns[axis], b = map->columns[(axis + 1) % 3];
        job->spacing_mm[axis] = vec3_length(a);
        job->start_mm = job->spacing_mm[axis] < job->start_mm ? job->spacing_mm[axis] : job->start_mm;
        job->is_square = job->is_square && fabs(vec3_dot(a, b)) <= 1e-9 * vec3_length(a) * vec3_length(b);
    }
    job->reach[0] = sqrt(square(back->columns[0].x) + square(back->columns[1].x) + square(back->columns[2].x));
    job->reach[1] = sqrt(square(back->columns[0].y) + square(back->columns[1].y) + square(back->columns[2].y));
    job->reach[2] = sqrt(square(back->columns[0].z) + square(back->columns[1].z) + square(back->columns[2].z));
}

static bool join(const struct job *job, struct shape_distance *distance, struct error *err)
{
    double sum = 0, max = 0;
    for (size_t b = 0; b < job->n_blocks; b++) {
        if (!job->blocks[b].is_finite)
            return error_set(err, ERROR_RANGE, "the distance of a position that is not finite");
        sum += job->blocks[b].sum;
        max = job->blocks[b].max > max ? job->blocks[b].max : max;
    }
    *distance = (struct shape_distance){ job->n_positions > 0 ? sum / (double)job->n_positions : 0, max, job->n_positions };
    return true;
}

bool shape_distance(const struct mask *mask, const float *positions_lps_mm, size_t n_positions, int n_threads,
                    struct shape_distance *distance, struct error *err)
{
    struct job job = {
        .mask = mask,
        .positions_lps_mm = positions_lps_mm,
        .n_positions = n_positions,
        .n_blocks = n_positions / BLOCK + (n_positions % BLOCK > 0),
    };
    if (mask_count(mask) == 0 || !affine_invert(&mask->lps_mm_from_ijk, &job.ijk_from_lps_mm))
        return error_set(err, ERROR_RANGE, "the distance to a region without a voxel");
    int n = n_threads > 0 ? n_threads : parallel_cores();
    struct mask *border = mask_boundary(mask, false, n, err);
    job.border = border;
    job.blocks = border ? mem_array(job.n_blocks, sizeof *job.blocks, UINT64_MAX, err) : NULL;
    bool good = job.blocks != NULL;
    if (good) {
        prepare(&job);
        atomic_init(&job.next, 0);
        parallel_run(n < MAX_THREADS ? n : MAX_THREADS, measure_part, &job);
        good = join(&job, distance, err);
    }
    free(job.blocks);
    mask_destroy(border);
    return good;
}
