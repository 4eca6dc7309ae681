/* Makes the field that the isodoses of a dose have in common, and the surfaces of levels in it. */
#include "core/derive/isodose_shape.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/isosurface.h"

/* ---- the rows of a dose's voxels --------------------------------------------------------------------------------- */

/* Which tissue's row holds at the centre of each voxel of a dose's grid. Kept apart from the field, as it stays the
 * same while weights and concentration change. */
struct rows_recipe {
    struct derive_recipe base;
    uint8_t row_of_region[REGION_MAX];
    enum dose_shown shown; /* with the quantity: decides which component's grid the field has */
    enum dose_quantity quantity;
};

struct voxel_rows {
    struct derive_result base;
    uint8_t *rows; /* [k][j][i]; DOSE_NO_ROW: none */
};

struct finding {
    const struct dose_field *field;
    uint8_t *rows;
};

static void find_some(void *context, int part, int n_parts)
{
    const struct finding *finding = context;
    const struct grid *grid = &finding->field->rows[0]->grid;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++) {
            uint8_t *to = finding->rows + ((size_t)k * grid->size[1] + j) * grid->size[0];
            for (uint32_t i = 0; i < grid->size[0]; i++)
                to[i] = dose_field_row(finding->field, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)));
        }
}

static bool is_equal_rows(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct rows_recipe *a = (const struct rows_recipe *)left, *b = (const struct rows_recipe *)right;
    return a->shown == b->shown && a->quantity == b->quantity &&
           memcmp(a->row_of_region, b->row_of_region, sizeof a->row_of_region) == 0;
}

static struct derive_result *build_rows(struct derive *derive, const struct derive_recipe *base, const void *field,
                                        struct error *err);

static void destroy_rows(struct derive_result *base)
{
    free(((struct voxel_rows *)base)->rows);
    free(base);
}

static const struct derive_kind rows_kind = { sizeof(struct rows_recipe), is_equal_rows, build_rows, destroy_rows };

static struct derive_result *build_rows(struct derive *derive, const struct derive_recipe *base, const void *field,
                                        struct error *err)
{
    struct finding finding = { .field = field };
    size_t n = grid_n_voxels(&finding.field->rows[0]->grid);
    (void)derive, (void)base;
    finding.rows = mem_large_array(n, 1, UINT64_MAX, err);
    if (!finding.rows)
        return NULL;
    parallel_run(parallel_cores(), find_some, &finding);
    struct voxel_rows *result = mem_new(sizeof *result);
    derive_result_init(&result->base, &rows_kind, sizeof *result + n);
    result->rows = finding.rows;
    return &result->base;
}

/* field: of the choice, with tissues. */
static struct voxel_rows *voxel_rows_get(struct derive *derive, const struct dose_choice *choice,
                                         const struct dose_field *field, struct error *err)
{
    struct rows_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base = (struct derive_recipe){ &rows_kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } };
    memcpy(recipe.row_of_region, choice->row_of_region, sizeof recipe.row_of_region);
    recipe.shown = choice->shown;
    recipe.quantity = choice->quantity;
    return (struct voxel_rows *)derive_get(derive, &recipe.base, field, err);
}

/* ---- the field --------------------------------------------------------------------------------------------------- */

struct field_recipe {
    struct derive_recipe base;
    struct dose_choice dose;
    enum isodose_grid grid;
    uint32_t reduction; /* every n-th voxel along each axis; 1: all */
};

struct isodose_field {
    struct derive_result base;
    struct volume *values;
    struct iso_bricks *bricks;
};

struct sampling {
    const struct dose_field *field;
    const uint8_t *rows; /* of the field's voxels, whose grid the values have; NULL: another grid, interpolated */
    struct volume *values;
};

static void take_rows(const struct dose_field *field, const uint8_t *rows, size_t n, size_t at, float *to)
{
    for (size_t i = 0; i < n; i++)
        to[i] = rows[at + i] == DOSE_NO_ROW ? NAN : ((const float *)field->rows[rows[at + i]]->voxels)[at + i];
}

