/* Reads the plan at a point, with the parts that a snapshot uses. */
#include "core/scene/scene_probe.h"

void scene_probe(const struct snapshot *snapshot, struct vec3 point_lps_mm, struct plan_probe *probe)
{
    const struct scene_fits *fits = &snapshot->fits;
    size_t n_regions = 0, n_doses = 0;
    plan_probe(snapshot->plan, point_lps_mm, probe);
    for (size_t i = 0; i < probe->n_regions; i++)
        if (fit_is_used(region_use(fits, probe->regions[i])))
            probe->regions[n_regions++] = probe->regions[i];
    probe->n_regions = n_regions;
    for (size_t i = 0; i < snapshot->plan->n_images; i++)
        probe->has_image[i] &= fit_is_used(&fits->beside[i]);
    for (size_t i = 0; i < probe->n_doses; i++)
        if (fit_is_used(&fits->doses[probe->doses[i].dose]))
            probe->doses[n_doses++] = probe->doses[i];
    probe->n_doses = n_doses;
}
