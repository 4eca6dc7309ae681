/* The 8-cell algorithm on bit rows: triangles between the centres of inside voxels.
 *
 * A cell is named by its lowest corner. Cells run from -1, so that a region at the border is closed, to the last voxel.
 * The case of a cell gives its triangles and the corners they use; a voxel used by any cell is a vertex. Vertices are
 * numbered in voxel sequence.
 *
 *   1. mark the used voxels, one slice of voxels at a time, and count the triangles of every row of cells
 *   2. running totals: the first vertex and triangle of each row
 *   3. every row writes its own; the number of a vertex is the row's first plus the marks before it in the row
 *
 * Threads take slices as they become free; contents and position of a slice do not depend on the thread. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/bit_rows.h"
#include "core/surface/corner_cases.h"
#include "core/surface/surface.h"

enum { MAX_THREADS = 64 };

struct eight_cell_job {
    const struct mask *mask;
    const struct corner_case *cases;
    bool close_at_border;
    uint64_t *used;           /* in the layout of the mask's bits: voxels that are vertices */
    uint32_t *first_vertex;   /* [k][j], and one more at the end; counts of the rows, then running totals */
    uint32_t *first_triangle; /* [z][y] of cells, z and y from -1 on, and one more at the end */
    struct mesh *mesh;
    atomic_uint next; /* next slice to take */
};

/* The four rows of voxels around a row of cells, at (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1); NULL beyond the
 * grid. */
struct rows {
    const uint64_t *bits[4];
};

static bool is_in(const struct mask *mask, int64_t j, int64_t k)
{
    return j >= 0 && k >= 0 && j < mask->size[1] && k < mask->size[2];
}

static size_t row_number(const struct mask *mask, int64_t j, int64_t k)
{
    return (size_t)k * mask->size[1] + (size_t)j;
}

static struct rows rows_at(const struct mask *mask, int64_t y, int64_t z)
{
    struct rows rows = { { NULL } };
    for (int r = 0; r < 4; r++)
        if (is_in(mask, y + (r & 1), z + (r >> 1)))
            rows.bits[r] = mask->bits + row_number(mask, y + (r & 1), z + (r >> 1)) * mask->words;
    return rows;
}

static inline uint64_t word_of(const uint64_t *row, int64_t w, uint32_t words)
{
    return row && w >= 0 && w < words ? row[w] : 0;
}

/* 64 cells of a row from x = 64 w on: the voxels at x and at x + 1 of each of its four rows, and the cells that may
 * have triangles. Word -1 holds one cell, in its last bit. */
struct cells {
    uint64_t low[4], high[4];
    uint64_t active;
};

static inline struct cells cells_at(const struct eight_cell_job *job, const struct rows *rows, int64_t w)
{
    uint32_t words = job->mask->words;
    struct cells cells = { .active = 0 };
    uint64_t any = 0, all = ~(uint64_t)0;
    for (int r = 0; r < 4; r++) {
        uint64_t low = word_of(rows->bits[r], w, words);
        cells.low[r] = low;
        cells.high[r] = low >> 1 | word_of(rows->bits[r], w + 1, words) << 63;
        any |= cells.low[r] | cells.high[r];
        all &= cells.low[r] & cells.high[r];
    }
    cells.active = any & ~all;
    if (!job->close_at_border && w == (job->mask->size[0] - 1) / 64)
        cells.active &=
            ((uint64_t)1 << (job->mask->size[0] - 1) % 64) - 1; /* without the cells at or beyond the last voxel */
    return cells;
}

static inline const struct corner_case *case_of(const struct eight_cell_job *job, const struct cells *cells, int bit)
{
    unsigned inside = 0;
    for (unsigned r = 0; r < 4; r++)
        inside |= (unsigned)(cells->low[r] >> bit & 1) << 2 * r | (unsigned)(cells->high[r] >> bit & 1) << (2 * r + 1);
    return &job->cases[inside];
}

/* Returns true if there are cells at (y, z): all around a closed grid, else only between voxels. */
static bool has_cells(const struct eight_cell_job *job, int64_t y, int64_t z)
{
    return job->close_at_border || (is_in(job->mask, y, z) && is_in(job->mask, y + 1, z + 1));
}

static int64_t first_word(const struct eight_cell_job *job)
{
    return job->close_at_border ? -1 : 0;
}

