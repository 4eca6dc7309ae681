/* Reduces a mask to a coarser one of the same topology.
 *
 *   1. count the voxels of every block
 *   2. start with all blocks that hold any voxel: everything closed or connected is so still
 *   3. visit the blocks that are less than half full, emptiest first; remove a block that is at the original outside
 *      and has a neighbour at least as full on its other side, unless that would open a hole, cut a piece in two or
 *      join two cavities
 *
 * Inside voxels are connected by faces, outside voxels also by edges and corners, as in the surfaces (cube_cases.h). A
 * voxel can be removed without changing the topology if, among its 26 neighbours, the inside voxels that share a face
 * with it are connected by faces within the 18 that share a face or an edge with it, and the outside voxels are
 * connected (G. Bertrand, Simple points, topological numbers and geodesic neighborhoods in cubic grids, 1994). */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/mask.h"

enum {
    MAX_THREADS = 64,
    MAX_WORDS = VOLUME_MAX_SIDE / 64,
    MAX_COUNT = MASK_MAX_FACTOR * MASK_MAX_FACTOR * MASK_MAX_FACTOR
};

struct reduce_job {
    const struct mask *from;
    struct mask *to;
    uint32_t factors[3];
    uint16_t *counts; /* [k][j][i] of blocks: number of inside voxels; 0 where nothing was written */
};

static uint32_t part_of_block(uint32_t size, uint32_t block, uint32_t factor)
{
    uint32_t left = size - block * factor;
    return left < factor ? left : factor;
}

/* ---- counting voxels per block ---------------------------------------------------------------------------------- */

/* Bits of the n voxels of a row from `first` on; 1 <= n <= 64, so they are in at most two words. */
static uint64_t bits_at(const uint64_t *row, uint32_t first, uint32_t n)
{
    uint32_t word = first / 64, shift = first % 64;
    uint64_t bits = row[word] >> shift;
    if (shift + n > 64)
        bits |= row[word + 1] << (64 - shift);
    return bits & ~(uint64_t)0 >> (64 - n);
}

/* The rows of voxels covered by a row of blocks. */
struct block_row {
    const uint64_t *first;
    size_t next_j, next_k; /* distance in words of the next row along j and of the next slice */
    uint32_t n_j, n_k;
    uint64_t any[MAX_WORDS], all[MAX_WORDS]; /* over these rows: bits set in at least one, bits set in every one */
};

static void block_row_init(struct block_row *rows, const struct mask *from, const uint32_t factors[3], uint32_t j,
                           uint32_t k)
{
    rows->next_j = from->words;
    rows->next_k = (size_t)from->words * from->size[1];
    rows->first = from->bits + (size_t)k * factors[2] * rows->next_k + (size_t)j * factors[1] * rows->next_j;
    rows->n_j = part_of_block(from->size[1], j, factors[1]);
    rows->n_k = part_of_block(from->size[2], k, factors[2]);
    for (uint32_t w = 0; w < from->words; w++) {
        uint64_t any = 0, all = ~(uint64_t)0;
        for (uint32_t dk = 0; dk < rows->n_k; dk++)
            for (uint32_t dj = 0; dj < rows->n_j; dj++) {
                uint64_t bits = rows->first[dk * rows->next_k + dj * rows->next_j + w];
                any |= bits;
                all &= bits;
            }
        rows->any[w] = any;
        rows->all[w] = all;
    }
}

/* Counts the inside voxels of the block of n_i columns from `first` on. Most blocks are empty or full and need no
 * counting. */
static uint32_t count_block(const struct block_row *rows, uint32_t first, uint32_t n_i)
{
    if (!bits_at(rows->any, first, n_i))
        return 0;
    if (bits_at(rows->all, first, n_i) == ((uint64_t)1 << n_i) - 1)
        return n_i * rows->n_j * rows->n_k;
    uint32_t n = 0;
    for (uint32_t dk = 0; dk < rows->n_k; dk++)
        for (uint32_t dj = 0; dj < rows->n_j; dj++)
            n += (uint32_t)__builtin_popcountll(
                bits_at(rows->first + dk * rows->next_k + dj * rows->next_j, first, n_i));
    return n;
}

/* Reduces a row of blocks, 64 voxels at a time, because most words are empty or full. Empty ones need no write. */
static void count_row(const struct reduce_job *job, const struct block_row *rows, uint64_t *bits, uint16_t *counts)
{
    uint32_t n_blocks = job->to->size[0], n_voxels = job->from->size[0], factor = job->factors[0], n;
    for (uint32_t i = 0; i < n_blocks; i += n) {
        uint32_t first = i * factor;
        n = n_blocks - i < 64 / factor ? n_blocks - i : 64 / factor;
        uint32_t n_here = n * factor < n_voxels - first ? n * factor : n_voxels - first;
        if (!bits_at(rows->any, first, n_here))
            continue;
        bool is_full = n_here == n * factor && bits_at(rows->all, first, n_here) == ~(uint64_t)0 >> (64 - n_here);
        for (uint32_t block = i; block < i + n; block++) {
            counts[block] =
                (uint16_t)(is_full ? factor * rows->n_j * rows->n_k
                                   : count_block(rows, block * factor, part_of_block(n_voxels, block, factor)));
            bits[block / 64] |= (uint64_t)(counts[block] > 0) << block % 64;
        }
    }
}

