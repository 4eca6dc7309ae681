#include "core/region/mask.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/mask_pack.h"

enum { MAX_THREADS = 64, MAX_FACTOR = 8, MAX_WORDS = VOLUME_MAX_SIDE / 64 };

struct mask *mask_create(const uint32_t size[3], const struct affine *lps_mm_from_ijk, struct error *err)
{
    struct mask *mask = mem_new(sizeof *mask);
    for (int axis = 0; axis < 3; axis++)
        mask->size[axis] = size[axis];
    mask->words = (size[0] + 63) / 64;
    mask->lps_mm_from_ijk = *lps_mm_from_ijk;
    mask->bits = mem_large_array((size_t)size[1] * size[2], mask->words * sizeof *mask->bits, VOLUME_MAX_BYTES, err);
    if (!mask->bits) {
        free(mask);
        return NULL;
    }
    return mask;
}

void mask_destroy(struct mask *mask)
{
    if (!mask)
        return;
    free(mask->bits);
    free(mask);
}

static size_t mask_n_words(const struct mask *mask)
{
    return (size_t)mask->words * mask->size[1] * mask->size[2];
}

uint64_t mask_count(const struct mask *mask)
{
    uint64_t n = 0;
    for (size_t at = 0, end = mask_n_words(mask); at < end; at++)
        n += (uint64_t)__builtin_popcountll(mask->bits[at]);
    return n;
}

static int threads_or_cores(int n_threads)
{
    int n = n_threads > 0 ? n_threads : parallel_cores();
    return n < MAX_THREADS ? n : MAX_THREADS;
}

static void range_of(size_t n, int part, int n_parts, size_t *from, size_t *end)
{
    *from = n * (size_t)part / (size_t)n_parts;
    *end = n * (size_t)(part + 1) / (size_t)n_parts;
}

/* ---- labels to bits ----------------------------------------------------------------------------------------------------- */

struct pack_job {
    const struct volume *layer;
    const struct label_test *test;
    const struct mask_packer *packer;
    struct mask *mask;
};

static void pack_part(void *context, int part, int n_parts)
{
    const struct pack_job *job = context;
    const uint32_t *size = job->mask->size;
    size_t row, end;
    for (range_of((size_t)size[1] * size[2], part, n_parts, &row, &end); row < end; row++) {
        uint64_t *bits = job->mask->bits + row * job->mask->words;
        if (job->layer->type == VOXEL_U8)
            job->packer->pack_u8(job->test, (const uint8_t *)job->layer->voxels + row * size[0], size[0], bits);
        else
            job->packer->pack_u16(job->test, (const uint16_t *)job->layer->voxels + row * size[0], size[0], bits);
    }
}

struct mask *mask_from_labels(const struct volume *layer, const uint16_t *labels, size_t n_labels, int n_threads,
                              struct error *err)
{
    if (n_labels == 0) {
        error_set(err, ERROR_RANGE, "a mask of no labels: expected at least 1");
        return NULL;
    }
    if (layer->type != VOXEL_U8 && layer->type != VOXEL_U16) {
        error_set(err, ERROR_UNSUPPORTED, "a label layer holds unsigned whole numbers of 8 or 16 bits, not voxel type %d",
                  (int)layer->type);
        return NULL;
    }
    struct pack_job job = { .layer = layer, .packer = mask_packer_best() };
    job.mask = mask_create(layer->grid.size, &layer->grid.lps_mm_from_ijk, err);
    if (!job.mask)
        return NULL;
    struct label_test *test = mem_new(sizeof *test);
    label_test_init(test, labels, n_labels);
    job.test = test;
    parallel_run(threads_or_cores(n_threads), pack_part, &job);
    free(test);
    return job.mask;
}

/* ---- a region and what is inside it ------------------------------------------------------------------------------------- */

/* The same voxels: corners of the one grid lie within a hundredth of a voxel of the other's. */
static bool is_same_grid(const struct grid *a, const struct grid *b)
{
    for (int axis = 0; axis < 3; axis++)
        if (a->size[axis] != b->size[axis])
            return false;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = vec3(corner & 1 ? a->size[0] - 1 : 0, corner & 2 ? a->size[1] - 1 : 0, corner & 4 ? a->size[2] - 1 : 0);
        struct vec3 off = vec3_sub(affine_point(&b->ijk_from_lps_mm, affine_point(&a->lps_mm_from_ijk, at)), at);
        if (!(vec3_length(off) < 0.01))
            return false;
    }
    return true;
}

struct mask *mask_from_region(const struct region_set *set, size_t region, int n_threads, struct error *err)
{
    if (region >= set->n_regions) {
        error_set(err, ERROR_RANGE, "region %zu: the plan has %zu", region, set->n_regions);
        return NULL;
    }
    size_t *inside = mem_array(set->n_regions, sizeof *inside, UINT64_MAX, err);
    uint16_t *labels = inside ? mem_array(set->n_regions, sizeof *labels, UINT64_MAX, err) : NULL;
    size_t n_inside = labels ? region_with_descendants(set, region, inside) : 0;
    uint32_t own_layer = set->regions[region].layer;
    struct mask *mask = NULL;
    bool good = labels != NULL;
    for (size_t step = 0; good && step <= set->n_layers; step++) {
        size_t layer = step == 0 ? own_layer : step - 1; /* own layer first, as it sets the grid */
        if ((step > 0 && layer == own_layer) || !is_same_grid(&set->layers[layer]->grid, &set->layers[own_layer]->grid))
            continue;
        size_t n = 0;
        for (size_t i = 0; i < n_inside; i++)
            if (set->regions[inside[i]].layer == layer)
                labels[n++] = set->regions[inside[i]].label;
        if (n == 0)
            continue;
        struct mask *more = mask_from_labels(set->layers[layer], labels, n, n_threads, err);
        good = more != NULL;
        if (!mask) {
            mask = more;
            continue;
        }
        for (size_t at = 0, end = mask_n_words(mask); good && at < end; at++)
            mask->bits[at] |= more->bits[at];
        mask_destroy(more);
    }
    free(labels);
    free(inside);
    if (!good) {
        mask_destroy(mask);
        return NULL;
    }
    return mask;
}

