/* Sweeps the label layers once and sets the bits of all requested masks. */
#include "core/region/mask_sweep.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

enum { MAX_THREADS = 64, N_LABELS = 65536 };
enum { NOWHERE, ELSEWHERE, FIRST_ROW };

/* The masks that contain a label: n mask numbers from members[from] on. */
struct holders {
    uint32_t from, n;
};

/* The extent of the bits a thread has set in a mask. */
struct reach {
    uint32_t low_j, end_j, low_k, end_k; /* all 0: none */
    uint64_t row;                        /* the last row touched; NOWHERE: none; ELSEWHERE: in an earlier layer */
};

struct sweep {
    const struct region_set *set;
    const struct mask_wish *wishes;
    size_t n;
    struct mask **masks;
    uint64_t **bits; /* [n] bits of the masks */
    const struct volume *layer;
    struct holders *holders; /* [N_LABELS] of the current layer */
    uint32_t *members;
    struct reach *reaches; /* [n_threads][n] */
};

/* ---- masks by label of a layer ---------------------------------------------------------------------------------- */

static const struct volume *layer_of(const struct sweep *sweep, size_t wish)
{
    return sweep->set->layers[sweep->set->regions[sweep->wishes[wish].region].layer];
}

/* Calls note for every label of the layer and every mask that contains it. */
static void each_label(const struct sweep *sweep, size_t layer, size_t *inside,
                       void (*note)(const struct sweep *sweep, uint16_t label, uint32_t mask))
{
    for (size_t w = 0; w < sweep->n; w++) {
        const struct mask_wish *wish = &sweep->wishes[w];
        const struct region *regions = sweep->set->regions;
        if (!grid_is_same(&sweep->set->layers[layer]->grid, &layer_of(sweep, w)->grid))
            continue;
        size_t n_inside = wish->is_own ? 1 : region_with_descendants(sweep->set, wish->region, inside);
        inside[0] = wish->region;
        for (size_t i = 0; i < n_inside; i++)
            if (regions[inside[i]].layer == layer)
                note(sweep, regions[inside[i]].label, (uint32_t)w);
    }
}

static void count_holder(const struct sweep *sweep, uint16_t label, uint32_t mask)
{
    (void)mask;
    sweep->holders[label].n++;
}

static void add_holder(const struct sweep *sweep, uint16_t label, uint32_t mask)
{
    struct holders *holders = &sweep->holders[label];
    sweep->members[holders->from + holders->n++] = mask;
}

/* Lists, for each label of the layer, the masks that contain it. Returns false if no mask contains any, or there is no
 * memory. */
static bool find_holders(struct sweep *sweep, size_t layer, size_t *inside, struct error *err)
{
    uint64_t n = 0;
    memset(sweep->holders, 0, N_LABELS * sizeof *sweep->holders);
    each_label(sweep, layer, inside, count_holder);
    for (size_t label = 0; label < N_LABELS; label++) {
        sweep->holders[label].from = (uint32_t)n; /* fits: at most REGION_MAX wishes of REGION_MAX regions each */
        n += sweep->holders[label].n;
        sweep->holders[label].n = 0;
    }
    if (n == 0)
        return false;
    sweep->members = mem_array((size_t)n, sizeof *sweep->members, UINT32_MAX, err);
    if (sweep->members)
        each_label(sweep, layer, inside, add_holder);
    return sweep->members != NULL;
}

/* ---- sweeping the labels ---------------------------------------------------------------------------------------- */

struct word_position {
    size_t word; /* index of the word in each mask */
    uint32_t j, k;
};

static inline void set_bits(const struct sweep *sweep, uint16_t label, struct reach *reaches,
                            struct word_position place, uint64_t bits)
{
    const struct holders *holders = &sweep->holders[label];
    uint64_t row = ((uint64_t)place.k << 32 | place.j) + FIRST_ROW;
    for (uint32_t i = 0; i < holders->n; i++) {
        uint32_t mask = sweep->members[holders->from + i];
        struct reach *reach = &reaches[mask];
        sweep->bits[mask][place.word] |= bits;
        if (reach->row == row)
            continue;
        bool is_first = reach->row == NOWHERE;
        reach->low_k = is_first || place.k < reach->low_k ? place.k : reach->low_k;
        reach->end_k = place.k + 1 > reach->end_k ? place.k + 1 : reach->end_k;
        reach->low_j = is_first || place.j < reach->low_j ? place.j : reach->low_j;
        reach->end_j = place.j + 1 > reach->end_j ? place.j + 1 : reach->end_j;
        reach->row = row;
    }
}

/* Sweeps up to 64 labels: most words hold a single label, the rest a few runs. */
#define DEFINE_WORD(type) \
    static inline void sweep_word_##type(const struct sweep *sweep, const type *labels, uint32_t n, \
                                         struct reach *reaches, struct word_position place) \
    { \
        type first = labels[0], other = 0; \
        if (n == 64) { \
            for (uint32_t i = 0; i < 64; i++) \
                other = (type)(other | (labels[i] ^ first)); \
            if (!other) { \
                set_bits(sweep, first, reaches, place, ~(uint64_t)0); \
                return; \
            } \
        } \
        uint64_t changes = 0; /* bit i is set if label i differs from label i - 1 */ \
        for (uint32_t i = 1; i < n; i++) \
            changes |= (uint64_t)(labels[i] != labels[i - 1]) << i; \
        uint64_t all = n == 64 ? ~(uint64_t)0 : ((uint64_t)1 << n) - 1; \
        for (uint64_t from = 1; from;) { \
            uint64_t next = changes & (~changes + 1); \
            changes &= changes - 1; \
            set_bits(sweep, labels[__builtin_ctzll(from)], reaches, place, (next ? next - from : ~(from - 1)) & all); \
            from = next; \
        } \
    }