static void count_part(void *context, int part, int n_parts)
{
    struct reduce_job *job = context;
    const struct mask *to = job->to;
    struct block_row rows;
    size_t n_j = to->end_j - to->low_j, n_rows = n_j * (to->end_k - to->low_k),
           end = n_rows * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t at = n_rows * (size_t)part / (size_t)n_parts; at < end; at++) {
        uint32_t j = to->low_j + (uint32_t)(at % n_j), k = to->low_k + (uint32_t)(at / n_j);
        size_t row = (size_t)k * to->size[1] + j;
        block_row_init(&rows, job->from, job->factors, j, k);
        count_row(job, &rows, to->bits + row * to->words, job->counts + row * to->size[0]);
    }
}

/* ---- removing blocks -------------------------------------------------------------------------------------------- */

/* The 27 voxels of a neighbourhood: bit (dx + 1) + 3 (dy + 1) + 9 (dz + 1); the middle is bit 13. */
enum { MIDDLE = 1 << 13, ALL_27 = (1 << 27) - 1 };
#define FACES ((1u << 4) | (1u << 10) | (1u << 12) | (1u << 14) | (1u << 16) | (1u << 22))
#define CORNERS ((1u << 0) | (1u << 2) | (1u << 6) | (1u << 8) | (1u << 18) | (1u << 20) | (1u << 24) | (1u << 26))

static uint32_t neighbourhood(const struct mask *mask, uint32_t i, uint32_t j, uint32_t k)
{
    uint32_t found = 0;
    for (uint32_t dk = 0; dk < 3; dk++)
        for (uint32_t dj = 0; dj < 3; dj++) {
            if (j + dj < 1 || k + dk < 1 || j + dj > mask->size[1] || k + dk > mask->size[2])
                continue;
            const uint64_t *row = mask->bits + ((size_t)(k + dk - 1) * mask->size[1] + (j + dj - 1)) * mask->words;
            for (uint32_t di = 0; di < 3; di++)
                if (i + di >= 1 && i + di <= mask->size[0])
                    found |= (uint32_t)(row[(i + di - 1) / 64] >> (i + di - 1) % 64 & 1) << (di + 3 * dj + 9 * dk);
        }
    return found;
}

/* Columns of the neighbourhood, to mask out a step along x over its edge. */
#define LEFT 0x1249249u /* dx = -1 */
#define RIGHT (LEFT << 2)

static uint32_t grow_x(uint32_t set)
{
    return set | (set & ~RIGHT) << 1 | (set & ~LEFT) >> 1;
}
static uint32_t y_steps(uint32_t set)
{
    const uint32_t low = 0x1c0e07u, high = low << 6; /* planes dy = -1 and dy = 1 */
    return (set & ~high) << 3 | (set & ~low) >> 3;
}
static uint32_t z_steps(uint32_t set)
{
    return set << 9 | set >> 9;
}

static uint32_t grow_by_faces(uint32_t set)
{
    return (grow_x(set) | y_steps(set) | z_steps(set)) & ALL_27;
}

static uint32_t grow_by_all(uint32_t set)
{
    set = grow_x(set);
    set |= y_steps(set);
    return (set | z_steps(set)) & ALL_27;
}

static uint32_t spread(uint32_t seed, uint32_t within, uint32_t (*grow)(uint32_t))
{
    for (uint32_t grown; (grown = grow(seed) & within) != seed;)
        seed = grown;
    return seed;
}

static bool is_simple(uint32_t neighbours)
{
    uint32_t inside = neighbours & ~(uint32_t)(MIDDLE | CORNERS), touching = neighbours & FACES;
    uint32_t outside = ~neighbours & ALL_27 & ~(uint32_t)MIDDLE;
    if (!touching || !outside)
        return false; /* a single voxel, or one not at the border */
    return (touching & ~spread(touching & (0 - touching), inside, grow_by_faces)) == 0 &&
           spread(outside & (0 - outside), outside, grow_by_all) == outside;
}

/* Returns true if the block is at the original outside and has, on the opposite side, a neighbour that is at least as
 * full and still there. */
static bool is_outermost(const struct reduce_job *job, uint32_t neighbours, const uint32_t at[3])
{
    static const uint32_t bit_of[3] = { 1, 3, 9 };
    const uint32_t *size = job->to->size;
    const size_t step[3] = { 1, size[0], (size_t)size[0] * size[1] };
    const uint16_t *here = job->counts + at[0] + at[1] * step[1] + at[2] * step[2];
    for (int axis = 0; axis < 3; axis++) {
        uint32_t below = at[axis] > 0 ? *(here - step[axis]) : 0,
                 above = at[axis] + 1 < size[axis] ? *(here + step[axis]) : 0;
        if (above == 0 && below >= *here && neighbours >> (13 - bit_of[axis]) & 1)
            return true;
        if (below == 0 && above >= *here && neighbours >> (13 + bit_of[axis]) & 1)
            return true;
    }
    return false;
}

