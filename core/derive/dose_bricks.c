/* Notes which rows of weights are needed in each brick of a dose's grid. */
#include "core/derive/dose_bricks.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

struct bricks_recipe {
    struct derive_recipe base;
    struct grid grid;
    uint8_t row_of_region[REGION_MAX];
};

bool dose_bricks_around(const struct grid *grid, const double low_ijk[3], const double high_ijk[3], uint32_t first[3],
                        uint32_t last[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double end = grid->size[axis] - 1.0;
        if (!(low_ijk[axis] <= end + 0.75 && high_ijk[axis] >= -0.75)) /* outer faces, and rounding */
            return false;
        first[axis] = (uint32_t)fmin(fmax(floor(low_ijk[axis] - 0.01), 0), end) / dose_brick_side(axis);
        last[axis] = (uint32_t)fmin(fmax(ceil(high_ijk[axis] + 0.01), 0), end) / dose_brick_side(axis);
    }
    return true;
}

bool dose_brick_meets(const struct dose_part *plane, uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t brick[3] = { x, y, z };
    double height = -plane->position, reach = 1e-6;
    for (int axis = 0; axis < 3; axis++) {
        const double half = (dose_brick_side(axis) - 1) / 2.0;
        height += plane->normal[axis] * (brick[axis] * dose_brick_side(axis) + half);
        reach += fabs(plane->normal[axis]) * (half + 1);
    }
    return fabs(height) <= reach;
}

/* ---- tissues ---------------------------------------------------------------------------------------------------- */

struct noting {
    const struct grid *grid;
    const struct volume *tissue;
    const uint32_t *n;
    _Atomic uint32_t *rows;
    struct affine ijk_from_tissue;
    double half[3]; /* of a box of three univels in the dose's grid: surfaces are up to a univel off theirs */
};

/* A run of univels of one row: indices i0 .. i1 of a line. It is split into pieces that are not much longer than a
 * brick. */
static void note_run(const struct noting *noting, uint32_t i0, uint32_t i1, uint32_t j, uint32_t k, uint8_t row)
{
    enum { PIECE = 16 };
    for (uint32_t from = i0; from <= i1; from += PIECE) {
        uint32_t to = from + PIECE - 1 < i1 ? from + PIECE - 1 : i1, first[3], last[3];
        struct vec3 a = affine_point(&noting->ijk_from_tissue, vec3(from, j, k)),
                    b = affine_point(&noting->ijk_from_tissue, vec3(to, j, k));
        const double p[3] = { a.x, a.y, a.z }, q[3] = { b.x, b.y, b.z };
        double low[3], high[3];
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(p[axis], q[axis]) - noting->half[axis];
            high[axis] = fmax(p[axis], q[axis]) + noting->half[axis];
        }
        if (!dose_bricks_around(noting->grid, low, high, first, last))
            continue;
        for (uint32_t z = first[2]; z <= last[2]; z++)
            for (uint32_t y = first[1]; y <= last[1]; y++)
                for (uint32_t x = first[0]; x <= last[0]; x++) {
                    _Atomic uint32_t *bits = &noting->rows[x + noting->n[0] * (y + (size_t)noting->n[1] * z)];
                    if (!(atomic_load_explicit(bits, memory_order_relaxed) >> row & 1))
                        atomic_fetch_or_explicit(bits, 1u << row, memory_order_relaxed);
                }
    }
}

static void note_some(void *context, int part, int n_parts)
{
    const struct noting *noting = context;
    const struct grid *grid = &noting->tissue->grid;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++) {
            const uint8_t *rows =
                (const uint8_t *)noting->tissue->voxels + grid->size[0] * (j + (size_t)grid->size[1] * k);
            for (uint32_t i = 0, end; i < grid->size[0]; i = end) {
                for (end = i + 1; end < grid->size[0] && rows[end] == rows[i]; end++)
                    ;
                if (rows[i] != DOSE_NO_ROW)
                    note_run(noting, i, end - 1, j, k, rows[i]);
            }
        }
}

static void note(struct dose_bricks *bricks, const struct grid *grid, const struct volume *tissue)
{
    const struct affine *to_index = &grid->ijk_from_lps_mm, *to_lps = &tissue->grid.lps_mm_from_ijk;
    struct noting noting = { .grid = grid, .tissue = tissue, .n = bricks->n, .rows = bricks->rows };
    for (int c = 0; c < 3; c++) {
        struct vec3 column = affine_vector(to_index, to_lps->columns[c]);
        noting.ijk_from_tissue.columns[c] = column;
        noting.half[0] += 1.5 * fabs(column.x);
        noting.half[1] += 1.5 * fabs(column.y);
        noting.half[2] += 1.5 * fabs(column.z);
    }
    noting.ijk_from_tissue.origin = affine_point(to_index, to_lps->origin);
    parallel_run(parallel_cores(), note_some, &noting);
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    const struct bricks_recipe *left = (const struct bricks_recipe *)a, *right = (const struct bricks_recipe *)b;
    return memcmp(left->row_of_region, right->row_of_region, REGION_MAX) == 0 &&
           memcmp(&left->grid, &right->grid, sizeof left->grid) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    free((void *)((struct dose_bricks *)base)->rows);
    free(base);
}

static const struct derive_kind kind = {
    .recipe_size = sizeof(struct bricks_recipe), .is_equal = is_equal, .build = build, .destroy = destroy
};

/* way: the tissues. */
static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct grid *grid = &((const struct bricks_recipe *)base)->grid;
    struct dose_bricks *bricks = mem_array(1, sizeof *bricks, UINT64_MAX, err);
    size_t n = 1;
    (void)derive;
    if (!bricks)
        return NULL;
    for (int axis = 0; axis < 3; axis++)
        n *= bricks->n[axis] = dose_n_bricks(grid, axis);
    bricks->rows = mem_array(n, sizeof *bricks->rows, UINT64_MAX, err);
    derive_result_init(&bricks->base, &kind, sizeof *bricks + n * sizeof *bricks->rows);
    if (!bricks->rows) {
        destroy(&bricks->base);
        return NULL;
    }
    note(bricks, grid, ((const struct tissue_rows *)way)->rows);
    return &bricks->base;
}

struct dose_bricks *dose_bricks_get(struct derive *derive, const struct dose_choice *choice, const struct grid *grid,
                                    const struct tissue_rows *tissue, struct error *err)
{
    struct bricks_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base.kind = &kind;
    recipe.base.subject = (struct subject){ SUBJECT_DOSE, choice->parts[0].dose, 0 };
    recipe.grid = *grid;
    memcpy(recipe.row_of_region, choice->row_of_region, REGION_MAX);
    return (struct dose_bricks *)derive_get(derive, &recipe.base, tissue, err);
}
