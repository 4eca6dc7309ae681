#include "core/region/body.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"

static double layer_cm3(const struct region_set *set, uint32_t layer)
{
    double sum = 0;
    for (size_t r = 0; r < set->n_regions; r++)
        sum += set->regions[r].layer == layer ? set->regions[r].volume_cm3 : 0;
    return sum;
}

/* Volume of a region and those inside it on its layer. */
static double whole_cm3(const struct region_set *set, size_t region)
{
    double sum = 0;
    for (size_t r = 0; r < set->n_regions; r++) {
        int at = (int)r;
        while (at >= 0 && (size_t)at != region)
            at = set->regions[at].parent;
        if (at >= 0 && set->regions[r].layer == set->regions[region].layer)
            sum += set->regions[r].volume_cm3;
    }
    return sum;
}

bool body_find(const struct region_set *set, struct body *body)
{
    double most = 0, most_whole = 0;
    for (uint32_t layer = 0; layer < set->n_layers; layer++) {
        double cm3 = layer_cm3(set, layer);
        if (cm3 > most) {
            most = cm3;
            body->layer = layer;
        }
    }
    body->region = -1;
    for (size_t r = 0; most > 0 && r < set->n_regions; r++) {
        double cm3 = set->regions[r].layer == body->layer ? whole_cm3(set, r) : 0;
        if (cm3 > most_whole) {
            most_whole = cm3;
            body->region = (int)r;
        }
    }
    if (most_whole < most / 2)
        body->region = -1;
    return most > 0;
}

void body_words(const struct region_set *set, const struct body *body, char words[REGION_NAME_SIZE + 32])
{
    if (body->region < 0)
        snprintf(words, REGION_NAME_SIZE + 32, "all regions of the label layer");
    else
        snprintf(words, REGION_NAME_SIZE + 32, "%s with the regions inside", set->regions[body->region].name);
}

struct volume *body_labels(const struct region_set *set, const struct body *body, struct error *err)
{
    if (body->region >= 0)
        return population_labels(set, (size_t)body->region, POPULATION_WHOLE, err);
    const struct volume *layer = set->layers[body->layer];
    uint8_t *is_region = mem_array(65536, 1, UINT64_MAX, err);
    struct volume *labels = is_region ? volume_create(&layer->grid, VOXEL_U8, err) : NULL;
    for (size_t r = 0; labels && r < set->n_regions; r++)
        if (set->regions[r].layer == body->layer && set->regions[r].n_voxels > 0)
            is_region[set->regions[r].label] = 1;
    size_t at = 0;
    for (uint32_t k = 0; labels && k < layer->grid.size[2]; k++)
        for (uint32_t j = 0; j < layer->grid.size[1]; j++)
            for (uint32_t i = 0; i < layer->grid.size[0]; i++)
                ((uint8_t *)labels->voxels)[at++] = is_region[volume_label(layer, i, j, k)];
    if (labels)
        volume_measure(labels);
    free(is_region);
    return labels;
}
