/* Combines the components of a dose, brick by brick, where and when the sums are read. */
#include "core/derive/dose_filling.h"

#include <math.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/dose_bricks.h"
#include "core/dose/combine.h"
#include "core/plan/fit.h"

/* A volume that is summed, with its factor in each row. */
struct summand {
    const struct volume *values, *mask; /* mask: NULL: valid everywhere */
    bool is_on_grid;                    /* values has the field's grid */
    bool is_mask_on_grid;
    float factor[DOSE_MAX_ROWS], offset[DOSE_MAX_ROWS]; /* of raw values */
};
enum { MAX_SUMMANDS = PLAN_MAX_DOSES * DOSE_N_QUANTITIES };
/* Voxels that are combined at once: with some components they fit a processor's first cache. */
enum { RUN = 512 };
/* Fewer bricks are combined by the calling thread alone. */
enum { FEW_BRICKS = 24 };
/* More bricks than are in a cache when they are read. */
enum { MANY_BRICKS = 1024 };

struct dose_filling {
    struct summand summands[MAX_SUMMANDS];
    size_t n;
    const struct grid *grid; /* a component's of the plan */
    bool is_resampled;
    struct volume *rows[DOSE_MAX_ROWS]; /* references */
    size_t n_rows;
    struct dose_bricks *near; /* a reference; NULL: rows[0] holds everywhere */
    uint32_t n_bricks[3];
    /* Indexed by brick, a bit for each row. claimed: a thread combines it or has; done: it is combined. */
    _Atomic uint32_t *claimed, *done;
    atomic_bool is_completing; /* a thread is in dose_filling_complete, or was */
    atomic_bool is_complete;   /* all rows of all bricks are done, and measured */
};

/* True if the voxels of a grid are smaller by more than what the rounding of files does. */
static bool is_finer(const struct grid *a, const struct grid *b)
{
    return grid_voxel_mm3(a) < grid_voxel_mm3(b) * (1 - 1e-6);
}

/* Tells which volumes lie on the field's grid. */
static void note_grids(struct dose_filling *filling)
{
    for (size_t i = 0; i < filling->n; i++) {
        struct summand *summand = &filling->summands[i];
        summand->is_on_grid = grid_is_same(filling->grid, &summand->values->grid);
        summand->is_mask_on_grid = summand->mask && grid_is_same(filling->grid, &summand->mask->grid);
        filling->is_resampled |= !summand->is_on_grid;
    }
}

/* The part with the next greater index of dose; n_parts: none. A sum is then the same whatever the order of its parts.
 */
static size_t next_part(const struct dose_choice *choice, size_t from_dose)
{
    size_t next = choice->n_parts;
    for (size_t p = 0; p < choice->n_parts; p++)
        if (choice->parts[p].dose >= from_dose &&
            (next == choice->n_parts || choice->parts[p].dose < choice->parts[next].dose))
            next = p;
    return next;
}

/* Lists what a part adds. */
static bool list_part(struct dose_filling *filling, const struct plan *plan, const struct dose_choice *choice,
                      size_t part, struct error *err)
{
    const struct dose *dose = &plan->doses[choice->parts[part].dose];
    const struct dose *first = &plan->doses[choice->unit_of];
    size_t n_before = filling->n;
    double unit = 1;
    if (dose != first && !dose_quantity_is_fluence(choice->quantity) &&
        !fit_unit_factor(dose->unit, first->unit, &unit))
        return error_set(err, ERROR_RANGE, "dose \"%s\" is in \"%s\", dose \"%s\" in \"%s\": they cannot be added",
                         first->id, first->unit, dose->id, dose->unit);
    for (size_t c = 0; c < dose->n_components; c++) {
        const struct dose_component *component = &dose->components[c];
        struct summand summand = { .values = component->values, .mask = dose->mask };
        bool is_used = false;
        for (size_t r = 0; r < choice->n_rows; r++) {
            struct dose_factors factors = dose_factors_of(dose, choice->shown, choice->quantity, &choice->rows[r],
                                                          choice->blood_ppm + choice->parts[part].more_ppm);
            double factor = factors.of[component->quantity] * choice->parts[part].factor * unit;
            bool is_in = dose_is_summed(dose, choice->shown, choice->quantity)
                             ? dose_is_summand(component->quantity)
                             : component->quantity == choice->quantity;
            is_used |= is_in;
            summand.factor[r] = (float)(factor * component->values->slope);
            summand.offset[r] = (float)(factor * component->values->offset);
        }
        if (!is_used)
            continue;
        if (!filling->grid || is_finer(&component->values->grid, filling->grid))
            filling->grid = &component->values->grid;
        filling->summands[filling->n++] = summand;
    }
    if (filling->n > n_before)
        return true;
    if (choice->shown == DOSE_SHOWN_QUANTITY)
        return error_set(err, ERROR_NOT_FOUND, "dose \"%s\" has no %s", dose->id,
                         choice->quantity == DOSE_TOTAL ? "total, and no components to sum"
                                                        : dose_quantity_word(choice->quantity));
    return error_set(err, ERROR_NOT_FOUND, "dose \"%s\" has no physical components that could be weighted", dose->id);
}