static void sample_some(void *context, int part, int n_parts)
{
    const struct sampling *sampling = context;
    const struct grid *grid = &sampling->values->grid;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++) {
            size_t at = ((size_t)k * grid->size[1] + j) * grid->size[0];
            float *to = (float *)sampling->values->voxels + at;
            double value;
            if (sampling->rows)
                take_rows(sampling->field, sampling->rows, grid->size[0], at, to);
            for (uint32_t i = 0; !sampling->rows && i < grid->size[0]; i++)
                to[i] = dose_field_value(sampling->field, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)), &value)
                            ? (float)value
                            : NAN;
        }
}

/* The grid of univels: that of tissue_rows. NULL: the plan has none. */
static const struct grid *univel_grid(const struct plan *plan)
{
    const struct region_set *set = &plan->regions;
    const struct grid *finest = NULL;
    for (size_t i = 0; i < set->n_layers; i++)
        if (!finest || grid_voxel_mm3(&set->layers[i]->grid) < grid_voxel_mm3(finest))
            finest = &set->layers[i]->grid;
    return finest;
}

/* Makes the grid of every `reduction`-th voxel along each axis. errors those of grid_init */
static bool reduce_grid(const struct grid *full, uint32_t reduction, struct grid *reduced, struct error *err)
{
    struct affine map = full->lps_mm_from_ijk;
    uint32_t size[3];
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = (full->size[axis] - 1) / reduction + 1;
        map.columns[axis] = vec3_scale(map.columns[axis], reduction);
    }
    return grid_init(reduced, size, &map, err);
}

static struct volume *on_univels(const struct plan *plan, const struct dose_field *field, uint32_t reduction,
                                 struct error *err)
{
    const struct grid *univels = univel_grid(plan);
    struct grid grid;
    if (!univels) {
        error_set(err, ERROR_NOT_FOUND, "the plan has no univels to make isodoses on");
        return NULL;
    }
    if (!reduce_grid(univels, reduction, &grid, err))
        return NULL;
    struct sampling sampling = { field, NULL, volume_create_unset(&grid, VOXEL_F32, err) };
    if (sampling.values)
        parallel_run(parallel_cores(), sample_some, &sampling);
    return sampling.values;
}

static struct volume *on_dose(struct derive *derive, const struct dose_choice *choice, const struct dose_field *field,
                              struct error *err)
{
    if (!field->tissue)
        return volume_ref(field->rows[0]);
    struct voxel_rows *rows = voxel_rows_get(derive, choice, field, err);
    if (!rows)
        return NULL;
    struct sampling sampling = { field, rows->rows, volume_create_unset(&field->rows[0]->grid, VOXEL_F32, err) };
    if (sampling.values)
        parallel_run(parallel_cores(), sample_some, &sampling);
    derive_result_unref(&rows->base);
    return sampling.values;
}

static struct volume *reduce(const struct volume *full, uint32_t reduction, struct error *err)
{
    struct grid grid;
    struct volume *reduced =
        reduce_grid(&full->grid, reduction, &grid, err) ? volume_create_unset(&grid, VOXEL_F32, err) : NULL;
    float *to = reduced ? reduced->voxels : NULL;
    for (uint32_t k = 0; to && k < grid.size[2]; k++)
        for (uint32_t j = 0; j < grid.size[1]; j++) {
            const float *from =
                (const float *)full->voxels +
                ((size_t)k * reduction * full->grid.size[1] + (size_t)j * reduction) * full->grid.size[0];
            for (uint32_t i = 0; i < grid.size[0]; i++)
                *to++ = from[(size_t)i * reduction];
        }
    return reduced;
}

static bool is_equal_field(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct field_recipe *a = (const struct field_recipe *)left, *b = (const struct field_recipe *)right;
    return a->grid == b->grid && a->reduction == b->reduction && memcmp(&a->dose, &b->dose, sizeof a->dose) == 0;
}

