#pragma once
/* Writes tracks, reference curves and preferences of a plan in SERA's text formats; tracks with energies as a table. */
#include "core/formats/plan_file.h"
#include "core/plan/plan.h"

/* Writes the files into the folder, which has a subfolder "curves", and names them in the plan file.
 * errors ERROR_IO, ERROR_MEMORY */
NODISCARD bool plan_write_texts(const struct plan *plan, const char *folder, struct plan_file *file, struct error *err);
