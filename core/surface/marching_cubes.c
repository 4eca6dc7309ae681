/* Marching cubes on bit rows.
 *
 * The part of the mask that holds anything is first copied into a grid of its own with one empty layer around it, so nothing
 * below has to think of borders. Its rows are cut so that a 64-bit word holds 63 cells: the 64th bit repeats the first voxel of
 * the next word, and a word needs no neighbour. A row "owns" the crossed grid edges that start at its voxels: along x within it,
 * along y to the next row, along z to the same row of the next slice; each crossed edge is one vertex.
 *
 *   1. count, row by row, vertices along x, y, z and triangles     2. running totals: where each row's part begins
 *   3. every row writes its vertices and the triangles of its cells where they belong
 *
 * Walking a row of cells from left to right meets the crossed edges around it in the order in which their rows numbered them (a
 * crossed edge makes every cell around it active), so eight running numbers give the vertex of any edge: no table of vertices. */
#include "core/surface/marching_cubes.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/cube_cases.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

enum { CELLS_A_WORD = 63, MAX_THREADS = 64, MAX_MASK_WORDS = VOLUME_MAX_SIDE / 64 };
#define LOW_63 (~(uint64_t)0 >> 1)

/* Of one row. First how many, then (after the running totals) the number of its first. */
struct row {
    uint32_t x, y, z; /* vertices on edges along x, y, z, numbered in this order */
    uint32_t triangles;
};

struct extent {
    bool is_empty;
    uint32_t low[3], high[3]; /* inclusive */
};

struct job {
    const struct mask *mask;
    const struct cube_case *cases;
    enum marching_cubes_code code;
    struct extent extents[MAX_THREADS]; /* one a part */
    /* the working grid */
    int32_t start[3];   /* mask index of its voxel 0; -1 when an empty layer was put in front */
    uint32_t size[3];   /* voxels */
    uint32_t words;     /* in a row */
    uint64_t *bits;     /* [z][y][words]; owns the rows' memory too */
    struct row *rows;   /* [z][y], and one more at the end */
    struct mesh *mesh;
};

static void range_of(uint32_t n, int part, int n_parts, uint32_t *from, uint32_t *end)
{
    *from = (uint32_t)((uint64_t)n * (uint64_t)part / (uint64_t)n_parts);
    *end = (uint32_t)((uint64_t)n * (uint64_t)(part + 1) / (uint64_t)n_parts);
}

/* ---- the part of the mask that holds anything --------------------------------------------------------------------------- */

