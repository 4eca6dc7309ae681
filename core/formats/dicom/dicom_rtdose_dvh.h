#pragma once
/* Inside core/formats/dicom: the histograms that an RT Dose object carries (DVH Sequence): what the planning program
 * found in each region. Source: DICOM PS3.3 C.8.8.4. */
#include "core/formats/dicom/dicom_rtdose.h"

/* Fills dose->stated, at most DOSE_MAX_STATED. Reads items of one included ROI, in the object's own units; others are
 * left out and counted in the report. A mean that is not given is that of the item's curve; what else is not given is
 * NaN. errors ERROR_MEMORY */
NODISCARD bool rtdose_read_dvhs(struct rtdose *dose, const struct dicom_item *root, const char *where,
                                struct report *report, struct error *err);
