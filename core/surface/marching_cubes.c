/* Marching cubes on bit rows.
 *
 * The bounding box of the mask is first copied into a working grid with one empty layer around it, so that nothing
 * below handles borders. Rows are cut so that a 64-bit word holds 63 cells: its 64th bit repeats the first voxel of the
 * next word, and no word needs its neighbour. A row "owns" the crossed grid edges that start at its voxels: along x
 * within the row, along y to the next row, along z to the same row of the next slice. Each crossed edge is one vertex.
 *
 *   1. count vertices along x, y, z and triangles, row by row
 *   2. running totals: where each row's part begins
 *   3. every row writes its vertices and the triangles of its cells to their final place
 *
 * Going along a row of cells meets the crossed edges around it in the sequence in which their rows numbered them (a
 * crossed edge makes every cell around it active). So eight running numbers give the vertex of any edge, without a
 * table of vertices. */
#include "core/surface/marching_cubes.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/cube_cases.h"
#include "core/surface/marching_rows.h"
#include "core/surface/marching_triangles.h"

enum { MAX_THREADS = 64 };

struct extent {
    bool is_empty;
    uint32_t low[3], high[3]; /* inclusive */
};

struct marching_job {
    struct marching_rows grid; /* the working grid, its rows and the mesh */
    const struct mask *mask;
    enum marching_cubes_code code;
    struct extent extents[MAX_THREADS]; /* one per part */
    struct marching_graph *graph;       /* NULL: not wanted */
};

/* ---- the working grid ------------------------------------------------------------------------------------------- */

static void measure_extent(void *context, int part, int n_parts)
{
    struct marching_job *job = context;
    const struct mask *mask = job->mask;
    struct extent extent = { .is_empty = true };
    uint64_t columns[MAX_MASK_WORDS] = { 0 };
    uint32_t k, end;
    marching_range(mask->end_k - mask->low_k, part, n_parts, &k, &end);
    for (k += mask->low_k, end += mask->low_k; k < end; k++)
        for (uint32_t j = mask->low_j; j < mask->end_j; j++) {
            const uint64_t *row = mask->bits + ((size_t)k * mask->size[1] + j) * mask->words;
            uint64_t any = 0;
            for (uint32_t w = 0; w < mask->words; w++) {
                columns[w] |= row[w];
                any |= row[w];
            }
            if (!any)
                continue;
            if (extent.is_empty)
                extent = (struct extent){ false, { 0, j, k }, { 0, j, k } };
            extent.low[1] = j < extent.low[1] ? j : extent.low[1];
            extent.high[1] = j > extent.high[1] ? j : extent.high[1];
            extent.high[2] = k;
        }
    extent.low[0] = UINT32_MAX;
    for (uint32_t w = 0; w < mask->words; w++)
        if (columns[w]) {
            uint32_t first = 64 * w + (uint32_t)__builtin_ctzll(columns[w]);
            extent.low[0] = first < extent.low[0] ? first : extent.low[0];
            extent.high[0] = 64 * w + 63 - (uint32_t)__builtin_clzll(columns[w]);
        }
    job->extents[part] = extent;
}

static struct extent join_extents(const struct extent *extents, int n)
{
    struct extent all = { .is_empty = true };
    for (int i = 0; i < n; i++) {
        const struct extent *one = &extents[i];
        if (one->is_empty)
            continue;
        if (all.is_empty)
            all = *one;
        for (int axis = 0; axis < 3; axis++) {
            all.low[axis] = one->low[axis] < all.low[axis] ? one->low[axis] : all.low[axis];
            all.high[axis] = one->high[axis] > all.high[axis] ? one->high[axis] : all.high[axis];
        }
    }
    return all;
}

static void place_working_grid(struct marching_job *job, const struct extent *extent, bool close_at_border)
{
    for (int axis = 0; axis < 3; axis++) {
        uint32_t last = job->mask->size[axis] - 1;
        bool has_before = close_at_border || extent->low[axis] > 0,
             has_after = close_at_border || extent->high[axis] < last;
        job->grid.start[axis] = (int32_t)extent->low[axis] - has_before;
        job->grid.size[axis] = extent->high[axis] - extent->low[axis] + 1 + has_before + has_after;
    }
    uint32_t cells = job->grid.size[0] - 1;
    job->grid.words = cells ? (cells + CELLS_A_WORD - 1) / CELLS_A_WORD : 1;
}

