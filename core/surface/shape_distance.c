/* Measures the distance of positions to the border faces of a mask. Looks at the inside voxels within a radius of each
 * position; the radius grows until it contains the nearest face. Where that would be many voxels, as with thick slices,
 * the tree of faces is searched instead. */
#include "core/surface/shape_distance.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/boundary.h"
#include "core/surface/face_tree.h"

/* Boxes of up to this many voxel rows are searched directly: above, the tree was faster on the plans it was measured
 * on. */
enum { MAX_ROWS = 256 };
/* BLOCK: positions whose sum is formed together, so that the result does not depend on the threads. */
enum { MAX_THREADS = 64, BLOCK = 1024 };

struct block {
    double sum, max;
    uint64_t n_measured;
    bool is_finite;
};

struct distance_job {
    const struct mask *mask, *border; /* border: inside voxels with a face */
    struct face_tree *faces;
    struct affine ijk_from_lps_mm;
    double reach[3]; /* largest number of index steps along each axis within 1 mm, in any direction */
    double start_mm; /* first search radius */
    const float *positions_lps_mm;
    size_t n_positions, n_blocks;
    struct block *blocks;
    atomic_size_t next;
};

static double square(double x)
{
    return x * x;
}

/* Least squared distance to the faces of one voxel, or `least` if smaller; d is the position minus the voxel, in index
 * steps. */
static double voxel_distance_2(const struct distance_job *job, const int64_t ijk[3], const double d[3], double least,
                               uint64_t *n_measured)
{
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            if (!face_tree_has_face(job->faces, ijk, axis, side))
                continue;
            double here = face_tree_face_distance_2(job->faces, d, axis, side);
            least = here < least ? here : least;
            ++*n_measured;
        }
    return least;
}

/* Upper bound on the rows of voxels, in pieces of eight voxels, that reach to within a radius. */
static double n_rows_within(const struct distance_job *job, double radius_mm)
{
    double n = 1 + 2 * radius_mm * job->reach[0] / 8;
    for (int axis = 1; axis < 3; axis++)
        n *= fmin(job->mask->size[axis], 2 + 2 * radius_mm * job->reach[axis]);
    return n;
}

/* Index range of the voxels that reach to within `steps` of x; false if there are none in the grid. */
static bool range_of(double x, double steps, uint32_t size, int64_t *first, int64_t *last)
{
    double low = ceil(x - steps - 0.5), high = floor(x + steps + 0.5);
    if (high < 0 || low > size - 1.0)
        return false;
    *first = low > 0 ? (int64_t)low : 0;
    *last = high < size - 1.0 ? (int64_t)high : (int64_t)size - 1;
    return true;
}

/* Squared distance within a radius. Exact if the result is at most the radius; INFINITY if no face was found. */
static double search_2(const struct distance_job *job, const double x[3], double radius_mm, uint64_t *n_measured)
{
    int64_t first[3], last[3];
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        if (!range_of(x[axis], radius_mm * job->reach[axis], job->mask->size[axis], &first[axis], &last[axis]))
            return INFINITY;
    for (int64_t k = first[2]; k <= last[2]; k++)
        for (int64_t j = first[1]; j <= last[1]; j++) {
            const uint64_t *row =
                job->border->bits + ((size_t)k * job->border->size[1] + (size_t)j) * job->border->words;
            for (int64_t w = first[0] / 64; w <= last[0] / 64; w++) {
                uint64_t bits = row[w];
                if (w == first[0] / 64)
                    bits &= ~(uint64_t)0 << first[0] % 64;
                if (w == last[0] / 64)
                    bits &= ~(uint64_t)0 >> (63 - last[0] % 64);
                for (; bits; bits &= bits - 1) {
                    int64_t ijk[3] = { 64 * w + __builtin_ctzll(bits), j, k };
                    double d[3] = { x[0] - (double)ijk[0], x[1] - (double)j, x[2] - (double)k };
                    least = voxel_distance_2(job, ijk, d, least, n_measured);
                }
            }
        }
    return least;
}