/* ---- coarser masks ------------------------------------------------------------------------------------------------------ */

struct reduce_job {
    const struct mask *from;
    struct mask *to;
    uint32_t factor;
    struct {
        uint32_t n, ijk[3]; /* how many voxels of it are inside, 0 when none was seen */
    } fullest[MAX_THREADS]; /* block, one a part */
};

static uint32_t part_of_block(uint32_t size, uint32_t block, uint32_t factor)
{
    uint32_t left = size - block * factor;
    return left < factor ? left : factor;
}

/* Which of the n voxels of a row from `first` on are inside; n <= 8, so they lie in at most two words. */
static uint64_t bits_at(const uint64_t *row, uint32_t first, uint32_t n)
{
    uint32_t word = first / 64, shift = first % 64;
    uint64_t bits = row[word] >> shift;
    if (shift + n > 64)
        bits |= row[word + 1] << (64 - shift);
    return bits & (((uint64_t)1 << n) - 1);
}

/* The rows of voxels that a row of blocks covers. */
struct block_row {
    const uint64_t *first;
    size_t next_j, next_k; /* words from a row to the next along j and k */
    uint32_t n_j, n_k;
    uint64_t any[MAX_WORDS], all[MAX_WORDS]; /* of these rows: inside in one of them, in each of them */
};

static void block_row_init(struct block_row *rows, const struct mask *from, uint32_t factor, uint32_t j, uint32_t k)
{
    rows->next_j = from->words;
    rows->next_k = (size_t)from->words * from->size[1];
    rows->first = from->bits + (size_t)k * factor * rows->next_k + (size_t)j * factor * rows->next_j;
    rows->n_j = part_of_block(from->size[1], j, factor);
    rows->n_k = part_of_block(from->size[2], k, factor);
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

/* Voxels inside in the block of n_i voxels from `first` on. Most blocks are empty or full and need no counting. */
static uint32_t count_block(const struct block_row *rows, uint32_t first, uint32_t n_i)
{
    if (!bits_at(rows->any, first, n_i))
        return 0;
    if (bits_at(rows->all, first, n_i) == ((uint64_t)1 << n_i) - 1)
        return n_i * rows->n_j * rows->n_k;
    uint32_t n = 0;
    for (uint32_t dk = 0; dk < rows->n_k; dk++)
        for (uint32_t dj = 0; dj < rows->n_j; dj++)
            n += (uint32_t)__builtin_popcountll(bits_at(rows->first + dk * rows->next_k + dj * rows->next_j, first, n_i));
    return n;
}

static void reduce_part(void *context, int part, int n_parts)
{
    struct reduce_job *job = context;
    const struct mask *from = job->from, *to = job->to;
    struct block_row rows;
    size_t at, end;
    for (range_of((size_t)to->size[1] * to->size[2], part, n_parts, &at, &end); at < end; at++) {
        uint32_t j = (uint32_t)(at % to->size[1]), k = (uint32_t)(at / to->size[1]);
        block_row_init(&rows, from, job->factor, j, k);
        uint64_t *row = to->bits + at * to->words;
        memset(row, 0, to->words * sizeof *row);
        for (uint32_t i = 0; i < to->size[0]; i++) {
            uint32_t n_i = part_of_block(from->size[0], i, job->factor);
            uint32_t n = count_block(&rows, i * job->factor, n_i);
            if (2 * n >= n_i * rows.n_j * rows.n_k)
                row[i / 64] |= (uint64_t)1 << i % 64;
            if (n > job->fullest[part].n) {
                job->fullest[part].n = n;
                job->fullest[part].ijk[0] = i;
                job->fullest[part].ijk[1] = j;
                job->fullest[part].ijk[2] = k;
            }
        }
    }
}

struct mask *mask_reduce(const struct mask *mask, uint32_t factor, int n_threads, struct error *err)
{
    if (factor < 2 || factor > MAX_FACTOR) {
        error_set(err, ERROR_RANGE, "a mask reduced by %u: expected 2 to %d", factor, MAX_FACTOR);
        return NULL;
    }
    struct reduce_job job = { .from = mask, .factor = factor };
    uint32_t size[3];
    struct affine map = mask->lps_mm_from_ijk;
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = (mask->size[axis] + factor - 1) / factor;
        /* the centre of a block of f voxels lies (f - 1) / 2 voxels behind the centre of its first */
        map.origin = vec3_add(map.origin, vec3_scale(map.columns[axis], (factor - 1) / 2.0));
        map.columns[axis] = vec3_scale(map.columns[axis], factor);
    }
    job.to = mask_create(size, &map, err);
    if (!job.to)
        return NULL;
    int n_parts = threads_or_cores(n_threads);
    parallel_run(n_parts, reduce_part, &job);
    int best = 0; /* of equals the first in memory, whatever the number of parts */
    for (int part = 1; part < n_parts; part++)
        if (job.fullest[part].n > job.fullest[best].n)
            best = part;
    if (job.fullest[best].n > 0 && mask_count(job.to) == 0) {
        const uint32_t *ijk = job.fullest[best].ijk;
        job.to->bits[((size_t)ijk[2] * size[1] + ijk[1]) * job.to->words + ijk[0] / 64] |= (uint64_t)1 << ijk[0] % 64;
    }
    return job.to;
}