/* ---- marking and counting --------------------------------------------------------------------------------------- */

/* Marks voxel x for bit 0 of pair, voxel x + 1 for bit 1. */
static inline void mark(uint64_t *row, int64_t x, unsigned pair)
{
    if (pair & 1)
        row[x / 64] |= (uint64_t)1 << x % 64;
    if (pair & 2)
        row[(x + 1) / 64] |= (uint64_t)1 << (x + 1) % 64;
}

/* Marks the voxels that a row of cells uses in its lower (side 0) or upper slice; returns its number of triangles. */
static uint32_t mark_row(struct eight_cell_job *job, int64_t y, int64_t z, int side)
{
    const struct mask *mask = job->mask;
    struct rows rows = rows_at(mask, y, z);
    uint64_t *marked[2] = { NULL, NULL };
    for (int step = 0; step < 2; step++)
        if (is_in(mask, y + step, z + side))
            marked[step] = job->used + row_number(mask, y + step, z + side) * mask->words;
    uint32_t n = 0;
    for (int64_t w = first_word(job); w < mask->words; w++) {
        struct cells cells = cells_at(job, &rows, w);
        for (uint64_t left = cells.active; left; left &= left - 1) {
            int bit = __builtin_ctzll(left);
            const struct corner_case *cube = case_of(job, &cells, bit);
            unsigned used = cube->used >> 4 * side & 15u;
            n += cube->n_triangles;
            for (int step = 0; used && step < 2; step++)
                if (used >> 2 * step & 3) /* only inside corners are used, so the row exists */
                    mark(marked[step], 64 * w + bit, used >> 2 * step & 3);
        }
    }
    return n;
}

static size_t cell_row(const struct mask *mask, int64_t y, int64_t z)
{
    return (size_t)(z + 1) * (mask->size[1] + 1) + (size_t)(y + 1);
}

/* A thread marks voxels of one slice at a time, from the cells below and above it; it counts the triangles of the cells
 * above. */
