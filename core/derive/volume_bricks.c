/* Keeps the bricks of images, and the distances between those with visible values, in the store. */
#include "core/derive/volume_bricks.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

static size_t n_in_all(const uint32_t n[3])
{
    return (size_t)n[0] * n[1] * n[2];
}

/* ---- the range of values of each brick --------------------------------------------------------------------------- */

struct brick_work {
    const struct volume *volume;
    struct volume_bricks *bricks;
    atomic_size_t next; /* slab of bricks */
    atomic_bool is_out_of_memory;
};

/* The ends of the voxels that brick b of an axis holds. */
static void brick_voxels(uint32_t b, uint32_t size, uint32_t *first, uint32_t *last)
{
    *first = b * VOLUME_BRICK;
    *last = *first + VOLUME_BRICK < size ? *first + VOLUME_BRICK : size - 1;
}

/* The smallest and largest of the rows of a row of bricks, column by column, then those of each brick. Columns first,
 * so that the compiler makes vectors of them. */
#define ROW_OF_BRICKS(TYPE, LEAST, MOST, IS_FINITE) \
    do { \
        TYPE *restrict low = lows, *restrict high = highs; \
        for (uint32_t i = 0; i < size[0]; i++) { \
            low[i] = MOST; \
            high[i] = LEAST; \
        } \
        for (uint32_t k = first_k; k <= last_k; k++) \
            for (uint32_t j = first_j; j <= last_j; j++) { \
                const TYPE *restrict row = (const TYPE *)volume->voxels + ((size_t)k * size[1] + j) * size[0]; \
                for (uint32_t i = 0; i < size[0]; i++) { \
                    const TYPE value = row[i]; \
                    low[i] = IS_FINITE(value) && value < low[i] ? value : low[i]; \
                    high[i] = IS_FINITE(value) && value > high[i] ? value : high[i]; \
                } \
            } \
        for (uint32_t b = 0; b < bricks->n[0]; b++) { \
            uint32_t first, last; \
            brick_voxels(b, size[0], &first, &last); \
            TYPE least = low[first], most = high[first]; \
            for (uint32_t i = first + 1; i <= last; i++) { \
                least = low[i] < least ? low[i] : least; \
                most = high[i] > most ? high[i] : most; \
            } \
            set_brick(bricks, volume, at + b, least <= most, (double)least, (double)most); \
        } \
    } while (0)
#define ALWAYS(x) 1
#define FINITE(x) ((x) - (x) == 0.0f)

static void set_brick(struct volume_bricks *bricks, const struct volume *volume, size_t at, bool has_value,
                      double least, double most)
{
    double a = least * volume->slope + volume->offset, b = most * volume->slope + volume->offset;
    bricks->low[at] = has_value ? (float)fmin(a, b) : INFINITY;
    bricks->high[at] = has_value ? (float)fmax(a, b) : -INFINITY;
}

static void make_bricks(void *context, int part, int n_parts)
{
    struct brick_work *work = context;
    const struct volume *volume = work->volume;
    const uint32_t *size = volume->grid.size;
    struct volume_bricks *bricks = work->bricks;
    struct error err = { 0 };
    (void)part, (void)n_parts;
    void *lows = mem_array(size[0], sizeof(float), UINT64_MAX, &err);
    void *highs = lows ? mem_array(size[0], sizeof(float), UINT64_MAX, &err) : NULL;
    if (!highs)
        atomic_store(&work->is_out_of_memory, true);
    for (size_t slab; highs && (slab = atomic_fetch_add(&work->next, 1)) < bricks->n[2];) {
        uint32_t first_k, last_k, first_j, last_j;
        brick_voxels((uint32_t)slab, size[2], &first_k, &last_k);
        for (uint32_t row_of_bricks = 0; row_of_bricks < bricks->n[1]; row_of_bricks++) {
            size_t at = (slab * bricks->n[1] + row_of_bricks) * bricks->n[0];
            brick_voxels(row_of_bricks, size[1], &first_j, &last_j);
            switch (volume->type) {
            case VOXEL_U8: ROW_OF_BRICKS(uint8_t, 0, UINT8_MAX, ALWAYS); break;
            case VOXEL_I16: ROW_OF_BRICKS(int16_t, INT16_MIN, INT16_MAX, ALWAYS); break;
            case VOXEL_U16: ROW_OF_BRICKS(uint16_t, 0, UINT16_MAX, ALWAYS); break;
            case VOXEL_F32: ROW_OF_BRICKS(float, -INFINITY, INFINITY, FINITE); break;
            }
        }
    }
    free(lows);
    free(highs);
}

static void destroy_bricks(struct derive_result *base)
{
    struct volume_bricks *bricks = (struct volume_bricks *)base;
    free(bricks->low);
    free(bricks->high);
    free(bricks);
}

static struct derive_result *build_bricks(struct derive *derive, const struct derive_recipe *recipe, const void *way,
                                          struct error *err);
static const struct derive_kind bricks_kind = { sizeof(struct derive_recipe), NULL, build_bricks, destroy_bricks };

