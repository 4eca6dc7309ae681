/* Looks up the regions, image values and doses at a patient point. */
#include <string.h>

#include "core/plan/plan.h"

enum { MOST_REGIONS = sizeof((struct plan_probe *)0)->regions / sizeof(size_t) };

static bool is_listed(const struct plan_probe *probe, size_t region)
{
    for (size_t i = 0; i < probe->n_regions; i++)
        if (probe->regions[i] == region)
            return true;
    return false;
}

/* The regions whose label the voxel at the point carries, and their ancestors. */
static void find_regions(const struct plan *plan, struct plan_probe *probe)
{
    const struct region_set *set = &plan->regions;
    uint16_t labels[REGION_MAX_LAYERS];
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        uint32_t at[3];
        labels[layer] = 0;
        if (volume_voxel_at(set->layers[layer], probe->point_lps_mm, at))
            labels[layer] = volume_label(set->layers[layer], at[0], at[1], at[2]);
    }
    for (size_t r = 0; r < set->n_regions; r++) {
        if (labels[set->regions[r].layer] != set->regions[r].label)
            continue;
        for (int up = (int)r; up >= 0; up = set->regions[up].parent)
            if (!is_listed(probe, (size_t)up) && probe->n_regions < MOST_REGIONS)
                probe->regions[probe->n_regions++] = (size_t)up;
    }
    for (size_t i = 1; i < probe->n_regions; i++) { /* insertion sort, innermost first, stable */
        size_t region = probe->regions[i], at = i;
        for (; at > 0 && region_depth(set, probe->regions[at - 1]) < region_depth(set, region); at--)
            probe->regions[at] = probe->regions[at - 1];
        probe->regions[at] = region;
    }
}

/* False where the dose's mask is 0, or does not reach. */
static bool dose_is_valid(const struct dose *dose, struct vec3 point_lps_mm)
{
    uint32_t at[3];
    if (!dose->mask)
        return true;
    return volume_voxel_at(dose->mask, point_lps_mm, at) && volume_label(dose->mask, at[0], at[1], at[2]) != 0;
}

void plan_probe(const struct plan *plan, struct vec3 point_lps_mm, struct plan_probe *probe)
{
    memset(probe, 0, sizeof *probe);
    probe->point_lps_mm = point_lps_mm;
    if (!vec3_is_finite(point_lps_mm))
        return;
    find_regions(plan, probe);
    for (size_t i = 0; i < plan->n_images; i++)
        probe->has_image[i] = volume_sample(plan->images[i].volume, point_lps_mm, &probe->image_value[i]);
    for (size_t d = 0; d < plan->n_doses; d++)
        for (size_t c = 0; c < plan->doses[d].n_components; c++) {
            double value;
            if (dose_is_valid(&plan->doses[d], point_lps_mm) &&
                volume_sample(plan->doses[d].components[c].values, point_lps_mm, &value))
                probe->doses[probe->n_doses++] = (struct probe_dose){ d, c, value };
        }
}
