/* Finds the smallest and largest value in each brick of a field, and the bricks with voxels without a value. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/isosurface.h"
#include "core/surface/marching_rows.h"

struct bricks_job {
    const struct volume *field;
    struct iso_bricks *bricks;
    enum marching_cubes_code code;
    atomic_uint next; /* layer of bricks along k */
    atomic_bool is_out_of_memory;
};

/* First and last voxel of brick b of an axis. */
INLINED void brick_voxels(uint32_t b, uint32_t extent, uint32_t size, uint32_t *first, uint32_t *last)
{
    *first = b * extent;
    *last = *first + extent < size ? *first + extent : size - 1;
}

/* Adds a row of n values to the smallest and largest of each column. */
INLINED void add_row(const float *restrict row, uint32_t n, float *restrict low, float *restrict high,
                     uint32_t *restrict gaps)
{
    for (uint32_t i = 0; i < n; i++) {
        const float value = row[i];
        bool is_gap = !(value - value == 0.0f);
        low[i] = !is_gap && value < low[i] ? value : low[i];
        high[i] = !is_gap && value > high[i] ? value : high[i];
        gaps[i] |= is_gap;
    }
}

/* One row of bricks along i. The first of the arrays has room for a value a voxel, as the others. */
INLINED void make_row(const struct bricks_job *job, uint32_t b_j, uint32_t b_k, float *low, float *high, uint32_t *gaps)
{
    const uint32_t *size = job->field->grid.size;
    struct iso_bricks *bricks = job->bricks;
    uint32_t first[3], last[3];
    brick_voxels(b_j, ISO_BRICK_J, size[1], &first[1], &last[1]);
    brick_voxels(b_k, ISO_BRICK_K, size[2], &first[2], &last[2]);
    for (uint32_t i = 0; i < size[0]; i++) {
        low[i] = INFINITY;
        high[i] = -INFINITY;
        gaps[i] = 0;
    }
    for (uint32_t k = first[2]; k <= last[2]; k++)
        for (uint32_t j = first[1]; j <= last[1]; j++)
            add_row((const float *)job->field->voxels + ((size_t)k * size[1] + j) * size[0], size[0], low, high, gaps);
    size_t at = ((size_t)b_k * bricks->n[1] + b_j) * bricks->n[0];
    for (uint32_t b = 0; b < bricks->n[0]; b++, at++) {
        brick_voxels(b, ISO_BRICK_I, size[0], &first[0], &last[0]);
        float least = low[first[0]], most = high[first[0]];
        uint32_t any = gaps[first[0]];
        for (uint32_t i = first[0] + 1; i <= last[0]; i++) {
            least = low[i] < least ? low[i] : least;
            most = high[i] > most ? high[i] : most;
            any |= gaps[i];
        }
        bricks->low[at] = least;
        bricks->high[at] = most;
        bricks->has_gaps[at] = (uint8_t)any;
    }
}

#if defined(__x86_64__)
FAST static void make_row_fast(const struct bricks_job *job, uint32_t b_j, uint32_t b_k, float *low, float *high,
                               uint32_t *gaps)
{
    make_row(job, b_j, b_k, low, high, gaps);
}
#else
#define make_row_fast make_row
#endif

static void make_layers(void *context, int part, int n_parts)
{
    struct bricks_job *job = context;
    uint32_t n = job->field->grid.size[0];
    struct error err = { 0 };
    (void)part, (void)n_parts;
    float *low = mem_array((size_t)n, 2 * sizeof *low + sizeof(uint32_t), UINT64_MAX, &err);
    if (!low)
        atomic_store(&job->is_out_of_memory, true);
    for (uint32_t b_k; low && (b_k = atomic_fetch_add(&job->next, 1)) < job->bricks->n[2];)
        for (uint32_t b_j = 0; b_j < job->bricks->n[1]; b_j++) {
            if (job->code == MARCHING_CUBES_PORTABLE)
                make_row(job, b_j, b_k, low, low + n, (uint32_t *)(low + 2 * (size_t)n));
            else
                make_row_fast(job, b_j, b_k, low, low + n, (uint32_t *)(low + 2 * (size_t)n));
        }
    free(low);
}

struct iso_bricks *iso_bricks_create(const struct volume *field, int n_threads, struct error *err)
{
    static const uint32_t extent[3] = { ISO_BRICK_I, ISO_BRICK_J, ISO_BRICK_K };
    struct iso_bricks *bricks = mem_new(sizeof *bricks);
    size_t n = 1;
    for (int axis = 0; axis < 3; axis++) {
        bricks->n[axis] = (field->grid.size[axis] + extent[axis] - 1) / extent[axis];
        n *= bricks->n[axis];
    }
    bricks->n_bytes = sizeof *bricks + n * (2 * sizeof *bricks->low + 1);
    bricks->low = mem_large_array(n, sizeof *bricks->low, UINT64_MAX, err);
    bricks->high = bricks->low ? mem_large_array(n, sizeof *bricks->high, UINT64_MAX, err) : NULL;
    bricks->has_gaps = bricks->high ? mem_array(n, 1, UINT64_MAX, err) : NULL;
    struct bricks_job job = { .field = field, .bricks = bricks, .code = marching_rows_code(MARCHING_CUBES_BEST) };
    if (bricks->has_gaps) {
        parallel_run(n_threads > 0 ? n_threads : parallel_cores(), make_layers, &job);
        if (!atomic_load(&job.is_out_of_memory))
            return bricks;
        error_set(err, ERROR_MEMORY, "no memory for the bricks of a field");
    }
    iso_bricks_destroy(bricks);
    return NULL;
}

void iso_bricks_destroy(struct iso_bricks *bricks)
{
    if (!bricks)
        return;
    free(bricks->low);
    free(bricks->high);
    free(bricks->has_gaps);
    free(bricks);
}
