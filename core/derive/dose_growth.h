#pragma once
/* How the isoeffective doses of a region grow with the output of the source: the doses of the components at each univel
 * are sampled once, so that histograms at many outputs need no field each. Knows no limits. */
#include "core/derive/dose_field.h"
#include "core/dose/dvh.h"
#include "core/region/population.h"

struct dose_growth;

/* Samples the components at the centres of a region's univels.
 *
 *   choice   isoeffective, per one unit of output; its irradiation_min does not count
 *   errors   ERROR_STATE the region is left out; ERROR_NOT_FOUND it has no parameters; ERROR_LIMIT more than
 *            DOSE_GROWTH_MAX_UNIVELS univels; ERROR_MEMORY; those of isoeffective_rows_create
 *   thread   any; uses all cores */
enum { DOSE_GROWTH_MAX_UNIVELS = 24 << 20 }; /* 384 MiB of components */
NODISCARD struct dose_growth *dose_growth_create(struct derive *derive, const struct dose_choice *choice, size_t region,
                                                 enum region_population population, struct error *err);
void dose_growth_destroy(struct dose_growth *growth);

/* The histogram of the doses after that output, in the unit of the dose. minutes: of the whole irradiation, at a
 * constant rate. dvh: for dvh_finish; zeroed on failure. Thread: one at a time; uses all cores. */
NODISCARD bool dose_growth_histogram(struct dose_growth *growth, double output, double minutes, struct dvh *dvh,
                                     struct error *err);
