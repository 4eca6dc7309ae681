#pragma once
/* Adds DICOM structure sets, segmentations and the beams of treatment plans to a plan. */
#include "core/load/loading.h"
#include "core/load/region_builder.h"

/* Fills the contours of a structure set on the image they were drawn on.
 * errors  as contour_choose_grids and contour_fill; ERROR_CANCELLED */
NODISCARD bool plan_dicom_add_regions(struct loading *loading, struct region_builder *builder,
                                      struct part_reading *reading, struct error *err);
/* Reports a segmentation whose frame of reference or series is none of the images'; gives its segments the colour of
 * the entry in plan.json. */
void plan_dicom_check_segmentation(struct loading *loading, struct part_reading *reading);
/* Adds the beams of all treatment plans that were read; reports those beyond PLAN_MAX_BEAMS. */
void plan_dicom_add_beams(struct loading *loading);
