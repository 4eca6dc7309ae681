/* Builds histograms of doses: a layer's regions in one sweep, and a region whose population is not its label alone by
 * itself. */
#include "core/derive/dose_histogram.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* The regions of a layer, each by its label; or one region by its population. Zeroed before it is filled. */
struct histogram_recipe {
    struct derive_recipe base;
    struct dose_choice choice;
    uint32_t layer;
    int per_side;
    enum dose_weighing weighing;
    bool is_alone; /* one region */
    size_t region;
    enum region_population population; /* of the one region */
};

struct dose_histograms {
    struct derive_result base;
    size_t n;          /* the plan's regions; 1 for a region alone */
    struct dvh dvhs[]; /* by region index; empty ones for regions of other layers */
};

static bool is_equal(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct histogram_recipe *a = (const struct histogram_recipe *)left,
                                  *b = (const struct histogram_recipe *)right;
    return a->layer == b->layer && a->per_side == b->per_side && a->weighing == b->weighing &&
           a->is_alone == b->is_alone && a->region == b->region && a->population == b->population &&
           memcmp(&a->choice, &b->choice, sizeof a->choice) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    struct dose_histograms *histograms = (struct dose_histograms *)base;
    for (size_t i = 0; i < histograms->n; i++)
        dvh_finish(&histograms->dvhs[i]);
    free(histograms);
}

static const struct derive_kind kind = { sizeof(struct histogram_recipe), is_equal, build, destroy };

/* ---- what is swept ---------------------------------------------------------------------------------------------- */

struct moving {
    const struct volume *from;
    struct volume *to;
};

static void move_some(void *context, int part, int n_parts)
{
    const struct moving *moving = context;
    const struct grid *grid = &moving->to->grid;
    uint8_t *to = moving->to->voxels;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                uint32_t at[3];
                to[i + (size_t)grid->size[0] * (j + (size_t)grid->size[1] * k)] =
                    volume_voxel_at(moving->from, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)), at)
                        ? (uint8_t)volume_label(moving->from, at[0], at[1], at[2])
                        : DOSE_NO_ROW;
            }
}

/* The rows of weights by tissue on a layer's grid; one reference. */
static struct volume *rows_of_tissue(const struct grid *grid, const struct volume *rows, struct error *err)
{
    if (grid_is_same(grid, &rows->grid))
        return volume_ref(rows);
    struct moving moving = { rows, volume_create_unset(grid, VOXEL_U8, err) };
    if (moving.to)
        parallel_run(parallel_cores(), move_some, &moving);
    return moving.to;
}

enum { N_LABELS = 65536 };

struct naming {
    const struct volume *labels;
    const uint8_t *row_of_label; /* [N_LABELS] */
    struct volume *rows;
};

static void name_some(void *context, int part, int n_parts)
{
    const struct naming *naming = context;
    size_t n = grid_n_voxels(&naming->labels->grid), from = n / (size_t)n_parts * (size_t)part,
           to = part + 1 == n_parts ? n : n / (size_t)n_parts * (size_t)(part + 1);
    uint8_t *rows = naming->rows->voxels;
    if (naming->labels->type == VOXEL_U8)
        for (size_t i = from; i < to; i++)
            rows[i] = naming->row_of_label[((const uint8_t *)naming->labels->voxels)[i]];
    else
        for (size_t i = from; i < to; i++)
            rows[i] = naming->row_of_label[((const uint16_t *)naming->labels->voxels)[i]];
}