static void copy_rows(void *context, int part, int n_parts)
{
    struct marching_job *job = context;
    const struct mask *mask = job->mask;
    uint32_t z, end;
    for (marching_range(job->grid.size[2], part, n_parts, &z, &end); z < end; z++)
        for (uint32_t y = 0; y < job->grid.size[1]; y++) {
            int32_t j = job->grid.start[1] + (int32_t)y, k = job->grid.start[2] + (int32_t)z;
            uint64_t *to = job->grid.bits + ((size_t)z * job->grid.size[1] + y) * job->grid.words;
            if (j < 0 || k < 0 || (uint32_t)j >= mask->size[1] || (uint32_t)k >= mask->size[2]) {
                memset(to, 0, job->grid.words * sizeof *to); /* an empty row before or after */
                continue;
            }
            const uint64_t *from = mask->bits + ((size_t)k * mask->size[1] + (uint32_t)j) * mask->words;
            for (uint32_t w = 0; w < job->grid.words; w++)
                to[w] = bits_from(from, mask->words, job->grid.start[0] + (int32_t)(CELLS_A_WORD * w));
        }
}

/* ---- counting and writing --------------------------------------------------------------------------------------- */

INLINED float *put(float *at, struct vec3 p)
{
    at[0] = (float)p.x;
    at[1] = (float)p.y;
    at[2] = (float)p.z;
    return at + 3;
}

INLINED void write_vertices(const struct marching_rows *grid, const struct row *row, const struct around *rows,
                            uint32_t y, uint32_t z)
{
    const struct affine *map = &grid->lps_mm_from_ijk;
    struct vec3 step = map->columns[0];
    struct vec3 base = affine_point(map, vec3(grid->start[0], (double)grid->start[1] + y, (double)grid->start[2] + z));
    struct vec3 base_x = vec3_add(base, vec3_scale(step, 0.5));
    struct vec3 base_y = vec3_add(base, vec3_scale(map->columns[1], 0.5));
    struct vec3 base_z = vec3_add(base, vec3_scale(map->columns[2], 0.5));
    float *at_x = grid->mesh->positions_lps_mm + 3 * (size_t)row->x;
    float *at_y = grid->mesh->positions_lps_mm + 3 * (size_t)row->y;
    float *at_z = grid->mesh->positions_lps_mm + 3 * (size_t)row->z;
    for (uint32_t w = 0; w < grid->words; w++) {
        if (is_uniform(rows, w))
            continue;
        struct crossings found = find_crossings(grid, rows, w);
        double x = CELLS_A_WORD * (double)w;
        for (uint64_t bits = found.x; bits; bits &= bits - 1)
            at_x = put(at_x, vec3_add(base_x, vec3_scale(step, x + __builtin_ctzll(bits))));
        for (uint64_t bits = found.y; bits; bits &= bits - 1)
            at_y = put(at_y, vec3_add(base_y, vec3_scale(step, x + __builtin_ctzll(bits))));
        for (uint64_t bits = found.z; bits; bits &= bits - 1)
            at_z = put(at_z, vec3_add(base_z, vec3_scale(step, x + __builtin_ctzll(bits))));
    }
}

INLINED void write_rows(const struct marching_rows *grid, size_t from, size_t end, bool has_positions, bool use_avx2)
{
    const uint32_t *end_of_triangles = grid->mesh->indices + 3 * (size_t)grid->rows[end].triangles;
    for (size_t at = from; at < end; at++) {
        const struct row *row = &grid->rows[at];
        if (row[1].x == row->x && row[1].triangles == row->triangles)
            continue; /* the row owns nothing */
        uint32_t y = (uint32_t)(at % grid->size[1]), z = (uint32_t)(at / grid->size[1]);
        struct around rows = rows_around(grid, y, z);
        if (has_positions)
            write_vertices(grid, row, &rows, y, z);
        if (!rows.has_cells || row[1].triangles == row->triangles)
            continue;
#if defined(__x86_64__)
        if (use_avx2) {
            write_triangles_avx2(grid, row, &rows, end_of_triangles);
            continue;
        }
#endif
        write_triangles(grid, row, &rows);
    }
    (void)use_avx2;
    (void)end_of_triangles;
}

#if defined(__x86_64__)
FAST static void write_rows_fast(const struct marching_rows *grid, size_t from, size_t end, bool has_positions)
{
    write_rows(grid, from, end, has_positions, true);
}
#else
static void write_rows_fast(const struct marching_rows *grid, size_t from, size_t end, bool has_positions)
{
    write_rows(grid, from, end, has_positions, false);
}
#endif

/* ---- marching_cubes_run ----------------------------------------------------------------------------------------- */

