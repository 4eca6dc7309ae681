/* Computes border voxels by bit operations on rows of the mask and their neighbours. */
#include "core/region/boundary.h"

#include "core/base/parallel.h"

enum { MAX_THREADS = 64 };

struct border_job {
    const struct mask *mask;
    struct mask *border;
    bool is_open_at_edge;
};

static const uint64_t *row_at(const struct mask *mask, size_t j, size_t k)
{
    return mask->bits + (k * mask->size[1] + j) * mask->words;
}

static void border_row(const struct border_job *job, size_t j, size_t k)
{
    const struct mask *mask = job->mask;
    const uint64_t *row = row_at(mask, j, k), beyond = job->is_open_at_edge ? ~(uint64_t)0 : 0;
    const uint64_t *beside[4] = {
        j > 0 ? row_at(mask, j - 1, k) : NULL,
        j + 1 < mask->size[1] ? row_at(mask, j + 1, k) : NULL,
        k > 0 ? row_at(mask, j, k - 1) : NULL,
        k + 1 < mask->size[2] ? row_at(mask, j, k + 1) : NULL,
    };
    uint64_t *out = job->border->bits + (k * mask->size[1] + j) * mask->words;
    uint32_t last = mask->words - 1, last_bit = (mask->size[0] - 1) % 64;
    for (uint32_t w = 0; w <= last; w++) {
        uint64_t here = row[w];
        uint64_t left = here << 1 | (w > 0 ? row[w - 1] >> 63 : beyond & 1);
        uint64_t right = here >> 1 | (w < last ? row[w + 1] << 63 : (beyond & 1) << last_bit);
        uint64_t all = left & right;
        for (int side = 0; side < 4; side++)
            all &= beside[side] ? beside[side][w] : beyond;
        out[w] = here & ~all;
    }
}

static void border_part(void *context, int part, int n_parts)
{
    const struct border_job *job = context;
    size_t n = (size_t)job->mask->size[1] * job->mask->size[2];
    size_t end = n * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t row = n * (size_t)part / (size_t)n_parts; row < end; row++)
        border_row(job, row % job->mask->size[1], row / job->mask->size[1]);
}

struct mask *mask_boundary(const struct mask *mask, bool is_open_at_edge, int n_threads, struct error *err)
{
    struct border_job job = { mask, mask_create(mask->size, &mask->lps_mm_from_ijk, err), is_open_at_edge };
    if (!job.border)
        return NULL;
    int n = n_threads > 0 ? n_threads : parallel_cores();
    parallel_run(n < MAX_THREADS ? n : MAX_THREADS, border_part, &job);
    return job.border;
}

struct mask *mask_from_region_own(const struct region_set *set, size_t region, int n_threads, struct error *err)
{
    if (region >= set->n_regions) {
        error_set(err, ERROR_RANGE, "region %zu: the plan has %zu", region, set->n_regions);
        return NULL;
    }
    const struct region *one = &set->regions[region];
    return mask_from_labels(set->layers[one->layer], &one->label, 1, n_threads, err);
}
