#pragma once
/* The univels of a region whose dose is within limits, as results of the store: to be highlighted, counted and made a
 * surface of. */
#include "core/derive/dose_field.h"
#include "core/region/population.h"

/* Compared by its bytes: zeroed before it is filled. */
struct dose_coverage_choice {
    struct dose_choice dose;
    size_t region; /* index in the plan */
    enum region_population population;
    double low, high; /* in the field's unit; a value v with low <= v < high is within. -INFINITY, INFINITY: no limit */
};

/* Counts the univels that dose_histogram_get counts by region, each with the same weights: the dose at its centre with
 * those of the region. */
struct dose_coverage {
    struct derive_result base;
    struct volume *labels; /* U8: 1 at univels within the limits, else 0; on the part of the region's grid that holds
                              all its univels */
    uint64_t n;            /* univels within the limits */
    uint64_t n_region;     /* all univels of the region */
    uint64_t n_without;    /* of them those without a value; never within */
    double volume_cm3;     /* of the n */
    double share;          /* n of the univels with a value, 0..1; NAN: none has one */
    double least_share;    /* n of all univels of the region */
    double most_share;     /* the same if those without a value were within */
};

/* One reference, the caller's, dropped by derive_result_unref(&coverage->base).
 * errors  those of dose_field_get and population_labels; ERROR_NOT_FOUND the region has no univels, or no weights;
 * ERROR_RANGE a limit is NaN; ERROR_MEMORY thread  any; uses all cores */
NODISCARD struct dose_coverage *dose_coverage_get(struct derive *derive, const struct dose_coverage_choice *choice,
                                                  struct error *err);