/* The row of each univel's region on a layer; one reference. */
static struct volume *rows_of_labels(const struct region_set *set, const struct histogram_recipe *recipe,
                                     const struct volume *labels, struct error *err)
{
    uint8_t *row_of_label = mem_array(N_LABELS, 1, UINT64_MAX, err);
    struct volume *rows = row_of_label ? volume_create_unset(&labels->grid, VOXEL_U8, err) : NULL;
    if (rows) {
        memset(row_of_label, DOSE_NO_ROW, N_LABELS);
        for (size_t r = 0; r < set->n_regions; r++)
            if (set->regions[r].layer == recipe->layer)
                row_of_label[set->regions[r].label] = recipe->choice.row_of_region[r];
        struct naming naming = { labels, row_of_label, rows };
        parallel_run(parallel_cores(), name_some, &naming);
    }
    free(row_of_label);
    return rows;
}

static bool sweep(const struct region_set *set, const struct histogram_recipe *recipe, const struct dose_field *field,
                  const struct volume *labels, struct dose_histograms *histograms, struct error *err)
{
    struct dvh_label *wanted = mem_array(histograms->n, sizeof *wanted, UINT64_MAX, err);
    struct dvh *found = mem_array(histograms->n, sizeof *found, UINT64_MAX, err);
    bool is_by_region = recipe->weighing == DOSE_BY_REGION && !recipe->choice.is_everywhere,
         has_rows = field->tissue && !(is_by_region && recipe->is_alone);
    struct volume *row_of = !has_rows      ? NULL
                            : is_by_region ? rows_of_labels(set, recipe, labels, err)
                                           : rows_of_tissue(&labels->grid, field->tissue->rows, err);
    const struct volume *rows[DOSE_MAX_ROWS];
    struct dvh_sweep how = { .labels = labels, .rows = rows, .n_rows = field->n_rows, .row_of = row_of };
    size_t n = 0;
    bool is_good = wanted && found && (row_of || !has_rows);
    for (size_t r = 0; r < field->n_rows; r++)
        rows[r] = field->rows[r];
    if (is_by_region && recipe->is_alone) {
        rows[0] = field->rows[recipe->choice.row_of_region[recipe->region]];
        how.n_rows = 1;
    }
    if (is_good && recipe->is_alone)
        wanted[n++] = (struct dvh_label){ 1, recipe->per_side };
    for (size_t r = 0; is_good && !recipe->is_alone && r < set->n_regions; r++)
        if (set->regions[r].layer == recipe->layer)
            wanted[n++] = (struct dvh_label){ set->regions[r].label, recipe->per_side };
    is_good = is_good && dvh_sweep(&how, wanted, n, found, err);
    for (size_t r = 0, at = 0; is_good && r < histograms->n; r++)
        if (recipe->is_alone || set->regions[r].layer == recipe->layer) {
            histograms->dvhs[r] = found[at++];
            histograms->base.n_bytes += histograms->dvhs[r].n_bins * sizeof(double);
        }
    volume_unref(row_of);
    free(wanted);
    free(found);
    return is_good;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct histogram_recipe *recipe = (const struct histogram_recipe *)base;
    const struct region_set *set = &derive_plan(derive)->regions;
    size_t n = recipe->is_alone ? 1 : set->n_regions;
    (void)way;
    struct dose_field *field = dose_field_get(derive, &recipe->choice, err);
    struct volume *labels = !field             ? NULL
                            : recipe->is_alone ? population_labels(set, recipe->region, recipe->population, err)
                                               : volume_ref(set->layers[recipe->layer]);
    struct dose_histograms *histograms =
        labels ? mem_array(1, sizeof *histograms + n * sizeof histograms->dvhs[0], UINT64_MAX, err) : NULL;
    bool is_good = histograms != NULL;
    if (is_good) {
        derive_result_init(&histograms->base, &kind, sizeof *histograms + n * sizeof histograms->dvhs[0]);
        histograms->n = n;
        is_good = sweep(set, recipe, field, labels, histograms, err);
    }
    volume_unref(labels);
    if (field)
        derive_result_unref(&field->base);
    if (is_good)
        return &histograms->base;
    free(histograms);
    return NULL;
}

/* ---- what is asked for ------------------------------------------------------------------------------------------ */

