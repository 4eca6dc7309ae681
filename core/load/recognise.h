#pragma once
/* Finds the parts of a folder without plan.json by the names and headers of its files. */
#include "core/load/parts.h"

/* Looks at all files below the folder, except in folders that have a plan.json of their own. The caller finishes parts,
 * also after a failure. progress may be NULL. errors as plan_load */
NODISCARD bool plan_recognise(const struct folder *folder, const struct dicom_progress *progress,
                              struct plan_parts *parts, struct report *report, struct error *err);
