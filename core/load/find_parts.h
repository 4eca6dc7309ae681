#pragma once
/* Finds the parts of a plan: from plan.json, or by recognising the folder's files where there is no plan.json. */
#include "core/load/parts.h"

/* Fills parts; the caller finishes them, also after a failure. progress may be NULL. errors as plan_load */
NODISCARD bool plan_find_parts(const struct folder *folder, const struct dicom_progress *progress,
                               struct plan_parts *parts, struct report *report, struct error *err);