static void count_part(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct eight_cell_job *job = context;
    const struct mask *mask = job->mask;
    for (int64_t z; (z = (int64_t)atomic_fetch_add(&job->next, 1) - 1) < mask->size[2];) {
        for (int64_t y = -1; y < mask->size[1]; y++) {
            if (z >= 0 && has_cells(job, y, z - 1))
                (void)mark_row(job, y, z - 1, 1);
            job->first_triangle[cell_row(mask, y, z)] = has_cells(job, y, z) ? mark_row(job, y, z, 0) : 0;
        }
        for (int64_t j = 0; z >= 0 && j < mask->size[1]; j++) {
            const uint64_t *row = job->used + row_number(mask, j, z) * mask->words;
            uint32_t n = 0;
            for (uint32_t w = 0; w < mask->words; w++)
                n += (uint32_t)__builtin_popcountll(row[w]);
            job->first_vertex[row_number(mask, j, z)] = n;
        }
    }
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static void write_vertices(const struct eight_cell_job *job, int64_t j, int64_t k)
{
    const struct mask *mask = job->mask;
    size_t row = row_number(mask, j, k);
    row_write_vertices(job->used + row * mask->words, mask->words, &mask->lps_mm_from_ijk,
                       vec3(0, (double)j, (double)k), job->mesh->positions_lps_mm + 3 * (size_t)job->first_vertex[row]);
}

static void write_triangles(const struct eight_cell_job *job, int64_t y, int64_t z)
{
    const struct mask *mask = job->mask;
    struct rows rows = rows_at(mask, y, z);
    const uint64_t *used[4] = { NULL };
    uint32_t number[4] = { 0 }; /* number of the first vertex of the word, in each row */
    for (int r = 0; r < 4; r++)
        if (rows.bits[r]) {
            size_t row = row_number(mask, y + (r & 1), z + (r >> 1));
            used[r] = job->used + row * mask->words;
            number[r] = job->first_vertex[row];
        }
    uint32_t *out = job->mesh->indices + 3 * (size_t)job->first_triangle[cell_row(mask, y, z)];
    for (int64_t w = first_word(job); w < mask->words; w++) {
        struct cells cells = cells_at(job, &rows, w);
        for (uint64_t left = cells.active; left; left &= left - 1) {
            int bit = __builtin_ctzll(left);
            const struct corner_case *cube = case_of(job, &cells, bit);
            uint32_t vertex[8];
            if (!cube->n_triangles)
                continue;
            for (int r = 0; r < 4; r++) {
                uint64_t marks = word_of(used[r], w, mask->words);
                vertex[2 * r] = number[r] + (uint32_t)__builtin_popcountll(marks & (((uint64_t)1 << bit) - 1));
                vertex[2 * r + 1] = vertex[2 * r] + (uint32_t)(marks >> bit & 1);
            }
            for (int corner = 0; corner < 3 * cube->n_triangles; corner++)
                *out++ = vertex[cube->corners[corner]];
        }
        for (int r = 0; r < 4; r++)
            number[r] += (uint32_t)__builtin_popcountll(word_of(used[r], w, mask->words));
    }
}

static void write_part(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct eight_cell_job *job = context;
    const struct mask *mask = job->mask;
    for (int64_t z; (z = (int64_t)atomic_fetch_add(&job->next, 1) - 1) < mask->size[2];)
        for (int64_t y = -1; y < mask->size[1]; y++) {
            size_t cells = cell_row(mask, y, z);
            if (y >= 0 && z >= 0)
                write_vertices(job, y, z);
            if (job->first_triangle[cells + 1] > job->first_triangle[cells])
                write_triangles(job, y, z);
        }
}

/* ---- surface_eight_cell ----------------------------------------------------------------------------------------- */

static struct corner_case cases[2][256]; /* [is_mirrored] */
static pthread_once_t cases_once = PTHREAD_ONCE_INIT;

static void make_cases(void)
{
    corner_cases_make(cases[0], false);
    corner_cases_make(cases[1], true);
}

static bool extract(struct eight_cell_job *job, const struct surface_options *options, int n_threads, struct error *err)
{
    const uint32_t *size = job->mask->size;
    size_t n_rows = (size_t)size[1] * size[2], n_cell_rows = ((size_t)size[1] + 1) * ((size_t)size[2] + 1);
    job->used = mem_array(n_rows, job->mask->words * sizeof *job->used, UINT64_MAX, err);
    job->first_vertex = job->used ? mem_array(n_rows + 1, sizeof *job->first_vertex, UINT64_MAX, err) : NULL;
    job->first_triangle =
        job->first_vertex ? mem_array(n_cell_rows + 1, sizeof *job->first_triangle, UINT64_MAX, err) : NULL;
    if (!job->first_triangle)
        return false;
    atomic_store(&job->next, 0);
    parallel_run(n_threads, count_part, job);
    uint64_t vertices = rows_number(job->first_vertex, n_rows),
             triangles = rows_number(job->first_triangle, n_cell_rows);
    if (triangles > options->max_triangles || triangles > UINT32_MAX || vertices > UINT32_MAX)
        return error_set(err, ERROR_LIMIT, "a surface of %llu triangles: at most %zu are allowed",
                         (unsigned long long)triangles,
                         options->max_triangles < UINT32_MAX ? options->max_triangles : (size_t)UINT32_MAX);
    job->mesh = mesh_create((size_t)vertices, (size_t)triangles, err);
    if (!job->mesh)
        return false;
    atomic_store(&job->next, 0);
    parallel_run(n_threads, write_part, job);
    mesh_measure_bounds(job->mesh);
    return true;
}

struct mesh *surface_eight_cell(const struct mask *mask, const struct surface_options *options, struct error *err)
{
    pthread_once(&cases_once, make_cases);
    if (mask_count(mask) == 0) {
        error_set(err, ERROR_RANGE, "a surface of a mask of %u x %u x %u voxels: none of them is inside", mask->size[0],
                  mask->size[1], mask->size[2]);
        return NULL;
    }
    int n_threads = options->n_threads > 0 ? options->n_threads : parallel_cores();
    struct eight_cell_job job = {
        .mask = mask,
        .cases = cases[affine_determinant(&mask->lps_mm_from_ijk) < 0],
        .close_at_border = options->close_at_border,
    };
    (void)extract(&job, options, n_threads < MAX_THREADS ? n_threads : MAX_THREADS, err);
    free(job.used);
    free(job.first_vertex);
    free(job.first_triangle);
    return job.mesh;
}
