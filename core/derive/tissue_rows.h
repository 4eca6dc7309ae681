#pragma once
/* Inside core/derive: which row of weights holds at each univel, as a result of the store. */
#include "core/derive/dose_field.h"

/* errors ERROR_MEMORY, ERROR_NOT_FOUND the plan has no regions */
NODISCARD struct tissue_rows *tissue_rows_get(struct derive *derive, const uint8_t row_of_region[REGION_MAX],
                                              struct error *err);
