/* Marks the univels of a region's population. */
#include "core/region/population.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

enum { N_LABELS = 65536 };
enum { SAMPLES_A_SIDE = 32 }; /* of the box of a region inside, to tell whether it is held */

const char *population_words(enum region_population population)
{
    return population == POPULATION_OWN ? "own univels, without regions inside" : "whole region";
}

enum region_population population_usual(const struct region_set *set)
{
    return set->n_layers > 1 ? POPULATION_WHOLE : POPULATION_OWN;
}

static bool lies_inside(const struct region_set *set, size_t region, size_t outer)
{
    for (int up = set->regions[region].parent; up >= 0; up = set->regions[up].parent)
        if ((size_t)up == outer)
            return true;
    return false;
}

static uint16_t label_at(const struct volume *layer, struct vec3 point_lps_mm)
{
    uint32_t at[3];
    return volume_voxel_at(layer, point_lps_mm, at) ? volume_label(layer, at[0], at[1], at[2]) : 0;
}

/* True if the outer region's own univels hold at least half of a region inside it on another layer. */
static bool holds(const struct region_set *set, size_t outer, size_t inner)
{
    const struct region *o = &set->regions[outer], *in = &set->regions[inner];
    const struct volume *layer = set->layers[in->layer], *around = set->layers[o->layer];
    uint64_t n = 0, n_held = 0;
    uint32_t step[3];
    for (int axis = 0; axis < 3; axis++)
        step[axis] = 1 + (in->high_ijk[axis] - in->low_ijk[axis]) / SAMPLES_A_SIDE;
    for (uint32_t k = in->low_ijk[2]; k <= in->high_ijk[2]; k += step[2])
        for (uint32_t j = in->low_ijk[1]; j <= in->high_ijk[1]; j += step[1])
            for (uint32_t i = in->low_ijk[0]; i <= in->high_ijk[0]; i += step[0])
                if (volume_label(layer, i, j, k) == in->label) {
                    n++;
                    n_held += label_at(around, affine_point(&layer->grid.lps_mm_from_ijk, vec3(i, j, k))) == o->label;
                }
    return 2 * n_held >= n;
}

/* True if a region inside changes the population: it is added to a whole one, taken from an own one. */
static bool counts(const struct region_set *set, size_t region, size_t inner, enum region_population population)
{
    bool is_same_layer = set->regions[inner].layer == set->regions[region].layer;
    if (set->regions[inner].n_voxels == 0 || !lies_inside(set, inner, region))
        return false;
    return population == POPULATION_WHOLE ? is_same_layer || !holds(set, region, inner) : !is_same_layer;
}

bool population_is_label(const struct region_set *set, size_t region, enum region_population population)
{
    for (size_t r = 0; r < set->n_regions; r++)
        if (counts(set, region, r, population))
            return false;
    return true;
}

/* ---- marking ------------------------------------------------------------------------------------------------------ */

struct marking {
    const struct volume *layer; /* with the labels looked for */
    const uint8_t *is_wanted;   /* [N_LABELS] */
    uint8_t value;
    struct volume *marks;
};

static void mark_some(void *context, int part, int n_parts)
{
    const struct marking *marking = context;
    const struct grid *grid = &marking->marks->grid;
    const struct volume *layer = marking->layer;
    bool is_same = grid_is_same(grid, &layer->grid);
    uint8_t *marks = marking->marks->voxels;
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++) {
                size_t at = i + (size_t)grid->size[0] * (j + (size_t)grid->size[1] * k);
                if (marking->value == 0 && !marks[at])
                    continue;
                uint16_t label = is_same ? volume_label(layer, i, j, k)
                                         : label_at(layer, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)));
                if (marking->is_wanted[label])
                    marks[at] = marking->value;
            }
}

/* Marks one layer's univels of the regions that count. */
static void mark_layer(const struct region_set *set, size_t region, enum region_population population, uint32_t layer,
                       uint8_t *is_wanted, struct volume *marks)
{
    bool is_own_layer = layer == set->regions[region].layer, has_any = is_own_layer;
    memset(is_wanted, 0, N_LABELS);
    if (is_own_layer)
        is_wanted[set->regions[region].label] = 1;
    for (size_t r = 0; r < set->n_regions; r++)
        if (set->regions[r].layer == layer && counts(set, region, r, population)) {
            is_wanted[set->regions[r].label] = 1;
            has_any = true;
        }
    if (!has_any)
        return;
    struct marking marking = { set->layers[layer], is_wanted, is_own_layer || population == POPULATION_WHOLE, marks };
    parallel_run(parallel_cores(), mark_some, &marking);
}

struct volume *population_labels(const struct region_set *set, size_t region, enum region_population population,
                                 struct error *err)
{
    if (region >= set->n_regions) {
        (void)error_set(err, ERROR_RANGE, "there is no region %zu of %zu", region, set->n_regions);
        return NULL;
    }
    uint32_t own_layer = set->regions[region].layer;
    uint8_t *is_wanted = mem_array(N_LABELS, 1, UINT64_MAX, err);
    struct volume *marks = is_wanted ? volume_create(&set->layers[own_layer]->grid, VOXEL_U8, err) : NULL;
    if (marks) {
        mark_layer(set, region, population, own_layer, is_wanted, marks);
        for (uint32_t layer = 0; layer < set->n_layers; layer++)
            if (layer != own_layer)
                mark_layer(set, region, population, layer, is_wanted, marks);
        marks->low = 0;
        marks->high = 1;
    }
    free(is_wanted);
    return marks;
}
