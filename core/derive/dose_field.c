/* The fields of doses: their recipe, their volumes, and values at points. What fills them: dose_filling.c. */
#include "core/derive/dose_field.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/derive/dose_filling.h"
#include "core/derive/isoeffective_rows.h"
#include "core/derive/tissue_rows.h"

struct field_recipe {
    struct derive_recipe base;
    struct dose_choice choice;
};

static void note_field(struct dose_field *field, const struct plan *plan, const struct dose_choice *choice)
{
    const struct dose *first = &plan->doses[choice->parts[0].dose];
    dose_shown_unit(&plan->doses[choice->unit_of], choice->shown, choice->quantity, field->unit);
    memcpy(field->per, first->per, sizeof field->per);
    for (size_t p = 0; p < choice->n_parts; p++)
        if (dose_is_summed(&plan->doses[choice->parts[p].dose], choice->shown, choice->quantity))
            field->missing |= dose_missing_summands(&plan->doses[choice->parts[p].dose]);
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return memcmp(&((const struct field_recipe *)a)->choice, &((const struct field_recipe *)b)->choice,
                  sizeof(struct dose_choice)) == 0;
}

/* True if only weights and blood differ, which people drag. A field with one tissue's weights everywhere, which is
 * drawn, leaves that with each tissue's own, which is counted, in place. */
static bool is_alike(const void *left, const void *right)
{
    const struct field_recipe *a = left, *b = right;
    return a->base.kind == b->base.kind && subject_equal(a->base.subject, b->base.subject) &&
           a->choice.shown == b->choice.shown && a->choice.quantity == b->choice.quantity &&
           a->choice.n_parts == b->choice.n_parts && a->choice.is_everywhere == b->choice.is_everywhere &&
           memcmp(a->choice.parts, b->choice.parts, sizeof a->choice.parts) == 0;
}

/* ---- memory of fields that are dropped -------------------------------------------------------------------------- */

/* While a value is dragged, each field takes over the memory of an older one: to get fresh memory from the system would
 * take longer than to fill it. Rows of one size are set aside, up to SPARE_BYTES. */
enum { N_SPARES = 8 };
static const size_t spare_bytes = (size_t)288 << 20;
struct spare {
    size_t n_bytes;
    void *voxels;
};
static _Atomic(struct spare *) spares[N_SPARES];

/* True if the voxels were taken over. */
static bool set_aside(void *voxels, size_t n_bytes)
{
    if (n_bytes < (size_t)1 << 20)
        return false;
    struct spare *spare = mem_new(sizeof *spare);
    *spare = (struct spare){ n_bytes, voxels };
    for (int i = 0; i < N_SPARES && ((size_t)i + 1) * n_bytes <= spare_bytes; i++) {
        struct spare *none = NULL;
        if (atomic_compare_exchange_strong(&spares[i], &none, spare))
            return true;
    }
    free(spare);
    return false;
}

/* Memory of n_bytes that was set aside, or NULL. Frees what has another size. */
static void *take_spare(size_t n_bytes)
{
    void *voxels = NULL;
    for (int i = 0; i < N_SPARES && !voxels; i++) {
        struct spare *spare = atomic_exchange(&spares[i], NULL);
        if (spare && spare->n_bytes == n_bytes)
            voxels = spare->voxels;
        else if (spare)
            free(spare->voxels);
        free(spare);
    }
    return voxels;
}

static struct volume *create_row(const struct grid *grid, struct error *err)
{
    void *voxels = take_spare(grid_n_voxels(grid) * sizeof(float));
    return voxels ? volume_take(grid, VOXEL_F32, voxels) : volume_create_unset(grid, VOXEL_F32, err);
}

/* Drops a reference; sets the voxels aside if it was the last one. */
static void drop_row(struct volume *row)
{
    if (atomic_load(&row->references) == 1 && set_aside(row->voxels, grid_n_voxels(&row->grid) * sizeof(float)))
        row->voxels = NULL;
    volume_unref(row);
}

/* ---- building --------------------------------------------------------------------------------------------------- */

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    struct dose_field *field = (struct dose_field *)base;
    dose_filling_destroy(field->filling); /* before the last reference to the rows is dropped */
    isoeffective_rows_destroy(field->exact);
    for (size_t r = 0; r < field->n_rows; r++)
        drop_row(field->rows[r]);
    if (field->tissue)
        derive_result_unref(&field->tissue->base);
    free(field);
}

static const struct derive_kind kind = {
    .recipe_size = sizeof(struct field_recipe), .is_equal = is_equal, .build = build, .destroy = destroy
};

enum { MOST_FINE_VOXELS = 24 << 20 }; /* of all rows of an isoeffective dose: 96 MiB */

static bool fill_isoeffective(struct derive *derive, struct dose_field *field, const struct dose_choice *choice,
                              struct error *err)
{
    struct grid fine;
    uint32_t factors[3];
    dose_filling_destroy(field->filling);
    field->filling = NULL;
    field->exact = isoeffective_rows_create(derive, choice, dose_field_get, err);
    if (!field->exact ||
        !isoeffective_rows_grid(field->exact, MOST_FINE_VOXELS, &fine, factors, &field->row_error, err))
        return false;
    for (; field->n_rows < choice->n_rows; field->n_rows++)
        if (!(field->rows[field->n_rows] = create_row(&fine, err)))
            return false;
    for (size_t r = 0; r < field->n_rows; r++)
        if (!isoeffective_rows_fill(field->exact, r, factors, field->rows[r], err))
            return false;
    return true;
}