/* Searches ever larger boxes of voxels until one contains the nearest face, and the tree once boxes get large. */
static double distance_mm(const struct distance_job *job, struct vec3 position, uint64_t *n_measured)
{
    struct vec3 at = affine_point(&job->ijk_from_lps_mm, position);
    double x[3] = { at.x, at.y, at.z }, least = INFINITY;
    for (double radius = job->start_mm; !isfinite(least) && n_rows_within(job, radius) <= MAX_ROWS; radius *= 2) {
        least = sqrt(search_2(job, x, radius, n_measured));
        if (least <= radius)
            return least;
    }
    if (isfinite(least) &&
        n_rows_within(job, least) <= MAX_ROWS) /* a face this near was found: nothing beyond it matters */
        return sqrt(search_2(job, x, least * (1 + 1e-9), n_measured));
    return sqrt(face_tree_nearest_2(job->faces, x, least * least * (1 + 1e-9), n_measured));
}

static void measure_part(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct distance_job *job = context;
    for (size_t b; (b = atomic_fetch_add(&job->next, 1)) < job->n_blocks;) {
        struct block block = { .is_finite = true };
        size_t end = (b + 1) * BLOCK < job->n_positions ? (b + 1) * BLOCK : job->n_positions;
        for (size_t at = b * BLOCK; block.is_finite && at < end; at++) {
            const float *p = job->positions_lps_mm + 3 * at;
            struct vec3 position = vec3((double)p[0], (double)p[1], (double)p[2]);
            block.is_finite = vec3_is_finite(position);
            double d = block.is_finite ? distance_mm(job, position, &block.n_measured) : 0;
            block.sum += d;
            block.max = d > block.max ? d : block.max;
        }
        job->blocks[b] = block;
    }
}

static void prepare(struct distance_job *job)
{
    const struct affine *back = &job->ijk_from_lps_mm;
    job->start_mm = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        job->start_mm = fmin(job->start_mm, vec3_length(job->mask->lps_mm_from_ijk.columns[axis]));
    job->reach[0] = sqrt(square(back->columns[0].x) + square(back->columns[1].x) + square(back->columns[2].x));
    job->reach[1] = sqrt(square(back->columns[0].y) + square(back->columns[1].y) + square(back->columns[2].y));
    job->reach[2] = sqrt(square(back->columns[0].z) + square(back->columns[1].z) + square(back->columns[2].z));
}

static bool join(const struct distance_job *job, struct shape_distance *distance, struct error *err)
{
    double sum = 0, max = 0;
    uint64_t n_measured = 0;
    for (size_t b = 0; b < job->n_blocks; b++) {
        if (!job->blocks[b].is_finite)
            return error_set(err, ERROR_RANGE, "the distance of a position that is not finite");
        sum += job->blocks[b].sum;
        n_measured += job->blocks[b].n_measured;
        max = job->blocks[b].max > max ? job->blocks[b].max : max;
    }
    *distance = (struct shape_distance){ job->n_positions > 0 ? sum / (double)job->n_positions : 0, max,
                                         job->n_positions, n_measured };
    return true;
}

bool shape_distance(const struct mask *mask, const float *positions_lps_mm, size_t n_positions, int n_threads,
                    struct shape_distance *distance, struct error *err)
{
    struct distance_job job = {
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
    job.faces = border ? face_tree_create(mask, err) : NULL;
    job.blocks = job.faces ? mem_array(job.n_blocks, sizeof *job.blocks, UINT64_MAX, err) : NULL;
    bool good = job.blocks != NULL;
    if (good) {
        prepare(&job);
        atomic_init(&job.next, 0);
        parallel_run(n < MAX_THREADS ? n : MAX_THREADS, measure_part, &job);
        good = join(&job, distance, err);
    }
    free(job.blocks);
    face_tree_destroy(job.faces);
    mask_destroy(border);
    return good;
}
