/* Compares the voxels of a field with a level, eight at a time. Bricks through which the surface does not pass are
 * filled without a look at their voxels. */
#include "core/surface/isosurface_bits.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

enum { MAX_BRICKS_A_ROW = VOLUME_MAX_SIDE / ISO_BRICK_I };

/* States of a brick's bits. */
enum brick_state { BRICK_OUTSIDE, BRICK_INSIDE, BRICK_EMPTY, BRICK_MIXED, BRICK_MIXED_WITH_GAPS };

struct bits_job {
    struct iso_bits *bits;
    struct mask *mask; /* to fill instead of the working grid, or NULL */
    atomic_uint next;  /* layer of bricks along k */
    atomic_bool has_gaps;
};

INLINED size_t brick_index(const struct iso_bricks *bricks, uint32_t b_i, uint32_t b_j, uint32_t b_k)
{
    return ((size_t)b_k * bricks->n[1] + b_j) * bricks->n[0] + b_i;
}

static enum brick_state state_of(const struct iso_bits *bits, size_t brick)
{
    const struct iso_bricks *bricks = bits->bricks;
    if (!bricks)
        return BRICK_MIXED_WITH_GAPS;
    float low = bricks->low[brick], high = bricks->high[brick];
    if (low > high)
        return BRICK_EMPTY;
    if (bricks->has_gaps[brick])
        return BRICK_MIXED_WITH_GAPS;
    return high < bits->level ? BRICK_OUTSIDE : low >= bits->level ? BRICK_INSIDE : BRICK_MIXED;
}

static float smallest_inside(double iso)
{
    float level = (float)iso;
    return (double)level < iso ? nextafterf(level, INFINITY) : level;
}

