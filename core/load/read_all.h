#pragma once
/* Reads all listed files of a plan in several threads, the largest file first. */
#include "core/load/loading.h"

/* Fills every reading and moves its report to the plan's. A DICOM file that was recognised and cannot be read is
 * reported and marked failed.
 * errors  those of the first reading that failed, in the plan's order, whatever the order in time; ERROR_CANCELLED */
NODISCARD bool plan_read_parts(struct loading *loading, struct error *err);