static struct derive_result *build_field(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err);

static void destroy_field(struct derive_result *base)
{
    struct isodose_field *field = (struct isodose_field *)base;
    volume_unref(field->values);
    iso_bricks_destroy(field->bricks);
    free(field);
}

static const struct derive_kind field_kind = { sizeof(struct field_recipe), is_equal_field, build_field,
                                               destroy_field };

static struct isodose_field *field_get(struct derive *derive, const struct isodose_choice *choice, uint32_t reduction,
                                       struct error *err)
{
    const struct field_recipe recipe = {
        { &field_kind, { SUBJECT_DOSE, choice->dose.parts[0].dose, 0 } }, choice->dose, choice->grid, reduction
    };
    return (struct isodose_field *)derive_get(derive, &recipe.base, NULL, err);
}

/* A reduced field on the dose's grid comes from the full one. */
static struct volume *reduced_values(struct derive *derive, const struct field_recipe *recipe, struct error *err)
{
    struct isodose_choice whole;
    memset(&whole, 0, sizeof whole);
    whole.dose = recipe->dose;
    whole.grid = recipe->grid;
    struct isodose_field *full = field_get(derive, &whole, 1, err);
    struct volume *values = full ? reduce(full->values, recipe->reduction, err) : NULL;
    if (full)
        derive_result_unref(&full->base);
    return values;
}

static struct volume *values_of(struct derive *derive, const struct field_recipe *recipe, struct error *err)
{
    if (recipe->reduction > 1 && recipe->grid == ISODOSE_ON_DOSE)
        return reduced_values(derive, recipe, err);
    struct dose_field *dose = dose_field_get(derive, &recipe->dose, err);
    if (!dose)
        return NULL;
    struct volume *values = recipe->grid == ISODOSE_ON_DOSE
                                ? on_dose(derive, &recipe->dose, dose, err)
                                : on_univels(derive_plan(derive), dose, recipe->reduction, err);
    derive_result_unref(&dose->base);
    return values;
}

static struct derive_result *build_field(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err)
{
    struct volume *values = values_of(derive, (const struct field_recipe *)base, err);
    struct iso_bricks *bricks = values ? iso_bricks_create(values, 0, err) : NULL;
    (void)way;
    if (!bricks) {
        volume_unref(values);
        return NULL;
    }
    struct isodose_field *field = mem_new(sizeof *field);
    derive_result_init(&field->base, &field_kind,
                       sizeof *field + bricks->n_bytes + grid_n_voxels(&values->grid) * sizeof(float));
    field->values = values;
    field->bricks = bricks;
    return &field->base;
}

/* ---- surfaces ---------------------------------------------------------------------------------------------------- */

struct shape_recipe {
    struct derive_recipe base;
    struct isodose_choice choice;
    uint32_t reduction;
};

static bool is_equal_shape(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct shape_recipe *a = (const struct shape_recipe *)left, *b = (const struct shape_recipe *)right;
    return a->reduction == b->reduction && memcmp(&a->choice, &b->choice, sizeof a->choice) == 0;
}

static struct derive_result *build_shape(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err);

static void destroy_shape(struct derive_result *base)
{
    struct isodose_shape *result = (struct isodose_shape *)base;
    shape_unref(result->shape);
    free(result);
}

static const struct derive_kind shape_kind = { sizeof(struct shape_recipe), is_equal_shape, build_shape,
                                               destroy_shape };

/* Takes the mesh. */
static struct shape *shape_of(struct mesh *mesh)
{
    struct shape *shape = mem_new(sizeof *shape);
    atomic_init(&shape->references, 1);
    shape->kind = SHAPE_TRIANGLES;
    shape->mesh = mesh;
    shape->bounds_lps_mm = mesh->bounds_lps_mm;
    shape->n_bytes =
        sizeof *shape + sizeof *mesh + mesh->n_vertices * 6 * sizeof(float) + mesh->n_triangles * 3 * sizeof(uint32_t);
    return shape;
}

