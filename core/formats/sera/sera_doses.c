/* The doses of one SERA dose file. */
#include "core/formats/sera/sera_doses.h"

#include <assert.h>

void sera_doses_finish(struct sera_doses *doses)
{
    for (size_t i = 0; i < doses->n_components; i++)
        volume_unref(doses->components[i].values);
    volume_unref(doses->mask);
    *doses = (struct sera_doses){ 0 };
}

float *sera_doses_add(struct sera_doses *doses, enum dose_quantity quantity, bool is_per_ppm, const struct grid *grid,
                      struct error *err)
{
    assert(doses->n_components < DOSE_N_QUANTITIES);
    struct volume *values = volume_create(grid, VOXEL_F32, err);
    if (!values)
        return NULL;
    doses->components[doses->n_components++] =
        (struct dose_component){ .quantity = quantity, .is_per_ppm = is_per_ppm, .values = values };
    return values->voxels;
}
