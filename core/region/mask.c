/* Creates masks, from labels and from regions. */
#include "core/region/mask.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/mask_pack.h"

enum { MAX_THREADS = 64 };

typedef void *allocate(size_t n, size_t size, uint64_t limit_bytes, struct error *err);

static struct mask *create(const uint32_t size[3], const struct affine *lps_mm_from_ijk, allocate *bits,
                           struct error *err)
{
    struct mask *mask = mem_new(sizeof *mask);
    for (int axis = 0; axis < 3; axis++)
        mask->size[axis] = size[axis];
    mask->words = (size[0] + 63) / 64;
    mask->end_j = size[1];
    mask->end_k = size[2];
    mask->lps_mm_from_ijk = *lps_mm_from_ijk;
    mask->bits = bits((size_t)size[1] * size[2], mask->words * sizeof *mask->bits, VOLUME_MAX_BYTES, err);
    if (!mask->bits) {
        free(mask);
        return NULL;
    }
    return mask;
}

struct mask *mask_create(const uint32_t size[3], const struct affine *lps_mm_from_ijk, struct error *err)
{
    return create(size, lps_mm_from_ijk, mem_large_array, err);
}

struct mask *mask_create_empty(const uint32_t size[3], const struct affine *lps_mm_from_ijk, struct error *err)
{
    return create(size, lps_mm_from_ijk, mem_array, err);
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
    for (uint32_t k = mask->low_k; k < mask->end_k; k++) {
        const uint64_t *slice = mask->bits + (size_t)k * mask->size[1] * mask->words;
        for (size_t at = (size_t)mask->low_j * mask->words, end = (size_t)mask->end_j * mask->words; at < end; at++)
            n += (uint64_t)__builtin_popcountll(slice[at]);
    }
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

/* ---- labels to bits --------------------------------------------------------------------------------------------- */

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
        error_set(err, ERROR_UNSUPPORTED,
                  "a label layer holds unsigned whole numbers of 8 or 16 bits, not voxel type %d", (int)layer->type);
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

/* ---- regions to bits -------------------------------------------------------------------------------------------- */

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
        size_t layer = step == 0 ? own_layer : step - 1; /* the region's own layer first, because it sets the grid */
        if ((step > 0 && layer == own_layer) || !grid_is_same(&set->layers[layer]->grid, &set->layers[own_layer]->grid))
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