struct dose_filling *dose_filling_create(const struct plan *plan, const struct dose_choice *choice, struct error *err)
{
    struct dose_filling *filling = mem_array(1, sizeof *filling, UINT64_MAX, err);
    bool is_good = filling != NULL;
    for (size_t p = next_part(choice, 0); is_good && p < choice->n_parts;
         p = next_part(choice, choice->parts[p].dose + 1))
        is_good = list_part(filling, plan, choice, p, err);
    if (is_good) {
        note_grids(filling);
        return filling;
    }
    dose_filling_destroy(filling);
    return NULL;
}

const struct grid *dose_filling_grid(const struct dose_filling *filling, bool *is_resampled)
{
    *is_resampled = filling->is_resampled;
    return filling->grid;
}

bool dose_filling_start(struct dose_filling *filling, struct volume *const *rows, size_t n_rows,
                        struct dose_bricks *near, struct error *err)
{
    size_t n = 1;
    for (; filling->n_rows < n_rows; filling->n_rows++)
        filling->rows[filling->n_rows] = volume_ref(rows[filling->n_rows]);
    filling->near = near;
    for (int axis = 0; axis < 3; axis++)
        n *= filling->n_bricks[axis] = dose_n_bricks(filling->grid, axis);
    filling->claimed = mem_array(n, sizeof *filling->claimed, UINT64_MAX, err);
    filling->done = filling->claimed ? mem_array(n, sizeof *filling->done, UINT64_MAX, err) : NULL;
    return filling->done != NULL;
}

void dose_filling_destroy(struct dose_filling *filling)
{
    if (!filling)
        return;
    for (size_t r = 0; r < filling->n_rows; r++)
        volume_unref(filling->rows[r]);
    if (filling->near)
        derive_result_unref(&filling->near->base);
    free((void *)filling->claimed);
    free((void *)filling->done);
    free(filling);
}

/* ---- sums ------------------------------------------------------------------------------------------------------- */

/* The raw values of n voxels from i on in a row of voxels; NaN where there is none. */
static void read_run(const struct summand *summand, const struct grid *grid, uint32_t i, uint32_t j, uint32_t k,
                     uint32_t n, float *raw)
{
    const struct volume *values = summand->values;
    const size_t first = i + grid->size[0] * (j + (size_t)grid->size[1] * k);
    if (!summand->is_on_grid) {
        for (uint32_t l = 0; l < n; l++) {
            double value;
            raw[l] = volume_sample(values, affine_point(&grid->lps_mm_from_ijk, vec3(i + l, j, k)), &value)
                         ? (float)((value - values->offset) / values->slope)
                         : NAN;
        }
    } else
        switch (values->type) {
        case VOXEL_U8:
            for (size_t l = 0; l < n; l++)
                raw[l] = (float)((const uint8_t *)values->voxels)[first + l];
            break;
        case VOXEL_U16:
            for (size_t l = 0; l < n; l++)
                raw[l] = (float)((const uint16_t *)values->voxels)[first + l];
            break;
        case VOXEL_I16:
            for (size_t l = 0; l < n; l++)
                raw[l] = (float)((const int16_t *)values->voxels)[first + l];
            break;
        case VOXEL_F32: memcpy(raw, (const float *)values->voxels + first, n * sizeof *raw); break;
        }
    for (uint32_t l = 0; summand->mask && l < n; l++) {
        uint32_t at[3] = { i + l, j, k };
        if (!(summand->is_mask_on_grid ||
              volume_voxel_at(summand->mask, affine_point(&grid->lps_mm_from_ijk, vec3(i + l, j, k)), at)) ||
            volume_label(summand->mask, at[0], at[1], at[2]) == 0)
            raw[l] = NAN;
    }
}