bool iso_bits_place(struct iso_bits *bits, double iso)
{
    static const uint32_t extent[3] = { ISO_BRICK_I, ISO_BRICK_J, ISO_BRICK_K };
    const uint32_t *size = bits->field->grid.size;
    const struct iso_bricks *bricks = bits->bricks;
    uint32_t low[3] = { 0, 0, 0 }, end[3] = { size[0], size[1], size[2] };
    bits->level = smallest_inside(iso);
    if (bricks) {
        uint32_t last[3] = { 0, 0, 0 };
        bool is_found = false;
        low[0] = low[1] = low[2] = UINT32_MAX;
        for (uint32_t at[3] = { 0 }; at[2] < bricks->n[2]; at[2]++)
            for (at[1] = 0; at[1] < bricks->n[1]; at[1]++) {
                size_t row = brick_index(bricks, 0, at[1], at[2]);
                for (at[0] = 0; at[0] < bricks->n[0]; at[0]++) {
                    if (!(bricks->low[row + at[0]] < bits->level && bricks->high[row + at[0]] >= bits->level))
                        continue;
                    is_found = true;
                    for (int axis = 0; axis < 3; axis++) {
                        low[axis] = at[axis] < low[axis] ? at[axis] : low[axis];
                        last[axis] = at[axis] > last[axis] ? at[axis] : last[axis];
                    }
                }
            }
        for (int axis = 0; is_found && axis < 3; axis++) {
            uint32_t after = (last[axis] + 2) * extent[axis];
            low[axis] *= extent[axis];
            end[axis] = after < size[axis] ? after : size[axis];
        }
        if (!is_found)
            return false;
    }
    for (int axis = 0; axis < 3; axis++) {
        bits->grid.start[axis] = (int32_t)low[axis];
        bits->grid.size[axis] = end[axis] - low[axis];
        if (bits->grid.size[axis] < 2)
            return false; /* no cell */
    }
    bits->grid.words = (bits->grid.size[0] - 2) / CELLS_A_WORD + 1;
    return true;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

/* Bit i: voxel i of n <= 8 is inside. */
static inline uint64_t compare_few(const float *row, float level, uint32_t n)
{
    uint64_t inside = 0;
    for (uint32_t i = 0; i < n; i++)
        inside |= (uint64_t)(row[i] >= level) << i;
    return inside;
}

static inline uint64_t valued_few(const float *row, uint32_t n)
{
    uint64_t valued = 0;
    for (uint32_t i = 0; i < n; i++)
        valued |= (uint64_t)(row[i] - row[i] == 0.0f) << i;
    return valued;
}

INLINED uint64_t compare_portable(const float *row, float level)
{
    return compare_few(row, level, ISO_BRICK_I);
}
INLINED uint64_t valued_portable(const float *row)
{
    return valued_few(row, ISO_BRICK_I);
}
#if defined(__x86_64__)
FAST static inline uint64_t compare_avx2(const float *row, float level)
{
    __m256 values = _mm256_loadu_ps(row);
    return (uint64_t)(uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(values, _mm256_set1_ps(level), _CMP_GE_OQ));
}
FAST static inline uint64_t valued_avx2(const float *row)
{
    __m256 values = _mm256_loadu_ps(row), nothing = _mm256_sub_ps(values, values);
    return (uint64_t)(uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(nothing, nothing, _CMP_ORD_Q));
}
#endif

/* Plain bits of a row of n voxels, 8 bits a brick; 0 beyond the row. */
#define MAKE_BITS(COMPARE, VALUED) \
    do { \
        for (uint32_t b = 0; b < n_bricks; b++) { \
            uint32_t left = n - b * ISO_BRICK_I; \
            uint64_t all = left >= ISO_BRICK_I ? 0xff : ((uint64_t)1 << left) - 1; \
            uint64_t in = states[b] == BRICK_INSIDE ? all : 0, has = states[b] == BRICK_EMPTY ? 0 : all; \
            if (states[b] >= BRICK_MIXED) { \
                const float *at = row + b * ISO_BRICK_I; \
                in = all == 0xff ? COMPARE(at, level) : compare_few(at, level, left); \
                if (states[b] == BRICK_MIXED_WITH_GAPS) \
                    has = all == 0xff ? VALUED(at) : valued_few(at, left); \
            } \
            is_gapped |= has != all; \
            uint64_t before_in = b % 8 ? inside[b / 8] : 0, before_has = b % 8 ? valued[b / 8] : 0; \
            inside[b / 8] = before_in | (in & has) << 8 * (b % 8); \
            valued[b / 8] = before_has | has << 8 * (b % 8); \
        } \
    } while (0)
/* True: some voxel has no value. */
#define ROW_ARGUMENTS \
    const float *row, uint32_t n, const uint8_t *states, uint32_t n_bricks, float level, uint64_t *inside, \
        uint64_t *valued
static bool make_bits_portable(ROW_ARGUMENTS)
{
    bool is_gapped = false;
    MAKE_BITS(compare_portable, valued_portable);
    return is_gapped;
}
#if defined(__x86_64__)
FAST static bool make_bits_avx2(ROW_ARGUMENTS)
{
    bool is_gapped = false;
    MAKE_BITS(compare_avx2, valued_avx2);
    return is_gapped;
}
#else
#define make_bits_avx2 make_bits_portable
#endif

/* In words of 63 cells, as the working grid has them. */
static void put_row(const struct marching_rows *grid, uint64_t *to, const uint64_t *plain, uint32_t n_words)
{
    for (uint32_t w = 0; w < grid->words; w++)
        to[w] = bits_from(plain, n_words, (int32_t)(CELLS_A_WORD * w));
}

static void make_rows(struct bits_job *job, const uint8_t *states, uint32_t b_j, uint32_t b_k)
{
    const struct iso_bits *bits = job->bits;
    const struct marching_rows *grid = &bits->grid;
    const uint32_t *size = bits->field->grid.size;
    uint32_t n = grid->size[0], n_bricks = (n + ISO_BRICK_I - 1) / ISO_BRICK_I, n_words = (n + 63) / 64;
    uint32_t end_y = (b_j + 1) * ISO_BRICK_J < grid->size[1] ? (b_j + 1) * ISO_BRICK_J : grid->size[1];
    uint32_t end_z = (b_k + 1) * ISO_BRICK_K < grid->size[2] ? (b_k + 1) * ISO_BRICK_K : grid->size[2];
    bool is_gapped = false;
    for (uint32_t z = b_k * ISO_BRICK_K; z < end_z; z++)
        for (uint32_t y = b_j * ISO_BRICK_J; y < end_y; y++) {
            uint64_t inside[MAX_MASK_WORDS], valued[MAX_MASK_WORDS];
            size_t j = (size_t)grid->start[1] + y, k = (size_t)grid->start[2] + z, at = (size_t)z * grid->size[1] + y;
            const float *row =
                (const float *)bits->field->voxels + (k * size[1] + j) * size[0] + (size_t)grid->start[0];
            is_gapped |= (bits->code == MARCHING_CUBES_PORTABLE
                              ? make_bits_portable
                              : make_bits_avx2)(row, n, states, n_bricks, bits->level, inside, valued);
            if (job->mask) {
                memcpy(job->mask->bits + (k * size[1] + j) * job->mask->words + grid->start[0] / 64, inside,
                       n_words * sizeof *inside);
                continue;
            }
            put_row(grid, grid->bits + at * grid->words, inside, n_words);
            if (bits->valued.bits)
                put_row(grid, bits->valued.bits + at * grid->words, valued, n_words);
        }
    if (is_gapped)
        atomic_store_explicit(&job->has_gaps, true, memory_order_relaxed);
}

/* Asks for the voxels of the mixed bricks of a row: they are far apart in memory, and each would be waited for. */
static void fetch_rows(const struct iso_bits *bits, const uint8_t *states, uint32_t n_bricks, uint32_t b_j,
                       uint32_t b_k)
{
    const struct marching_rows *grid = &bits->grid;
    const uint32_t *size = bits->field->grid.size;
    const float *first = (const float *)bits->field->voxels + grid->start[0];
    for (uint32_t b = 0; b < n_bricks; b++)
        for (uint32_t row = 0; states[b] >= BRICK_MIXED && row < ISO_BRICK_J * ISO_BRICK_K; row++) {
            uint32_t y = b_j * ISO_BRICK_J + row % ISO_BRICK_J, z = b_k * ISO_BRICK_K + row / ISO_BRICK_J;
            size_t j = (size_t)grid->start[1] + y, k = (size_t)grid->start[2] + z;
            if (y < grid->size[1] && z < grid->size[2])
                __builtin_prefetch(first + (k * size[1] + j) * size[0] + b * ISO_BRICK_I);
        }
}

static void make_layers(void *context, int part, int n_parts)
{
    struct bits_job *job = context;
    const struct iso_bits *bits = job->bits;
    const struct marching_rows *grid = &bits->grid;
    uint8_t states[2][MAX_BRICKS_A_ROW];
    uint32_t n_j = (grid->size[1] + ISO_BRICK_J - 1) / ISO_BRICK_J;
    uint32_t n_i = (grid->size[0] + ISO_BRICK_I - 1) / ISO_BRICK_I, b_k;
    uint32_t first[3] = { (uint32_t)grid->start[0] / ISO_BRICK_I, (uint32_t)grid->start[1] / ISO_BRICK_J,
                          (uint32_t)grid->start[2] / ISO_BRICK_K };
    (void)part, (void)n_parts;
    while ((b_k = atomic_fetch_add(&job->next, 1)) * ISO_BRICK_K < grid->size[2])
        for (uint32_t b_j = 0; b_j <= n_j; b_j++) { /* one row of bricks is asked for before the last one is made */
            for (uint32_t b = 0; b_j < n_j && b < n_i; b++)
                states[b_j % 2][b] = (uint8_t)state_of(bits, bits->bricks ? brick_index(bits->bricks, first[0] + b,
                                                                                        first[1] + b_j, first[2] + b_k)
                                                                          : 0);
            if (b_j < n_j && bits->bricks)
                fetch_rows(bits, states[b_j % 2], n_i, b_j, b_k);
            if (b_j > 0)
                make_rows(job, states[(b_j - 1) % 2], b_j - 1, b_k);
        }
}

bool iso_bits_make(struct iso_bits *bits, int n_parts, struct error *err)
{
    struct marching_rows *grid = &bits->grid;
    size_t n_rows = (size_t)grid->size[1] * grid->size[2];
    bool may_have_gaps = !bits->bricks;
    for (size_t b = 0; !may_have_gaps && b < (size_t)bits->bricks->n[0] * bits->bricks->n[1] * bits->bricks->n[2]; b++)
        may_have_gaps = bits->bricks->has_gaps[b];
    /* bits and rows in one array: fewer and larger pages */
    grid->bits = mem_large_array(n_rows + 1, grid->words * sizeof *grid->bits + sizeof *grid->rows, UINT64_MAX, err);
    if (!grid->bits)
        return false;
    grid->rows = (struct row *)(grid->bits + n_rows * grid->words);
    grid->rows[n_rows] = (struct row){ 0 };
    bits->valued = *grid;
    bits->valued.bits = NULL;
    if (may_have_gaps) {
        bits->valued.bits = mem_large_array(n_rows, grid->words * sizeof *grid->bits, UINT64_MAX, err);
        if (!bits->valued.bits)
            return false;
    }
    struct bits_job job = { .bits = bits };
    parallel_run(n_parts, make_layers, &job);
    if (!atomic_load(&job.has_gaps)) {
        free(bits->valued.bits);
        bits->valued.bits = NULL;
    }
    return true;
}

void iso_bits_finish(struct iso_bits *bits)
{
    free(bits->grid.bits);
    free(bits->valued.bits);
}

struct mask *iso_bits_mask(struct iso_bits *bits, int n_parts, struct error *err)
{
    const uint32_t *size = bits->field->grid.size;
    struct mask *mask = mask_create(size, &bits->field->grid.lps_mm_from_ijk, err);
    struct bits_job job = { .bits = bits, .mask = mask };
    for (int axis = 0; axis < 3; axis++) {
        bits->grid.start[axis] = 0;
        bits->grid.size[axis] = size[axis];
    }
    if (mask)
        parallel_run(n_parts, make_layers, &job);
    return mask;
}
