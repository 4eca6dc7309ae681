/* Builds histograms of doses: a layer's regions in one sweep, and the union of regions on several layers by its mask.
 */
#include "core/derive/dose_histogram.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/mask.h"

/* The regions of a layer, each alone; or one region with its descendants on all layers. Zeroed before it is filled. */
struct histogram_recipe {
    struct derive_recipe base;
    struct dose_choice choice;
    uint32_t layer;
    int per_side;
    bool is_union;
    size_t region; /* of a union */
};

struct dose_histograms {
    struct derive_result base;
    size_t n;          /* the plan's regions; 1 for a union */
    struct dvh dvhs[]; /* by region index; empty ones for regions of other layers */
};

static bool is_equal(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct histogram_recipe *a = (const struct histogram_recipe *)left,
                                  *b = (const struct histogram_recipe *)right;
    return a->layer == b->layer && a->per_side == b->per_side && a->is_union == b->is_union && a->region == b->region &&
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

/* The rows of weights on a layer's grid; one reference. */
static struct volume *rows_on(const struct grid *grid, const struct volume *rows, struct error *err)
{
    if (grid_is_same(grid, &rows->grid))
        return volume_ref(rows);
    struct moving moving = { rows, volume_create_unset(grid, VOXEL_U8, err) };
    if (moving.to)
        parallel_run(parallel_cores(), move_some, &moving);
    return moving.to;
}

/* 1 in the region and its descendants. */
static struct volume *union_labels(const struct region_set *set, size_t region, struct error *err)
{
    struct mask *mask = mask_from_region(set, region, 0, err);
    struct volume *labels = mask ? volume_create(&set->layers[set->regions[region].layer]->grid, VOXEL_U8, err) : NULL;
    for (uint32_t k = mask ? mask->low_k : 0; labels && k < mask->end_k; k++)
        for (uint32_t j = mask->low_j; j < mask->end_j; j++) {
            const uint64_t *row = mask->bits + (j + (size_t)k * mask->size[1]) * mask->words;
            uint8_t *to = (uint8_t *)labels->voxels + mask->size[0] * (j + (size_t)mask->size[1] * k);
            for (uint32_t w = 0; w < mask->words; w++)
                for (uint64_t bits = row[w]; bits; bits &= bits - 1)
                    to[64 * w + (uint32_t)__builtin_ctzll(bits)] = 1;
        }
    mask_destroy(mask);
    return labels;
}

static bool sweep(const struct region_set *set, const struct histogram_recipe *recipe, const struct dose_field *field,
                  const struct volume *labels, struct dose_histograms *histograms, struct error *err)
{
    struct dvh_label *wanted = mem_array(histograms->n, sizeof *wanted, UINT64_MAX, err);
    struct dvh *found = mem_array(histograms->n, sizeof *found, UINT64_MAX, err);
    struct volume *row_of = field->tissue ? rows_on(&labels->grid, field->tissue->rows, err) : NULL;
    const struct volume *rows[DOSE_MAX_ROWS];
    struct dvh_sweep how = { .labels = labels, .rows = rows, .n_rows = field->n_rows, .row_of = row_of };
    size_t n = 0;
    bool is_good = wanted && found && (row_of || !field->tissue);
    for (size_t r = 0; r < field->n_rows; r++)
        rows[r] = field->rows[r];
    if (is_good && recipe->is_union)
        wanted[n++] = (struct dvh_label){ 1, recipe->per_side };
    for (size_t r = 0; is_good && !recipe->is_union && r < set->n_regions; r++)
        if (set->regions[r].layer == recipe->layer)
            wanted[n++] = (struct dvh_label){ set->regions[r].label, recipe->per_side };
    is_good = is_good && dvh_sweep(&how, wanted, n, found, err);
    for (size_t r = 0, at = 0; is_good && r < histograms->n; r++)
        if (recipe->is_union || set->regions[r].layer == recipe->layer) {
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
    size_t n = recipe->is_union ? 1 : set->n_regions;
    (void)way;
    struct dose_field *field = dose_field_get(derive, &recipe->choice, err);
    struct volume *labels = !field             ? NULL
                            : recipe->is_union ? union_labels(set, recipe->region, err)
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
                                   int per_side, const size_t *union_region, struct error *err)
{
    struct histogram_recipe recipe;
    memset(&recipe, 0, sizeof recipe);
    recipe.base = (struct derive_recipe){ &kind, { SUBJECT_DOSE, choice->parts[0].dose, 0 } };
    recipe.choice = *choice;
    recipe.layer = layer;
    recipe.per_side = per_side;
    recipe.is_union = union_region != NULL;
    recipe.region = union_region ? *union_region : 0;
    return (struct dose_histograms *)derive_get(derive, &recipe.base, NULL, err);
}

/* Univels of regions on one layer never overlap, so that their counts add up; on several they may. */
static bool is_on_one_layer(const struct region_set *set, const size_t *members, size_t n)
{
    const struct volume *layer = set->layers[set->regions[members[0]].layer];
    for (size_t i = 1; i < n; i++) {
        const struct volume *other = set->layers[set->regions[members[i]].layer];
        if (other != layer && grid_is_same(&other->grid, &layer->grid))
            return false;
    }
    return true;
}

bool dose_histogram_get(struct derive *derive, const struct dose_choice *choice, size_t region, bool with_descendants,
                        int per_side, struct dvh *dvh, struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    size_t *members = mem_array(set->n_regions, sizeof *members, UINT64_MAX, err), n = 1;
    memset(dvh, 0, sizeof *dvh);
    if (!members)
        return false;
    members[0] = region;
    if (with_descendants)
        n = region_with_descendants(set, region, members);
    bool is_union = !is_on_one_layer(set, members, n);
    uint32_t layer = set->regions[region].layer;
    struct dose_histograms *histograms = get(derive, choice, layer, per_side, is_union ? &region : NULL, err);
    bool is_good = histograms != NULL;
    if (is_good && is_union)
        is_good = dvh_add(dvh, &histograms->dvhs[0], err);
    for (size_t i = 0; is_good && !is_union && i < n; i++)
        is_good = set->regions[members[i]].layer != layer || dvh_add(dvh, &histograms->dvhs[members[i]], err);
    if (histograms)
        derive_result_unref(&histograms->base);
    free(members);
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
            volume_cm3 += set->regions[r].layer == l ? set->regions[r].volume_cm3 : 0;
        if (volume_cm3 > most) {
            most = volume_cm3;
            *layer = l;
        }
    }
    struct dose_histograms *histograms = get(derive, choice, (uint32_t)*layer, 1, NULL, err);
    bool is_good = histograms != NULL;
    for (size_t r = 0; is_good && r < set->n_regions; r++)
        is_good = set->regions[r].layer != *layer || dvh_add(dvh, &histograms->dvhs[r], err);
    if (histograms)
        derive_result_unref(&histograms->base);
    if (!is_good)
        dvh_finish(dvh);
    return is_good;
}