static uint32_t block_size(const struct reduce_job *job, const uint32_t at[3])
{
    uint32_t n = 1;
    for (int axis = 0; axis < 3; axis++)
        n *= part_of_block(job->from->size[axis], at[axis], job->factors[axis]);
    return n;
}

struct thinning {
    struct reduce_job *job;
    size_t first[MAX_COUNT + 2]; /* by count: first how many blocks, then the position of the next one */
    uint32_t (*places)[3];
};

/* Calls found for each block that is less than half full and not empty, in memory order. */
static void each_thin(struct thinning *thinning,
                      void (*found)(struct thinning *thinning, uint16_t count, const uint32_t at[3]))
{
    const struct reduce_job *job = thinning->job;
    const struct mask *to = job->to;
    const uint32_t most = job->factors[0] * job->factors[1] * job->factors[2];
    for (uint32_t k = to->low_k; k < to->end_k; k++)
        for (uint32_t j = to->low_j; j < to->end_j; j++) {
            size_t row = (size_t)k * to->size[1] + j;
            for (uint32_t w = 0; w < to->words; w++)
                for (uint64_t left = to->bits[row * to->words + w]; left; left &= left - 1) {
                    const uint32_t at[3] = { 64 * w + (uint32_t)__builtin_ctzll(left), j, k };
                    uint16_t count = job->counts[row * to->size[0] + at[0]];
                    if (2u * count < most && 2u * count < block_size(job, at))
                        found(thinning, count, at);
                }
        }
}

static void count_thin(struct thinning *thinning, uint16_t count, const uint32_t at[3])
{
    (void)at;
    thinning->first[count + 1]++;
}

static void place_thin(struct thinning *thinning, uint16_t count, const uint32_t at[3])
{
    memcpy(thinning->places[thinning->first[count]++], at, sizeof *thinning->places);
}

/* Visits blocks by ascending count, equal counts in memory order. */
static bool thin_out(struct reduce_job *job, struct error *err)
{
    struct thinning thinning = { .job = job };
    each_thin(&thinning, count_thin);
    for (size_t count = 0; count <= MAX_COUNT; count++)
        thinning.first[count + 1] += thinning.first[count];
    size_t n = thinning.first[MAX_COUNT + 1];
    thinning.places = mem_array(n, sizeof *thinning.places, UINT64_MAX, err);
    if (!thinning.places)
        return false;
    each_thin(&thinning, place_thin);
    for (size_t at = 0; at < n; at++) {
        const uint32_t *place = thinning.places[at];
        size_t row = (size_t)place[2] * job->to->size[1] + place[1];
        uint32_t neighbours = neighbourhood(job->to, place[0], place[1], place[2]);
        if (is_outermost(job, neighbours, place) && is_simple(neighbours))
            job->to->bits[row * job->to->words + place[0] / 64] &= ~((uint64_t)1 << place[0] % 64);
    }
    free(thinning.places);
    return true;
}

/* ---- mask_reduce ------------------------------------------------------------------------------------------------ */

struct mask *mask_reduce(const struct mask *mask, const uint32_t factors[3], int n_threads, struct error *err)
{
    struct reduce_job job = { .from = mask };
    uint32_t size[3];
    struct affine map = mask->lps_mm_from_ijk;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t factor = job.factors[axis] = factors[axis];
        if (factor < 1 || factor > MASK_MAX_FACTOR) {
            error_set(err, ERROR_RANGE, "a mask reduced by %u: expected 1 to %d", factor, MASK_MAX_FACTOR);
            return NULL;
        }
        size[axis] = (mask->size[axis] + factor - 1) / factor;
        /* the centre of a block of f voxels is (f - 1) / 2 voxels after the centre of its first voxel */
        map.origin = vec3_add(map.origin, vec3_scale(map.columns[axis], (factor - 1) / 2.0));
        map.columns[axis] = vec3_scale(map.columns[axis], factor);
    }
    job.to = mask_create_empty(size, &map, err);
    job.counts = job.to ? mem_array((size_t)size[0] * size[1] * size[2], sizeof *job.counts, UINT64_MAX, err) : NULL;
    bool is_good = job.counts != NULL;
    if (is_good) {
        job.to->low_j = mask->low_j / factors[1];
        job.to->end_j = (mask->end_j + factors[1] - 1) / factors[1];
        job.to->low_k = mask->low_k / factors[2];
        job.to->end_k = (mask->end_k + factors[2] - 1) / factors[2];
        int n_parts = n_threads > 0 ? n_threads : parallel_cores();
        parallel_run(n_parts < MAX_THREADS ? n_parts : MAX_THREADS, count_part, &job);
        is_good = thin_out(&job, err);
    }
    free(job.counts);
    if (!is_good) {
        mask_destroy(job.to);
        return NULL;
    }
    return job.to;
}