static struct derive_result *build_shape(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err)
{
    const struct shape_recipe *recipe = (const struct shape_recipe *)base;
    struct surface_options options = surface_defaults;
    int64_t began_us = clock_now_us();
    struct isodose_field *field = field_get(derive, &recipe->choice, recipe->reduction, err);
    (void)way;
    if (!field)
        return NULL;
    struct mesh *mesh =
        isosurface_make(recipe->choice.algorithm, field->values, field->bricks, recipe->choice.value, &options, err);
    derive_result_unref(&field->base);
    if (!mesh)
        return NULL;
    struct isodose_shape *result = mem_new(sizeof *result);
    result->shape = shape_of(mesh);
    result->facts = (struct shape_facts){ .reduction = recipe->reduction,
                                          .n_triangles = mesh->n_triangles,
                                          .n_vertices = mesh->n_vertices,
                                          .n_bytes = result->shape->n_bytes,
                                          .area_mm2 = NAN,
                                          .volume_mm3 = NAN,
                                          .univel_volume_mm3 = NAN,
                                          .distance_mean_mm = NAN,
                                          .distance_max_mm = NAN,
                                          .build_ms = (double)(clock_now_us() - began_us) / 1000 };
    derive_result_init(&result->base, &shape_kind, result->shape->n_bytes);
    return &result->base;
}

static struct isodose_shape *shape_get(struct derive *derive, const struct isodose_choice *choice, uint32_t reduction,
                                       struct error *err)
{
    struct shape_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base = (struct derive_recipe){ &shape_kind, { SUBJECT_DOSE, choice->dose.parts[0].dose, 0 } };
    recipe.choice = *choice;
    recipe.reduction = reduction;
    return (struct isodose_shape *)derive_get(derive, &recipe.base, NULL, err);
}

/* Reduction with which a coarse surface on univels starts: interpolating a dose at tens of millions of univels takes
 * longer than a moving picture may. */
static uint32_t univel_reduction(const struct plan *plan, const struct isodose_choice *choice)
{
    const struct grid *grid = choice->grid == ISODOSE_ON_UNIVELS ? univel_grid(plan) : NULL;
    uint32_t reduction = 1;
    while (grid && reduction < ISODOSE_MAX_REDUCTION &&
           grid_n_voxels(grid) > (size_t)ISODOSE_COARSE_UNIVELS * reduction * reduction * reduction)
        reduction++;
    return reduction;
}

struct isodose_shape *isodose_shape_get(struct derive *derive, const struct isodose_choice *choice,
                                        enum surface_detail detail, struct error *err)
{
    uint32_t reduction = detail == SURFACE_FULL ? 1 : univel_reduction(derive_plan(derive), choice);
    struct isodose_shape *made = shape_get(derive, choice, reduction, err);
    if (!made || detail == SURFACE_FULL || made->facts.n_triangles <= ISODOSE_COARSE_TRIANGLES)
        return made;
    /* triangles grow as the square of the number of voxels along an axis */
    reduction = (uint32_t)ceil(reduction * sqrt((double)made->facts.n_triangles / ISODOSE_COARSE_TRIANGLES));
    derive_result_unref(&made->base);
    return shape_get(derive, choice, reduction < ISODOSE_MAX_REDUCTION ? reduction : ISODOSE_MAX_REDUCTION, err);
}

void isodose_shape_measure(const struct isodose_shape *isodose, struct shape_facts *facts)
{
    *facts = isodose->facts;
    facts->area_mm2 = mesh_area_mm2(isodose->shape->mesh);
    if (mesh_open_edges(isodose->shape->mesh) == 0)
        facts->volume_mm3 = mesh_volume_mm3(isodose->shape->mesh);
}
