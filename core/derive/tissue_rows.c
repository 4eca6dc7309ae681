/* Finds the innermost region with weights at every univel. */
#include "core/derive/tissue_rows.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

struct tissue_recipe {
    struct derive_recipe base;
    uint8_t row_of_region[REGION_MAX];
};

/* The row that a label of a layer stands for. The greater rank wins. */
struct place {
    uint32_t rank; /* 0: no region with weights */
    uint8_t row;
};

struct painting {
    const struct region_set *set;
    const struct place *places; /* [n_layers][65536] */
    struct volume *rows;
};

enum { N_LABELS = 65536 };

/* Regions from the outermost to the innermost. */
struct order {
    size_t region;
    int depth;
    uint64_t n_voxels;
};

static int compare_orders(const void *left, const void *right)
{
    const struct order *a = left, *b = right;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels > b->n_voxels ? -1 : 1;
    return a->region < b->region ? -1 : 1;
}

static bool fill_places(const struct region_set *set, const uint8_t *row_of_region, struct place *places,
                        struct error *err)
{
    struct order *orders = mem_array(set->n_regions, sizeof *orders, UINT64_MAX, err);
    if (!orders)
        return false;
    for (size_t r = 0; r < set->n_regions; r++)
        orders[r] = (struct order){ r, region_depth(set, r), set->regions[r].n_voxels };
    qsort(orders, set->n_regions, sizeof *orders, compare_orders);
    for (size_t i = 0; i < set->n_regions; i++) {
        const struct region *region = &set->regions[orders[i].region];
        uint8_t row = row_of_region[orders[i].region];
        if (row != DOSE_NO_ROW)
            places[(size_t)region->layer * N_LABELS + region->label] = (struct place){ (uint32_t)i + 1, row };
    }
    free(orders);
    return true;
}

static void paint_row(const struct painting *painting, const struct volume *layer, const struct place *places,
                      uint32_t j, uint32_t k, uint32_t *ranks, uint8_t *rows)
{
    const struct grid *grid = &painting->rows->grid;
    bool is_same = grid_is_same(grid, &layer->grid);
    size_t first = grid->size[0] * (j + (size_t)grid->size[1] * k);
    for (uint32_t i = 0; i < grid->size[0]; i++) {
        uint16_t label = 0;
        uint32_t at[3];
        if (is_same)
            label = layer->type == VOXEL_U8 ? ((const uint8_t *)layer->voxels)[first + i]
                                            : ((const uint16_t *)layer->voxels)[first + i];
        else if (volume_voxel_at(layer, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)), at))
            label = volume_label(layer, at[0], at[1], at[2]);
        const struct place *place = &places[label];
        if (place->rank > ranks[i]) {
            ranks[i] = place->rank;
            rows[i] = place->row;
        }
    }
}

static void paint_some(void *context, int part, int n_parts)
{
    const struct painting *painting = context;
    const struct grid *grid = &painting->rows->grid;
    uint32_t ranks[VOLUME_MAX_SIDE];
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++) {
            uint8_t *rows = (uint8_t *)painting->rows->voxels + grid->size[0] * (j + (size_t)grid->size[1] * k);
            memset(ranks, 0, grid->size[0] * sizeof *ranks);
            memset(rows, DOSE_NO_ROW, grid->size[0]);
            for (size_t layer = 0; layer < painting->set->n_layers; layer++)
                paint_row(painting, painting->set->layers[layer], painting->places + layer * N_LABELS, j, k, ranks,
                          rows);
        }
}

/* The layer with the smallest voxels. */
static const struct volume *finest_layer(const struct region_set *set)
{
    const struct volume *finest = set->layers[0];
    for (size_t i = 1; i < set->n_layers; i++)
        if (grid_voxel_mm3(&set->layers[i]->grid) < grid_voxel_mm3(&finest->grid))
            finest = set->layers[i];
    return finest;
}

static bool is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    return memcmp(((const struct tissue_recipe *)a)->row_of_region, ((const struct tissue_recipe *)b)->row_of_region,
                  REGION_MAX) == 0;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    struct tissue_rows *tissue = (struct tissue_rows *)base;
    volume_unref(tissue->rows);
    free(tissue);
}

static const struct derive_kind kind = { sizeof(struct tissue_recipe), is_equal, build, destroy };

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct region_set *set = &derive_plan(derive)->regions;
    (void)way;
    struct tissue_rows *tissue = mem_array(1, sizeof *tissue, UINT64_MAX, err);
    struct place *places = mem_array(set->n_layers * N_LABELS, sizeof *places, UINT64_MAX, err);
    bool is_good = tissue && places;
    if (is_good) {
        memset(places, 0, set->n_layers * N_LABELS * sizeof *places);
        tissue->rows = volume_create_unset(&finest_layer(set)->grid, VOXEL_U8, err);
        is_good = tissue->rows && fill_places(set, ((const struct tissue_recipe *)base)->row_of_region, places, err);
    }
    if (is_good) {
        struct painting painting = { set, places, tissue->rows };
        parallel_run(parallel_cores(), paint_some, &painting);
        derive_result_init(&tissue->base, &kind, sizeof *tissue + grid_n_voxels(&tissue->rows->grid));
    } else if (tissue) {
        volume_unref(tissue->rows);
        free(tissue);
        tissue = NULL;
    }
    free(places);
    return tissue ? &tissue->base : NULL;
}

struct tissue_rows *tissue_rows_get(struct derive *derive, const uint8_t row_of_region[REGION_MAX], struct error *err)
{
    struct tissue_recipe recipe = { .base = { &kind, subject_plan() } };
    if (derive_plan(derive)->regions.n_layers == 0) {
        (void)error_set(err, ERROR_NOT_FOUND, "the plan has no regions, so no tissue has weights");
        return NULL;
    }
    memcpy(recipe.row_of_region, row_of_region, REGION_MAX);
    return (struct tissue_rows *)derive_get(derive, &recipe.base, NULL, err);
}
