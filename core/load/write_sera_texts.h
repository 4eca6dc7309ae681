#pragma once
/* Inside core/load: what of a plan is written as text in SERA's formats: tracks, reference curves, preferences. */
#include "core/formats/plan_file.h"
#include "core/plan/plan.h"

/* Writes the files into the folder, which has one called curves, and names them in the plan file. errors ERROR_IO,
 * ERROR_MEMORY */
NODISCARD bool plan_write_texts(const struct plan *plan, const char *folder, struct plan_file *file, struct error *err);