static bool fill(struct derive *derive, struct dose_field *field, const struct dose_choice *choice, struct error *err)
{
    const struct plan *plan = derive_plan(derive);
    struct dose_bricks *near = NULL;
    note_field(field, plan, choice);
    field->filling = dose_filling_create(plan, choice, err);
    if (!field->filling ||
        (!choice->is_everywhere && !(field->tissue = tissue_rows_get(derive, choice->row_of_region, err))))
        return false;
    field->grid = *dose_filling_grid(field->filling, &field->is_resampled);
    if (choice->shown == DOSE_SHOWN_ISOEFFECTIVE) /* at once */
        return fill_isoeffective(derive, field, choice, err);
    const struct grid *grid = &field->grid;
    for (; field->n_rows < choice->n_rows; field->n_rows++)
        if (!(field->rows[field->n_rows] = create_row(grid, err)))
            return false;
    if (field->tissue && !(near = dose_bricks_get(derive, choice, grid, field->tissue, err)))
        return false;
    return dose_filling_start(field->filling, field->rows, field->n_rows, near, err);
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct dose_choice *choice = &((const struct field_recipe *)base)->choice;
    struct dose_field *field = mem_array(1, sizeof *field, UINT64_MAX, err);
    (void)way;
    if (!field)
        return NULL;
    derive_result_init(&field->base, &kind, 0);
    if (!fill(derive, field, choice, err)) {
        destroy(&field->base);
        return NULL;
    }
    field->base.n_bytes = sizeof *field + field->n_rows * grid_n_voxels(&field->rows[0]->grid) * sizeof(float);
    return &field->base;
}

struct dose_field *dose_field_begin(struct derive *derive, const struct dose_choice *choice, struct error *err)
{
    const struct field_recipe recipe = { { &kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } }, *choice };
    if (choice->n_rows == 0) {
        (void)error_set(err, ERROR_RANGE, "no tissue has weights: a weighted dose needs those of at least one region");
        return NULL;
    }
    struct dose_field *field = (struct dose_field *)derive_get(derive, &recipe.base, NULL, err);
    derive_drop_alike(derive, &recipe.base, is_alike);
    return field;
}

struct dose_field *dose_field_get(struct derive *derive, const struct dose_choice *choice, struct error *err)
{
    struct dose_field *field = dose_field_begin(derive, choice, err);
    if (field)
        dose_field_need_all(field);
    return field;
}

void dose_field_need_all(const struct dose_field *field)
{
    if (field->filling && !dose_filling_is_complete(field->filling))
        dose_filling_complete(field->filling);
}

void dose_field_need_box(const struct dose_field *field, const struct box3 *box_lps_mm)
{
    struct box3 box = box3_empty();
    if (!field->filling || dose_filling_is_complete(field->filling) || box3_is_empty(box_lps_mm))
        return;
    for (int corner = 0; corner < 8; corner++)
        box3_add(&box, affine_point(&field->rows[0]->grid.ijk_from_lps_mm,
                                    vec3(corner & 1 ? box_lps_mm->high.x : box_lps_mm->low.x,
                                         corner & 2 ? box_lps_mm->high.y : box_lps_mm->low.y,
                                         corner & 4 ? box_lps_mm->high.z : box_lps_mm->low.z)));
    dose_filling_need(field->filling, &(struct dose_part){ .low_ijk = { box.low.x, box.low.y, box.low.z },
                                                           .high_ijk = { box.high.x, box.high.y, box.high.z } });
}

void dose_field_need_plane(const struct dose_field *field, struct vec3 point_lps_mm, struct vec3 normal_lps)
{
    const struct grid *grid = &field->rows[0]->grid;
    const struct affine *to_lps = &grid->lps_mm_from_ijk;
    if (!field->filling || dose_filling_is_complete(field->filling))
        return;
    dose_filling_need(field->filling,
                      &(struct dose_part){ .high_ijk = { grid->size[0], grid->size[1], grid->size[2] },
                                           .is_plane = true,
                                           .normal = { vec3_dot(normal_lps, to_lps->columns[0]),
                                                       vec3_dot(normal_lps, to_lps->columns[1]),
                                                       vec3_dot(normal_lps, to_lps->columns[2]) },
                                           .position = vec3_dot(normal_lps, vec3_sub(point_lps_mm, to_lps->origin)) });
}

uint8_t dose_field_row(const struct dose_field *field, struct vec3 point_lps_mm)
{
    uint32_t at[3];
    if (!field->tissue)
        return 0;
    if (!volume_voxel_at(field->tissue->rows, point_lps_mm, at))
        return DOSE_NO_ROW;
    return (uint8_t)volume_label(field->tissue->rows, at[0], at[1], at[2]);
}

bool dose_field_value(const struct dose_field *field, struct vec3 point_lps_mm, double *value)
{
    uint8_t row = dose_field_row(field, point_lps_mm);
    if (row == DOSE_NO_ROW)
        return false;
    if (field->filling && !dose_filling_is_complete(field->filling))
        dose_field_need_box(field, &(struct box3){ point_lps_mm, point_lps_mm });
    return dose_field_value_in(field, row, point_lps_mm, value);
}

bool dose_field_value_in(const struct dose_field *field, uint8_t row, struct vec3 point_lps_mm, double *value)
{
    return field->exact ? isoeffective_rows_value(field->exact, row, point_lps_mm, value)
                        : volume_sample(field->rows[row], point_lps_mm, value);
}