/* The work of one call. */
struct need {
    struct dose_filling *filling;
    bool is_all;       /* all rows, also in bricks without a univel that reads them */
    bool is_streaming; /* more than a cache holds */
    const struct dose_part *part;
    uint32_t first[3], last[3];         /* bricks */
    atomic_size_t next;                 /* the next line of bricks along i */
    atomic_size_t n_missed;             /* rows of bricks that another call combines, or has */
    float ranges[64][DOSE_MAX_ROWS][2]; /* by thread */
};

/* Voxels i0 .. i1 - 1 of a row of voxels. */
static void combine_line(struct need *need, int thread, uint32_t rows, uint32_t i0, uint32_t i1, uint32_t j, uint32_t k)
{
    const struct dose_filling *filling = need->filling;
    const struct grid *grid = filling->grid;
    const float *raw[MAX_SUMMANDS];
    float factor[MAX_SUMMANDS], offset[MAX_SUMMANDS], read[RUN];
    for (uint32_t i = i0, n; i < i1; i += n) {
        n = i1 - i < RUN ? i1 - i : RUN;
        const size_t at = i + grid->size[0] * (j + (size_t)grid->size[1] * k);
        for (size_t first = 0, end; first < filling->n; first = end) {
            /* as many as can be read in place, or up to one that must be converted */
            bool has_read = false;
            for (end = first; end < filling->n; end++) {
                const struct summand *summand = &filling->summands[end];
                const bool is_in_place = summand->is_on_grid && !summand->mask && summand->values->type == VOXEL_F32;
                if (!is_in_place && has_read)
                    break;
                if (!is_in_place)
                    read_run(summand, grid, i, j, k, n, read);
                has_read |= !is_in_place;
                raw[end - first] = is_in_place ? (const float *)summand->values->voxels + at : read;
            }
            for (uint32_t r = 0; r < filling->n_rows; r++) {
                if (!(rows >> r & 1))
                    continue;
                size_t n_terms = 0;
                float *sum = (float *)filling->rows[r]->voxels + at;
                for (size_t s = first; s < end; s++, n_terms++) {
                    factor[n_terms] = filling->summands[s].factor[r];
                    offset[n_terms] = filling->summands[s].offset[r];
                }
                dose_combine(raw, factor, offset, n_terms, n, first > 0 ? sum : NULL, sum,
                             need->is_streaming && end == filling->n && first == 0,
                             end == filling->n ? need->ranges[thread][r] : (float[2]){ 0, 0 });
            }
        }
    }
}

static void combine_bricks(struct need *need, int thread, uint32_t rows, uint32_t x0, uint32_t x1, uint32_t y,
                           uint32_t z)
{
    const uint32_t *size = need->filling->grid->size;
    const uint32_t i1 = (x1 + 1) * DOSE_BRICK_I < size[0] ? (x1 + 1) * DOSE_BRICK_I : size[0];
    for (uint32_t k = z * DOSE_BRICK_K; k < (z + 1) * DOSE_BRICK_K && k < size[2]; k++)
        for (uint32_t j = y * DOSE_BRICK_J; j < (y + 1) * DOSE_BRICK_J && j < size[1]; j++)
            combine_line(need, thread, rows, x0 * DOSE_BRICK_I, i1, j, k);
    if (need->is_streaming)
        dose_combine_flush();
}

/* The rows of a brick that the call reads. */
static uint32_t rows_wanted(const struct need *need, uint32_t x, uint32_t y, uint32_t z)
{
    const struct dose_filling *filling = need->filling;
    const uint32_t all = filling->n_rows == 32 ? UINT32_MAX : (1u << filling->n_rows) - 1;
    if (need->is_all)
        return all;
    if (need->part && need->part->is_plane && !dose_brick_meets(need->part, x, y, z))
        return 0;
    if (!filling->near)
        return all;
    return filling->near->rows[x + filling->n_bricks[0] * (y + (size_t)filling->n_bricks[1] * z)];
}

