#pragma once
/* Two doses compared, as results of the store: their difference, or their gamma index, at the voxels of the first. */
#include "core/derive/dose_field.h"
#include "core/dose/gamma.h"
#include "core/region/body.h"

/* Compared by its bytes: zeroed before it is filled. */
struct dose_comparison_choice {
    struct dose_choice first, second;
    bool is_gamma;              /* else the difference, second less first */
    struct gamma_options gamma; /* of a gamma index; its threshold of a difference, too: -INFINITY none */
    bool is_in_body;            /* only voxels whose centre lies in a univel of the body; else of all the grid */
    struct body body;
};

struct dose_comparison {
    struct derive_result base;
    struct volume *values;     /* F32, slope 1, on the first dose's grid; NaN: one of the two has no value there,
                                  or it is outside the body or under the threshold */
    char unit[DOSE_UNIT_SIZE]; /* of a difference; "" of an index */
    uint64_t n_domain;         /* voxels of the first dose with a value in the body, or in the grid */
    uint64_t n_outside;        /* those outside the body */
    struct gamma_facts gamma;  /* of a gamma index */
    /* of a difference */
    uint64_t n, n_without; /* voxels with a value; those of the first dose where the second has none */
    uint64_t n_below;      /* under the threshold */
    double mean, low, high, root_mean_square; /* NAN if n is 0 */
};

/* Both doses are taken with the weights of the tissue that holds at the centre of each voxel of their own grids;
 * between the voxels of the second the gamma index then interpolates tri-linearly, a difference takes dose_field_value.
 *
 *   returns  one reference, the caller's, dropped by derive_result_unref(&comparison->base)
 *   errors   those of dose_field_get and gamma_index; ERROR_RANGE the units differ
 *   thread   any; the first builds, on all cores. A gamma index takes some 20 us for each voxel above the threshold */
NODISCARD struct dose_comparison *dose_comparison_get(struct derive *derive,
                                                      const struct dose_comparison_choice *choice, struct error *err);