DEFINE_WORD(uint8_t)
DEFINE_WORD(uint16_t)

static void sweep_part(void *context, int part, int n_parts)
{
    const struct sweep *sweep = context;
    const uint32_t *size = sweep->layer->grid.size;
    struct reach *reaches = sweep->reaches + (size_t)part * sweep->n;
    size_t n_rows = (size_t)size[1] * size[2], words = (size[0] + 63) / 64;
    size_t end = n_rows * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t row = n_rows * (size_t)part / (size_t)n_parts; row < end; row++) {
        struct word_position place = { row * words, (uint32_t)(row % size[1]), (uint32_t)(row / size[1]) };
        for (uint32_t i = 0; i < size[0]; i += 64, place.word++) {
            uint32_t n = size[0] - i < 64 ? size[0] - i : 64;
            if (sweep->layer->type == VOXEL_U8)
                sweep_word_uint8_t(sweep, (const uint8_t *)sweep->layer->voxels + row * size[0] + i, n, reaches, place);
            else
                sweep_word_uint16_t(sweep, (const uint16_t *)sweep->layer->voxels + row * size[0] + i, n, reaches,
                                    place);
        }
    }
}

/* ---- mask_sweep ------------------------------------------------------------------------------------------------- */

static bool check(const struct region_set *set, const struct mask_wish *wishes, size_t n, struct error *err)
{
    for (size_t w = 0; w < n; w++)
        if (wishes[w].region >= set->n_regions)
            return error_set(err, ERROR_RANGE, "region %zu: the plan has %zu", wishes[w].region, set->n_regions);
    for (size_t layer = 0; layer < set->n_layers; layer++)
        if (set->layers[layer]->type != VOXEL_U8 && set->layers[layer]->type != VOXEL_U16)
            return error_set(err, ERROR_UNSUPPORTED,
                             "a label layer holds unsigned whole numbers of 8 or 16 bits, not voxel type %d",
                             (int)set->layers[layer]->type);
    return true;
}

/* The mask's extent is the union of the extents of all threads. */
static void join_reaches(struct mask *mask, const struct reach *reaches, size_t stride, int n_threads)
{
    struct reach all = { 0 };
    for (int thread = 0; thread < n_threads; thread++) {
        const struct reach *one = &reaches[(size_t)thread * stride];
        if (one->row == NOWHERE)
            continue;
        bool is_first = all.row == NOWHERE;
        all.low_j = is_first || one->low_j < all.low_j ? one->low_j : all.low_j;
        all.low_k = is_first || one->low_k < all.low_k ? one->low_k : all.low_k;
        all.end_j = one->end_j > all.end_j ? one->end_j : all.end_j;
        all.end_k = one->end_k > all.end_k ? one->end_k : all.end_k;
        all.row = ELSEWHERE;
    }
    mask->low_j = all.low_j;
    mask->end_j = all.end_j;
    mask->low_k = all.low_k;
    mask->end_k = all.end_k;
}

static bool sweep_layers(struct sweep *sweep, int n_threads, struct error *err)
{
    size_t *inside = mem_new((sweep->set->n_regions + 1) * sizeof *inside); /* at most REGION_MAX entries */
    sweep->holders = mem_array(N_LABELS, sizeof *sweep->holders, UINT64_MAX, err);
    sweep->reaches = mem_array(sweep->n * (size_t)n_threads, sizeof *sweep->reaches, UINT64_MAX, err);
    bool is_good = sweep->holders && sweep->reaches;
    for (size_t layer = 0; is_good && layer < sweep->set->n_layers; layer++) {
        struct error why = { 0 };
        sweep->layer = sweep->set->layers[layer];
        if (find_holders(sweep, layer, inside, &why))
            parallel_run(n_threads, sweep_part, sweep);
        is_good = why.code == 0 || (err && (*err = why, false));
        free(sweep->members);
        sweep->members = NULL;
        for (size_t at = 0; at < sweep->n * (size_t)n_threads; at++)
            if (sweep->reaches[at].row != NOWHERE)
                sweep->reaches[at].row = ELSEWHERE;
    }
    for (size_t w = 0; is_good && w < sweep->n; w++)
        join_reaches(sweep->masks[w], sweep->reaches + w, sweep->n, n_threads);
    free(sweep->reaches);
    free(sweep->holders);
    free(inside);
    return is_good;
}

bool mask_sweep(const struct region_set *set, const struct mask_wish *wishes, size_t n, int n_threads,
                struct mask **masks, struct error *err)
{
    if (!check(set, wishes, n, err))
        return false;
    struct sweep sweep = { .set = set, .wishes = wishes, .n = n };
    int n_parts = n_threads > 0 ? n_threads : parallel_cores();
    sweep.masks = mem_array(n, sizeof *sweep.masks, UINT64_MAX, err);
    sweep.bits = sweep.masks ? mem_array(n, sizeof *sweep.bits, UINT64_MAX, err) : NULL;
    bool is_good = sweep.bits != NULL;
    for (size_t w = 0; is_good && w < n; w++) {
        const struct grid *grid = &layer_of(&sweep, w)->grid;
        sweep.masks[w] = mask_create_empty(grid->size, &grid->lps_mm_from_ijk, err);
        is_good = sweep.masks[w] != NULL;
        sweep.bits[w] = is_good ? sweep.masks[w]->bits : NULL;
    }
    is_good = is_good && sweep_layers(&sweep, n_parts < MAX_THREADS ? n_parts : MAX_THREADS, err);
    for (size_t w = 0; sweep.masks && w < n; w++)
        if (is_good)
            masks[w] = sweep.masks[w];
        else
            mask_destroy(sweep.masks[w]);
    free(sweep.bits);
    free(sweep.masks);
    return is_good;
}