/* Combines what no thread has claimed of a line of bricks: neighbours with the same rows at once. */
static void fill_line(struct need *need, int thread, uint32_t y, uint32_t z)
{
    struct dose_filling *filling = need->filling;
    uint32_t fresh[VOLUME_MAX_SIDE / DOSE_BRICK_I];
    const size_t line = filling->n_bricks[0] * (y + (size_t)filling->n_bricks[1] * z);
    for (uint32_t x = need->first[0]; x <= need->last[0]; x++) {
        const uint32_t wanted = rows_wanted(need, x, y, z);
        fresh[x] = wanted;
        if (wanted)
            fresh[x] &= ~atomic_fetch_or(&filling->claimed[line + x], wanted);
        if (fresh[x] != wanted)
            atomic_fetch_add(&need->n_missed, 1);
    }
    for (uint32_t x = need->first[0], end; x <= need->last[0]; x = end) {
        for (end = x + 1; end <= need->last[0] && fresh[end] == fresh[x]; end++)
            ;
        if (fresh[x])
            combine_bricks(need, thread, fresh[x], x, end - 1, y, z);
        for (uint32_t at = x; fresh[x] && at < end; at++)
            atomic_fetch_or_explicit(&filling->done[line + at], fresh[x], memory_order_release);
    }
}

static void fill_some(void *context, int part, int n_parts)
{
    struct need *need = context;
    const size_t n_y = need->last[1] - need->first[1] + 1, n = n_y * (need->last[2] - need->first[2] + 1);
    (void)n_parts;
    for (uint32_t r = 0; r < DOSE_MAX_ROWS; r++) {
        need->ranges[part][r][0] = INFINITY;
        need->ranges[part][r][1] = -INFINITY;
    }
    for (size_t line; (line = atomic_fetch_add(&need->next, 1)) < n;)
        fill_line(need, part, need->first[1] + (uint32_t)(line % n_y), need->first[2] + (uint32_t)(line / n_y));
}

/* How many bricks lack a row that the call reads. */
static size_t count_missing(const struct need *need)
{
    const struct dose_filling *filling = need->filling;
    size_t n = 0;
    for (uint32_t z = need->first[2]; z <= need->last[2]; z++)
        for (uint32_t y = need->first[1]; y <= need->last[1]; y++)
            for (uint32_t x = need->first[0]; x <= need->last[0]; x++) {
                const size_t at = x + filling->n_bricks[0] * (y + (size_t)filling->n_bricks[1] * z);
                const uint32_t wanted = rows_wanted(need, x, y, z);
                n += (atomic_load_explicit(&filling->done[at], memory_order_acquire) & wanted) != wanted;
            }
    return n;
}

static void measure(struct need *need, int n_threads)
{
    struct dose_filling *filling = need->filling;
    for (size_t r = 0; r < filling->n_rows; r++) {
        if (atomic_load(&need->n_missed) > 0) {
            volume_measure(filling->rows[r]);
            continue;
        }
        double low = INFINITY, high = -INFINITY;
        for (int t = 0; t < n_threads; t++) {
            low = fmin(low, (double)need->ranges[t][r][0]);
            high = fmax(high, (double)need->ranges[t][r][1]);
        }
        filling->rows[r]->low = low <= high ? low : 0;
        filling->rows[r]->high = low <= high ? high : 0;
    }
}

void dose_filling_need(struct dose_filling *filling, const struct dose_part *part)
{
    if (atomic_load_explicit(&filling->is_complete, memory_order_acquire))
        return;
    struct need need = { .filling = filling, .part = part };
    if (!dose_bricks_around(filling->grid, part->low_ijk, part->high_ijk, need.first, need.last))
        return;
    const size_t n = count_missing(&need);
    const int n_threads = n < FEW_BRICKS ? 1 : parallel_cores();
    need.is_streaming = n > MANY_BRICKS;
    if (n > 0)
        parallel_run(n_threads, fill_some, &need);
    while (n > 0 && count_missing(&need) > 0)
        sched_yield(); /* another thread has some of them in hand */
}

bool dose_filling_is_complete(const struct dose_filling *filling)
{
    return atomic_load_explicit(&filling->is_complete, memory_order_acquire);
}

void dose_filling_complete(struct dose_filling *filling)
{
    struct need need = { .filling = filling, .is_all = true, .is_streaming = true };
    if (atomic_exchange(&filling->is_completing, true)) {
        while (!dose_filling_is_complete(filling))
            sched_yield();
        return;
    }
    for (int axis = 0; axis < 3; axis++)
        need.last[axis] = filling->n_bricks[axis] - 1;
    parallel_run(parallel_cores(), fill_some, &need);
    while (count_missing(&need) > 0)
        sched_yield();
    measure(&need, parallel_cores());
    atomic_store_explicit(&filling->is_complete, true, memory_order_release);
}