static struct derive_result *build_bricks(struct derive *derive, const struct derive_recipe *recipe, const void *way,
                                          struct error *err)
{
    (void)way;
    const struct volume *volume = derive_plan(derive)->images[recipe->subject.index].volume;
    struct volume_bricks *bricks = mem_new(sizeof *bricks);
    for (int axis = 0; axis < 3; axis++)
        bricks->n[axis] = (volume->grid.size[axis] + VOLUME_BRICK - 1) / VOLUME_BRICK;
    size_t n = n_in_all(bricks->n);
    derive_result_init(&bricks->base, &bricks_kind, sizeof *bricks + 2 * n * sizeof(float));
    bricks->low = mem_array(n, sizeof(float), UINT64_MAX, err);
    bricks->high = bricks->low ? mem_array(n, sizeof(float), UINT64_MAX, err) : NULL;
    struct brick_work work = { .volume = volume, .bricks = bricks };
    if (bricks->high)
        parallel_run(parallel_cores(), make_bricks, &work);
    if (bricks->high && !atomic_load(&work.is_out_of_memory))
        return &bricks->base;
    if (bricks->high)
        (void)error_set(err, ERROR_MEMORY, "no memory for the bricks of an image");
    destroy_bricks(&bricks->base);
    return NULL;
}

struct volume_bricks *volume_bricks_get(struct derive *derive, size_t image, struct error *err)
{
    struct derive_recipe recipe = { &bricks_kind, { SUBJECT_IMAGE, image, 0 } };
    return (struct volume_bricks *)derive_get(derive, &recipe, NULL, err);
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

struct leaps_recipe {
    struct derive_recipe base;
    size_t n;
    struct volume_range ranges[VOLUME_MAX_RANGES];
};

static bool is_equal(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct leaps_recipe *a = (const struct leaps_recipe *)left, *b = (const struct leaps_recipe *)right;
    if (a->n != b->n)
        return false;
    for (size_t i = 0; i < a->n; i++)
        if (a->ranges[i].low != b->ranges[i].low || a->ranges[i].high != b->ranges[i].high)
            return false;
    return true;
}

static void destroy_leaps(struct derive_result *base)
{
    struct volume_leaps *leaps = (struct volume_leaps *)base;
    free(leaps->leap);
    free(leaps);
}

/* A row: at most 1 more than `from` at the same place or beside it. */
static void spread(const uint8_t *restrict from, uint8_t *restrict row, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t left = from[i > 0 ? i - 1 : i], right = from[i + 1 < n ? i + 1 : i], least = from[i];
        least = left < least ? left : least;
        least = right < least ? right : least;
        row[i] = (uint8_t)(least + 1 < row[i] ? least + 1 : row[i]);
    }
}

/* Distances over the greatest of the three axes, by one pass over the grid and one back. Source: A. Rosenfeld and J. L.
 * Pfaltz, Distance Functions on Digital Pictures, 1968. */
static void fill_distances(uint8_t *leap, const uint32_t n[3])
{
    const size_t row = n[0], slab = row * n[1];
    for (uint32_t k = 0; k < n[2]; k++)
        for (uint32_t j = 0; j < n[1]; j++) {
            uint8_t *at = leap + k * slab + j * row;
            for (uint32_t other = j > 0 ? j - 1 : 0; k > 0 && other <= j + 1 && other < n[1]; other++)
                spread(leap + (k - 1) * slab + other * row, at, n[0]);
            if (j > 0)
                spread(at - row, at, n[0]);
            for (uint32_t i = 1; i < n[0]; i++)
                at[i] = (uint8_t)(at[i - 1] + 1 < at[i] ? at[i - 1] + 1 : at[i]);
        }
    for (uint32_t k = n[2]; k-- > 0;)
        for (uint32_t j = n[1]; j-- > 0;) {
            uint8_t *at = leap + k * slab + j * row;
            for (uint32_t other = j > 0 ? j - 1 : 0; k + 1 < n[2] && other <= j + 1 && other < n[1]; other++)
                spread(leap + (k + 1) * slab + other * row, at, n[0]);
            if (j + 1 < n[1])
                spread(at + row, at, n[0]);
            for (uint32_t i = n[0] - 1; i-- > 0;)
                at[i] = (uint8_t)(at[i + 1] + 1 < at[i] ? at[i + 1] + 1 : at[i]);
        }
}

static struct derive_result *build_leaps(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err);
static const struct derive_kind leaps_kind = { sizeof(struct leaps_recipe), is_equal, build_leaps, destroy_leaps };

static struct derive_result *build_leaps(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err)
{
    const struct leaps_recipe *recipe = (const struct leaps_recipe *)base;
    struct volume_bricks *bricks = volume_bricks_get(derive, base->subject.index, err);
    (void)way;
    if (!bricks)
        return NULL;
    size_t n = n_in_all(bricks->n);
    struct volume_leaps *leaps = mem_new(sizeof *leaps);
    derive_result_init(&leaps->base, &leaps_kind, sizeof *leaps + n);
    memcpy(leaps->n, bricks->n, sizeof leaps->n);
    leaps->leap = mem_array(n, 1, UINT64_MAX, err);
    for (size_t i = 0; leaps->leap && i < n; i++) {
        bool is_seen = false;
        for (size_t r = 0; r < recipe->n; r++)
            is_seen |=
                (double)bricks->low[i] <= recipe->ranges[r].high && (double)bricks->high[i] >= recipe->ranges[r].low;
        leaps->leap[i] = is_seen ? 0 : UINT8_MAX;
    }
    derive_result_unref(&bricks->base);
    if (!leaps->leap) {
        destroy_leaps(&leaps->base);
        return NULL;
    }
    fill_distances(leaps->leap, leaps->n);
    return &leaps->base;
}

struct volume_leaps *volume_leaps_get(struct derive *derive, size_t image, const struct volume_range *ranges, size_t n,
                                      struct error *err)
{
    struct leaps_recipe recipe = { .base = { &leaps_kind, { SUBJECT_IMAGE, image, 0 } }, .n = n };
    memcpy(recipe.ranges, ranges, n * sizeof *ranges);
    return (struct volume_leaps *)derive_get(derive, &recipe.base, NULL, err);
}
