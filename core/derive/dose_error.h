#pragma once
/* The statistical error of a dose that is shown, as a result of the store. */
#include "core/derive/dose_field.h"

struct dose_error {
    struct derive_result base;
    struct volume *percent; /* F32: one standard deviation in % of the value, at the voxels of the first component in
                               the sum; NaN: no value, or a component in it has no error there. The components of a sum
                               count as independent; weights are those of the tissue at the voxel's centre */
};

/* returns  one reference, the caller's, dropped by derive_result_unref(&error->base)
 * errors   ERROR_NOT_FOUND the files give no error of the quantity; ERROR_UNSUPPORTED of a sum of doses, and of
 *          isoeffective doses; those of dose_field_get
 * thread   any; the first builds */
NODISCARD struct dose_error *dose_error_get(struct derive *derive, const struct dose_choice *choice, struct error *err);
