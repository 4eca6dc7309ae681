#pragma once
/* Gives every file of a plan's folder its line in the report: read as what, or not read and of what kind. */
#include "core/load/loading.h"

enum { FILE_NOTES_MAX = 60 /* lines of either sort; the rest is counted in one more */ };

/* Adds the lines. Files with a line already, as those that were left out, get no second one; the slices of a series
 * have one line together. Call it once the plan is built. errors ERROR_MEMORY, ERROR_IO */
NODISCARD bool plan_note_files(struct loading *loading, struct error *err);
