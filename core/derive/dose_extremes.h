#pragma once
/* The largest and the mean value of a dose in each region, as results of the store. */
#include "core/derive/dose_field.h"

struct dose_extremes {
    struct derive_result base;
    double body_high; /* largest value at a univel's centre in any region that the choice does not leave out; without
                         one at a voxel of the field; NAN: there is no value */
    /* Indexed by region: over the univels with its own label that have a value; NAN without one. */
    double high[REGION_MAX], mean[REGION_MAX];
};

/* errors those of dose_field_get. thread any; uses all cores */
NODISCARD struct dose_extremes *dose_extremes_get(struct derive *derive, const struct dose_choice *choice,
                                                  struct error *err);