static void count_part(void *context, int part, int n_parts)
{
    struct marching_job *job = context;
    uint32_t from, end;
    marching_range(job->grid.size[2], part, n_parts, &from, &end);
    marching_rows_count(job->code, &job->grid, from, end);
}

static void write_part(void *context, int part, int n_parts)
{
    const struct marching_job *job = context;
    size_t n_rows = (size_t)job->grid.size[1] * job->grid.size[2];
    size_t from = marching_rows_at_share(&job->grid, n_rows, part, n_parts),
           end = marching_rows_at_share(&job->grid, n_rows, part + 1, n_parts);
    bool has_positions = !job->graph || !job->graph->has_no_positions;
    if (job->code == MARCHING_CUBES_PORTABLE)
        write_rows(&job->grid, from, end, has_positions, false);
    else
        write_rows_fast(&job->grid, from, end, has_positions);
    if (job->graph)
        marching_graph_write(job->code, &job->grid, job->graph, from, end);
}

static bool make_graph(const struct marching_job *job, bool is_closed, struct marching_graph *graph, struct error *err)
{
    size_t n = job->grid.mesh->n_vertices;
    graph->points = mem_large_array(n, sizeof *graph->points, UINT64_MAX, err);
    if (graph->points)
        graph->links = mem_large_array(n, sizeof *graph->links, UINT64_MAX, err);
    memcpy(graph->start, job->grid.start, sizeof graph->start);
    graph->lps_mm_from_at = job->mask->lps_mm_from_ijk;
    graph->lps_mm_from_at.origin =
        affine_point(&job->mask->lps_mm_from_ijk, vec3(job->grid.start[0], job->grid.start[1], job->grid.start[2]));
    for (size_t v = 0; graph->links && !is_closed && v < n; v++)
        for (int slot = 0; slot < 4; slot++)
            graph->links[v][slot] = (uint32_t)v;
    return graph->points && graph->links;
}

void marching_graph_finish(struct marching_graph *graph)
{
    free(graph->points);
    free(graph->links);
    *graph = (struct marching_graph){ 0 };
}

struct mesh *marching_cubes_run(enum marching_cubes_code code, const struct mask *mask,
                                const struct surface_options *options, struct marching_graph *graph, struct error *err)
{
    assert(mask->words <= MAX_MASK_WORDS);
    int n_parts = options->n_threads > 0 ? options->n_threads : parallel_cores();
    n_parts = n_parts < MAX_THREADS ? n_parts : MAX_THREADS;
    struct marching_job job = {
        .mask = mask,
        .grid = { .cases = marching_rows_cases(&mask->lps_mm_from_ijk), .lps_mm_from_ijk = mask->lps_mm_from_ijk },
        .code = marching_rows_code(code),
        .graph = graph,
    };
    struct marching_rows *grid = &job.grid;
    parallel_run(n_parts, measure_extent, &job);
    struct extent extent = join_extents(job.extents, n_parts);
    if (extent.is_empty) {
        error_set(err, ERROR_RANGE, "a surface of a mask of %u x %u x %u voxels: none of them is inside", mask->size[0],
                  mask->size[1], mask->size[2]);
        return NULL;
    }
    place_working_grid(&job, &extent, options->close_at_border);
    size_t n_rows = (size_t)grid->size[1] * grid->size[2];
    /* bits and rows in one array: fewer and larger pages */
    grid->bits = mem_large_array(n_rows + 1, grid->words * sizeof *grid->bits + sizeof *grid->rows, UINT64_MAX, err);
    if (grid->bits) {
        grid->rows = (struct row *)(grid->bits + n_rows * grid->words);
        grid->rows[n_rows] = (struct row){ 0 };
        parallel_run(n_parts, copy_rows, &job);
        parallel_run(n_parts, count_part, &job);
        if (marching_rows_number(grid, options, err)) {
            if (graph && !make_graph(&job, options->close_at_border, graph, err)) {
                mesh_unref(grid->mesh);
                grid->mesh = NULL;
                marching_graph_finish(graph);
            } else {
                parallel_run(n_parts, write_part, &job);
                if (!graph || !graph->has_no_positions)
                    mesh_measure_bounds(grid->mesh);
            }
        }
    }
    free(grid->bits);
    return grid->mesh;
}

struct mesh *marching_cubes_with(enum marching_cubes_code code, const struct mask *mask,
                                 const struct surface_options *options, struct error *err)
{
    return marching_cubes_run(code, mask, options, NULL, err);
}

struct mesh *surface_marching_cubes(const struct mask *mask, const struct surface_options *options, struct error *err)
{
    return marching_cubes_run(MARCHING_CUBES_BEST, mask, options, NULL, err);
}
