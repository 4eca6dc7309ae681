#pragma once
/* Dose-volume histograms of regions, as results of the store: one sweep counts all regions of a label layer. */
#include "core/derive/dose_field.h"
#include "core/dose/dvh.h"

/* The histogram of a region's univels: each has the dose at its centre in the row of weights of its own tissue, as
 * dose_field_value gives it.
 *
 *   with_descendants  also the univels of the regions inside it, as mask_from_region takes them
 *   per_side          1; or up to DVH_MAX_PER_SIDE: univels at a border are sampled in per_side^3 points
 *   dvh               a copy, for dvh_finish
 *   errors            those of dose_field_get and dvh_sweep
 *   thread            any; uses all cores */
NODISCARD bool dose_histogram_get(struct derive *derive, const struct dose_choice *choice, size_t region,
                                  bool with_descendants, int per_side, struct dvh *dvh, struct error *err);

/* The histogram of all univels that lie in any region of the layer whose regions fill the largest volume: the body, as
 * far as the plan describes it. layer: gets its index. Else as dose_histogram_get; ERROR_NOT_FOUND without regions. */
NODISCARD bool dose_histogram_of_body(struct derive *derive, const struct dose_choice *choice, struct dvh *dvh,
                                      size_t *layer, struct error *err);