static void measure_extent(void *context, int part, int n_parts)
{
    struct job *job = context;
    const struct mask *mask = job->mask;
    struct extent extent = { .is_empty = true };
    uint64_t columns[MAX_MASK_WORDS] = { 0 };
    uint32_t k, end;
    for (range_of(mask->size[2], part, n_parts, &k, &end); k < end; k++)
        for (uint32_t j = 0; j < mask->size[1]; j++) {
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

static void place_working_grid(struct job *job, const struct extent *extent, bool close_at_border)
{
    for (int axis = 0; axis < 3; axis++) {
        uint32_t last = job->mask->size[axis] - 1;
        bool has_before = close_at_border || extent->low[axis] > 0, has_after = close_at_border || extent->high[axis] < last;
        job->start[axis] = (int32_t)extent->low[axis] - has_before;
        job->size[axis] = extent->high[axis] - extent->low[axis] + 1 + has_before + has_after;
    }
    uint32_t cells = job->size[0] - 1;
    job->words = cells ? (cells + CELLS_A_WORD - 1) / CELLS_A_WORD : 1;
}

/* 64 bits of a row from any bit on, -1 included; what lies beyond the row is 0. */
static inline uint64_t bits_from(const uint64_t *row, uint32_t words, int32_t at)
{
    if (at < 0)
        return row[0] << -at;
    uint32_t word = (uint32_t)at / 64, shift = (uint32_t)at % 64;
    uint64_t low = word < words ? row[word] >> shift : 0;
    return shift && word + 1 < words ? low | row[word + 1] << (64 - shift) : low;
}

static void copy_rows(void *context, int part, int n_parts)
{
    struct job *job = context;
    const struct mask *mask = job->mask;
    uint32_t z, end;
    for (range_of(job->size[2], part, n_parts, &z, &end); z < end; z++)
        for (uint32_t y = 0; y < job->size[1]; y++) {
            int32_t j = job->start[1] + (int32_t)y, k = job->start[2] + (int32_t)z;
            uint64_t *to = job->bits + ((size_t)z * job->size[1] + y) * job->words;
            if (j < 0 || k < 0 || (uint32_t)j >= mask->size[1] || (uint32_t)k >= mask->size[2]) {
                memset(to, 0, job->words * sizeof *to); /* an empty row in front or behind */
                continue;
            }
            const uint64_t *from = mask->bits + ((size_t)k * mask->size[1] + (uint32_t)j) * mask->words;
            for (uint32_t w = 0; w < job->words; w++)
                to[w] = bits_from(from, mask->words, job->start[0] + (int32_t)(CELLS_A_WORD * w));
        }
}

/* ---- rows --------------------------------------------------------------------------------------------------------------- */

/* The two passes are inlined into a version for any processor and one for processors with AVX2 and bit counting, see below. */
#define INLINED static inline __attribute__((always_inline))

/* A row with its neighbours; at the end of an axis the row stands in for the missing neighbour, so nothing is crossed there. */
struct around {
    const uint64_t *here, *next_y, *next_z, *next_yz;
    bool has_cells;
};

INLINED struct around rows_around(const struct job *job, uint32_t y, uint32_t z)
{
    const uint64_t *here = job->bits + ((size_t)z * job->size[1] + y) * job->words;
    bool has_y = y + 1 < job->size[1], has_z = z + 1 < job->size[2];
    size_t to_y = has_y ? job->words : 0, to_z = has_z ? (size_t)job->words * job->size[1] : 0;
    return (struct around){ here, here + to_y, here + to_z, here + to_y + to_z, has_y && has_z && job->size[0] > 1 };
}

/* What one word of a row owns. */
struct crossings {
    uint64_t x, y, z; /* crossed edges, by the voxel they start at */
    uint64_t active;  /* cells that hold triangles */
};

INLINED struct crossings find_crossings(const struct job *job, const struct around *rows, uint32_t w)
{
    bool is_last = w + 1 == job->words;
    uint32_t n_cells = is_last ? job->size[0] - 1 - CELLS_A_WORD * w : CELLS_A_WORD;
    uint64_t cells = n_cells ? LOW_63 >> (CELLS_A_WORD - n_cells) : 0;
    uint64_t voxels = is_last ? ~(uint64_t)0 : LOW_63; /* elsewhere the 64th belongs to the next word */
    uint64_t here = rows->here[w], next_y = rows->next_y[w], next_z = rows->next_z[w], next_yz = rows->next_yz[w];
    uint64_t any = here | next_y | next_z | next_yz, all = here & next_y & next_z & next_yz;
    return (struct crossings){
        .x = (here ^ here >> 1) & cells,
        .y = (here ^ next_y) & voxels,
        .z = (here ^ next_z) & voxels,
        .active = rows->has_cells ? (any | any >> 1) & ~(all & all >> 1) & cells : 0,
    };
}

/* Nothing crossed and no cell active: by far the most words. */
INLINED bool is_uniform(const struct around *rows, uint32_t w)
{
    uint64_t here = rows->here[w], next_y = rows->next_y[w], next_z = rows->next_z[w], next_yz = rows->next_yz[w];
    return !(here | next_y | next_z | next_yz) || !~(here & next_y & next_z & next_yz);
}

INLINED uint32_t case_at(const struct around *rows, uint32_t w, int bit)
{
    return (uint32_t)((rows->here[w] >> bit & 3) | (rows->next_y[w] >> bit & 3) << 2 | (rows->next_z[w] >> bit & 3) << 4 |
                      (rows->next_yz[w] >> bit & 3) << 6);
}

INLINED void count_slices(struct job *job, uint32_t from, uint32_t end)
{
    for (uint32_t z = from; z < end; z++)
        for (uint32_t y = 0; y < job->size[1]; y++) {
            struct around rows = rows_around(job, y, z);
            struct row sum = { 0 };
            for (uint32_t w = 0; w < job->words; w++) {
                if (is_uniform(&rows, w))
                    continue;
                struct crossings found = find_crossings(job, &rows, w);
                sum.x += (uint32_t)__builtin_popcountll(found.x);
                sum.y += (uint32_t)__builtin_popcountll(found.y);
                sum.z += (uint32_t)__builtin_popcountll(found.z);
                for (uint64_t cells = found.active; cells; cells &= cells - 1)
                    sum.triangles += job->cases[case_at(&rows, w, __builtin_ctzll(cells))].n_triangles;
            }
            job->rows[(size_t)z * job->size[1] + y] = sum;
        }
}

INLINED float *put(float *at, struct vec3 p)
{
    at[0] = (float)p.x;
    at[1] = (float)p.y;
    at[2] = (float)p.z;
    return at + 3;
}

INLINED void write_vertices(const struct job *job, const struct row *row, const struct around *rows, uint32_t y, uint32_t z)
{
    const struct affine *map = &job->mask->lps_mm_from_ijk;
    struct vec3 step = map->columns[0];
    struct vec3 base = affine_point(map, vec3(job->start[0], (double)job->start[1] + y, (double)job->start[2] + z));
    struct vec3 base_x = vec3_add(base, vec3_scale(step, 0.5));
    struct vec3 base_y = vec3_add(base, vec3_scale(map->columns[1], 0.5));
    struct vec3 base_z = vec3_add(base, vec3_scale(map->columns[2], 0.5));
    float *at_x = job->mesh->positions_lps_mm + 3 * (size_t)row->x;
    float *at_y = job->mesh->positions_lps_mm + 3 * (size_t)row->y;
    float *at_z = job->mesh->positions_lps_mm + 3 * (size_t)row->z;
    for (uint32_t w = 0; w < job->words; w++) {
        if (is_uniform(rows, w))
            continue;
        struct crossings found = find_crossings(job, rows, w);
        double x = CELLS_A_WORD * (double)w;
        for (uint64_t bits = found.x; bits; bits &= bits - 1)
            at_x = put(at_x, vec3_add(base_x, vec3_scale(step, x + __builtin_ctzll(bits))));
        for (uint64_t bits = found.y; bits; bits &= bits - 1)
            at_y = put(at_y, vec3_add(base_y, vec3_scale(step, x + __builtin_ctzll(bits))));
        for (uint64_t bits = found.z; bits; bits &= bits - 1)
            at_z = put(at_z, vec3_add(base_z, vec3_scale(step, x + __builtin_ctzll(bits))));
    }
}

/* The vertex that each edge of a row's first cell has, if it is crossed: edges 0..7 as in cube_cases.h. */
#define FIRST_VERTICES(job, row)                                                                                                 \
    { (row)->x, (row)[1].x, (row)[(job)->size[1]].x, (row)[(job)->size[1] + 1].x, (row)->y, (row)[(job)->size[1]].y, (row)->z,  \
      (row)[1].z }

static void write_triangles(const struct job *job, const struct row *row, const struct around *rows)
{
    uint32_t vertex[CUBE_EDGES] = FIRST_VERTICES(job, row);
    uint32_t *out = job->mesh->indices + 3 * (size_t)row->triangles;
    for (uint32_t w = 0; w < job->words; w++) {
        if (is_uniform(rows, w))
            continue;
        for (uint64_t cells = find_crossings(job, rows, w).active; cells; cells &= cells - 1) {
            const struct cube_case *cube = &job->cases[case_at(rows, w, __builtin_ctzll(cells))];
            uint32_t following[8];
            for (int e = 0; e < 8; e++)
                following[e] = vertex[e] + cube->is_crossed[e];
            memcpy(vertex + 8, following + 4, 4 * sizeof *vertex); /* the face x = 1 is the next cell's x = 0 */
            for (int corner = 0; corner < 3 * cube->n_triangles; corner++)
                *out++ = vertex[cube->edges[corner]];
            memcpy(vertex, following, sizeof following);
        }
    }
}

#if defined(__x86_64__)
#define FAST __attribute__((target("avx2,popcnt,bmi,bmi2")))

/* The same with the running numbers in one register; all five triangles that a cell could have are written, the next cell's over
 * what is too much. `end` is where this thread's triangles end: the last few must not reach beyond. */
FAST static void write_triangles_avx2(const struct job *job, const struct row *row, const struct around *rows, const uint32_t *end)
{
    const uint32_t first[8] = FIRST_VERTICES(job, row);
    __m256i vertex = _mm256_loadu_si256((const __m256i *)first);
    uint32_t *out = job->mesh->indices + 3 * (size_t)row->triangles;
    for (uint32_t w = 0; w < job->words; w++) {
        if (is_uniform(rows, w))
            continue;
        for (uint64_t cells = find_crossings(job, rows, w).active; cells; cells &= cells - 1) {
            const struct cube_case *cube = &job->cases[case_at(rows, w, __builtin_ctzll(cells))];
            __m256i crossed = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)cube->is_crossed));
            __m256i following = _mm256_add_epi32(vertex, crossed);
            __m256i far_face = _mm256_permute4x64_epi64(following, 0xee); /* edges 8..11 */
            __m256i triangles[2];
            for (int half = 0; half < 2; half++) {
                __m256i edges = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(cube->edges + 8 * half)));
                __m256i is_far = _mm256_cmpgt_epi32(edges, _mm256_set1_epi32(7));
                triangles[half] = _mm256_blendv_epi8(_mm256_permutevar8x32_epi32(vertex, edges),
                                                     _mm256_permutevar8x32_epi32(far_face, edges), is_far);
            }
            vertex = following;
            if (end - out >= 16) {
                _mm256_storeu_si256((__m256i *)out, triangles[0]);
                _mm256_storeu_si256((__m256i *)(out + 8), triangles[1]);
            } else {
                memcpy(out, triangles, 3 * sizeof *out * cube->n_triangles);
            }
            out += 3 * cube->n_triangles;
        }
    }
}
#endif

