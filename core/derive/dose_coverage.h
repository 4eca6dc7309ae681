#pragma once
/* The univels of a region whose dose is within limits, as results of the store: to be highlighted, counted and made a
 * surface of. */
#include "core/derive/dose_field.h"

/* Compared by its bytes: zeroed before it is filled. */
struct dose_coverage_choice {
    struct dose_choice dose;
    size_t region;    /* index in the plan */
    double low, high; /* in the field's unit; a value v with low <= v < high is within. -INFINITY, INFINITY: no limit */
};

/* The univels of a region are those that its outer surface encloses: its own and its descendants' on the same grid
 * (mask_from_region). A univel has the dose at its centre (dose_field_value). */
struct dose_coverage {
    struct derive_result base;
    struct volume *labels; /* U8: 1 at univels within the limits, else 0; on the part of the region's grid that holds
                              all its univels */
    uint64_t n;            /* univels within the limits */
    uint64_t n_region;     /* all univels of the region */
    uint64_t n_without;    /* of them those without a value; never within */
    double volume_cm3;     /* of the n */
    double share;          /* n of the univels with a value, 0..1; NAN: none has one */
};

/* One reference, the caller's, dropped by derive_result_unref(&coverage->base).
 * errors  those of dose_field_get and mask_from_region; ERROR_NOT_FOUND the region has no univels; ERROR_RANGE a limit
 *         is NaN; ERROR_MEMORY
 * thread  any; uses all cores */
NODISCARD struct dose_coverage *dose_coverage_get(struct derive *derive, const struct dose_coverage_choice *choice,
                                                  struct error *err);
