#pragma once
/* Inside core/derive: fills the rows of a photon-isoeffective field from the physical fields of its components. */
#include "core/derive/dose_field.h"

/* rows: choice->n_rows volumes on the field's grid. get: dose_field_get, for the fields of components. Other recoils
 * count as fast neutrons.
 * errors  ERROR_RANGE the dose's unit is neither Gy nor cGy; ERROR_UNSUPPORTED the components have several grids; those
 *         of dose_field_get of the components */
typedef struct dose_field *dose_field_getter(struct derive *derive, const struct dose_choice *choice,
                                             struct error *err);
NODISCARD bool isoeffective_rows_fill(struct derive *derive, const struct dose_choice *choice,
                                      struct volume *const rows[], dose_field_getter *get, struct error *err);