INLINED void write_rows(const struct job *job, size_t from, size_t end, bool use_avx2)
{
    const uint32_t *end_of_triangles = job->mesh->indices + 3 * (size_t)job->rows[end].triangles;
    for (size_t at = from; at < end; at++) {
        const struct row *row = &job->rows[at];
        if (row[1].x == row->x && row[1].triangles == row->triangles)
            continue; /* nothing of its own between its beginning and the next row's */
        uint32_t y = (uint32_t)(at % job->size[1]), z = (uint32_t)(at / job->size[1]);
        struct around rows = rows_around(job, y, z);
        write_vertices(job, row, &rows, y, z);
        if (!rows.has_cells || row[1].triangles == row->triangles)
            continue;
#if defined(__x86_64__)
        if (use_avx2) {
            write_triangles_avx2(job, row, &rows, end_of_triangles);
            continue;
        }
#endif
        write_triangles(job, row, &rows);
    }
    (void)use_avx2;
    (void)end_of_triangles;
}

#if defined(__x86_64__)
FAST static void count_slices_fast(struct job *job, uint32_t from, uint32_t end) { count_slices(job, from, end); }
FAST static void write_rows_fast(const struct job *job, size_t from, size_t end) { write_rows(job, from, end, true); }
static bool has_fast(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2");
}
#else
static void count_slices_fast(struct job *job, uint32_t from, uint32_t end) { count_slices(job, from, end); }
static void write_rows_fast(const struct job *job, size_t from, size_t end) { write_rows(job, from, end, false); }
static bool has_fast(void) { return false; }
#endif