static struct dose_histograms *get(struct derive *derive, const struct dose_choice *choice, uint32_t layer,
                                   int per_side, enum dose_weighing weighing, struct error *err)
{
    struct histogram_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base = (struct derive_recipe){ &kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } };
    recipe.choice = *choice;
    recipe.layer = layer;
    recipe.per_side = per_side;
    recipe.weighing = weighing;
    return (struct dose_histograms *)derive_get(derive, &recipe.base, NULL, err);
}

static struct dose_histograms *get_alone(struct derive *derive, const struct dose_choice *choice, size_t region,
                                         enum region_population population, enum dose_weighing weighing, int per_side,
                                         struct error *err)
{
    struct histogram_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base = (struct derive_recipe){ &kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } };
    recipe.choice = *choice;
    recipe.layer = derive_plan(derive)->regions.regions[region].layer;
    recipe.per_side = per_side;
    recipe.weighing = weighing;
    recipe.is_alone = true;
    recipe.region = region;
    recipe.population = population;
    return (struct dose_histograms *)derive_get(derive, &recipe.base, NULL, err);
}

uint8_t dose_row_of_region(const struct region_set *set, const struct dose_choice *choice, size_t region,
                           struct error *why)
{
    uint8_t row = choice->is_everywhere ? 0 : choice->row_of_region[region];
    if (row == DOSE_NO_ROW)
        (void)error_set(why, ERROR_NOT_FOUND,
                        choice->shown == DOSE_SHOWN_ISOEFFECTIVE ? "no parameters of the isoeffective dose for %.127s"
                                                                 : "no weights for %.127s",
                        set->regions[region].name);
    return row;
}

bool dose_histogram_get(struct derive *derive, const struct dose_choice *choice, size_t region,
                        enum region_population population, enum dose_weighing weighing, int per_side, struct dvh *dvh,
                        struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    memset(dvh, 0, sizeof *dvh);
    if (dose_leaves_out(choice, region))
        return error_set(err, ERROR_STATE, "%s is not used with this dose", set->regions[region].name);
    if (weighing == DOSE_BY_REGION && dose_row_of_region(set, choice, region, err) == DOSE_NO_ROW)
        return false;
    bool is_label = population_is_label(set, region, population);
    struct dose_histograms *histograms = is_label
                                             ? get(derive, choice, set->regions[region].layer, per_side, weighing, err)
                                             : get_alone(derive, choice, region, population, weighing, per_side, err);
    if (!histograms)
        return false;
    bool is_good = dvh_add(dvh, &histograms->dvhs[is_label ? region : 0], err);
    derive_result_unref(&histograms->base);
    if (!is_good)
        dvh_finish(dvh);
    return is_good;
}

bool dose_histogram_of_body(struct derive *derive, const struct dose_choice *choice, struct dvh *dvh, size_t *layer,
                            struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    double most = -1;
    memset(dvh, 0, sizeof *dvh);
    if (set->n_layers == 0)
        return error_set(err, ERROR_NOT_FOUND, "the plan has no regions");
    for (size_t l = 0; l < set->n_layers; l++) {
        double volume_cm3 = 0;
        for (size_t r = 0; r < set->n_regions; r++)
            volume_cm3 += set->regions[r].layer == l && !dose_leaves_out(choice, r) ? set->regions[r].volume_cm3 : 0;
        if (volume_cm3 > most) {
            most = volume_cm3;
            *layer = l;
        }
    }
    struct dose_histograms *histograms = get(derive, choice, (uint32_t)*layer, 1, DOSE_BY_TISSUE, err);
    bool is_good = histograms != NULL;
    for (size_t r = 0; is_good && r < set->n_regions; r++)
        is_good =
            set->regions[r].layer != *layer || dose_leaves_out(choice, r) || dvh_add(dvh, &histograms->dvhs[r], err);
    if (histograms)
        derive_result_unref(&histograms->base);
    if (!is_good)
        dvh_finish(dvh);
    return is_good;
}
