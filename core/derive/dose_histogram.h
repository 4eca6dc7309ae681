#pragma once
/* Dose-volume histograms of regions, as results of the store: one sweep counts all regions of a label layer. */
#include "core/derive/dose_field.h"
#include "core/dose/dvh.h"
#include "core/region/population.h"

/* Which weights a region's univels have, where the choice has several rows of them. */
enum dose_weighing {
    DOSE_BY_REGION, /* all those of the region that is counted: its own row, else that of the region around it */
    DOSE_BY_TISSUE  /* each those of its own tissue, as dose_field_value gives it */
};

/* The histogram of a region's univels: each has the dose at its centre.
 *
 *   per_side  1; or up to DVH_MAX_PER_SIDE: univels at a border are sampled in per_side^3 points
 *   dvh       a copy, for dvh_finish
 *   errors    those of dose_field_get and dvh_sweep; ERROR_NOT_FOUND by region: the region has no weights
 *   thread    any; uses all cores */
NODISCARD bool dose_histogram_get(struct derive *derive, const struct dose_choice *choice, size_t region,
                                  enum region_population population, enum dose_weighing weighing, int per_side,
                                  struct dvh *dvh, struct error *err);

/* The row of a choice whose weights hold in all of a region. DOSE_NO_ROW with a sentence: there is none. */
uint8_t dose_row_of_region(const struct region_set *set, const struct dose_choice *choice, size_t region,
                           struct error *why);

/* The histogram of all univels that lie in any region of the layer whose regions fill the largest volume: the body, as
 * far as the plan describes it; each with the weights of its tissue. layer: gets its index. Else as dose_histogram_get;
 * ERROR_NOT_FOUND without regions. */
NODISCARD bool dose_histogram_of_body(struct derive *derive, const struct dose_choice *choice, struct dvh *dvh,
                                      size_t *layer, struct error *err);