/* ---- the whole ---------------------------------------------------------------------------------------------------------- */

static void count_part(void *context, int part, int n_parts)
{
    struct job *job = context;
    uint32_t from, end;
    range_of(job->size[2], part, n_parts, &from, &end);
    if (job->code == MARCHING_CUBES_PORTABLE)
        count_slices(job, from, end);
    else
        count_slices_fast(job, from, end);
}

/* First row at or behind this share of the triangles: parts with equal work, however the region lies in the grid. */
static size_t row_at_share(const struct job *job, size_t n_rows, int part, int n_parts)
{
    if (part == n_parts)
        return n_rows;
    uint64_t wanted = (uint64_t)job->rows[n_rows].triangles * (uint64_t)part / (uint64_t)n_parts;
    size_t low = 0, high = part ? n_rows : 0;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (job->rows[middle].triangles < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void write_part(void *context, int part, int n_parts)
{
    const struct job *job = context;
    size_t n_rows = (size_t)job->size[1] * job->size[2];
    size_t from = row_at_share(job, n_rows, part, n_parts), end = row_at_share(job, n_rows, part + 1, n_parts);
    if (job->code == MARCHING_CUBES_PORTABLE)
        write_rows(job, from, end, false);
    else
        write_rows_fast(job, from, end);
}

static bool number_rows(struct job *job, const struct surface_options *options, struct error *err)
{
    size_t n_rows = (size_t)job->size[1] * job->size[2];
    uint64_t vertices = 0, triangles = 0;
    for (size_t at = 0; at <= n_rows; at++) {
        struct row n = job->rows[at];
        job->rows[at] = (struct row){ (uint32_t)vertices, (uint32_t)(vertices + n.x), (uint32_t)(vertices + n.x + n.y),
                                      (uint32_t)triangles };
        vertices += (uint64_t)n.x + n.y + n.z;
        triangles += n.triangles;
    }
    if (triangles > options->max_triangles || triangles > UINT32_MAX || vertices > UINT32_MAX)
        return error_set(err, ERROR_LIMIT, "a surface of %llu triangles: at most %zu are allowed", (unsigned long long)triangles,
                         options->max_triangles < UINT32_MAX ? options->max_triangles : (size_t)UINT32_MAX);
    job->mesh = mesh_create((size_t)vertices, (size_t)triangles, err);
    return job->mesh != NULL;
}

static struct cube_case cases[2][256]; /* [is_mirrored] */
static pthread_once_t cases_once = PTHREAD_ONCE_INIT;

static void make_cases(void)
{
    cube_cases_make(cases[0], false);
    cube_cases_make(cases[1], true);
}

struct mesh *marching_cubes_with(enum marching_cubes_code code, const struct mask *mask, const struct surface_options *options,
                                 struct error *err)
{
    assert(mask->words <= MAX_MASK_WORDS);
    pthread_once(&cases_once, make_cases);
    int n_parts = options->n_threads > 0 ? options->n_threads : parallel_cores();
    n_parts = n_parts < MAX_THREADS ? n_parts : MAX_THREADS;
    struct job job = {
        .mask = mask,
        .cases = cases[affine_determinant(&mask->lps_mm_from_ijk) < 0],
        .code = has_fast() ? code : MARCHING_CUBES_PORTABLE,
    };
    parallel_run(n_parts, measure_extent, &job);
    struct extent extent = join_extents(job.extents, n_parts);
    if (extent.is_empty) {
        error_set(err, ERROR_RANGE, "a surface of a mask of %u x %u x %u voxels: none of them is inside", mask->size[0],
                  mask->size[1], mask->size[2]);
        return NULL;
    }
    place_working_grid(&job, &extent, options->close_at_border);
    size_t n_rows = (size_t)job.size[1] * job.size[2];
    /* one array for both: fewer and larger pages */
    job.bits = mem_large_array(n_rows + 1, job.words * sizeof *job.bits + sizeof *job.rows, UINT64_MAX, err);
    if (job.bits) {
        job.rows = (struct row *)(job.bits + n_rows * job.words);
        job.rows[n_rows] = (struct row){ 0 };
        parallel_run(n_parts, copy_rows, &job);
        parallel_run(n_parts, count_part, &job);
        if (number_rows(&job, options, err)) {
            parallel_run(n_parts, write_part, &job);
            mesh_measure_bounds(job.mesh);
        }
    }
    free(job.bits);
    return job.mesh;
}

struct mesh *surface_marching_cubes(const struct mask *mask, const struct surface_options *options, struct error *err)
{
    return marching_cubes_with(MARCHING_CUBES_BEST, mask, options, err);
}
