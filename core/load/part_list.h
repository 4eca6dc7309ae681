#pragma once
/* The list of files to read for a plan: one struct part_reading for each file that an entry of plan.json names, or that
 * was recognised in the folder. */
#include "core/load/loading.h"

/* Fills loading's readings from its parts, in the plan's order; a dose in an unknown format is reported and left out.
 * errors ERROR_NOT_FOUND, ERROR_UNSUPPORTED, ERROR_MEMORY */
NODISCARD bool plan_list_parts(struct loading *loading, struct error *err);
