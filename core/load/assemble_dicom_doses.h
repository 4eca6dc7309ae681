#pragma once
/* Adds DICOM doses (RTDOSE) to a plan; the doses of one treatment plan become one dose where they can be summed. */
#include "core/load/loading.h"

/* Adds the doses of one entry of plan.json, or with PART_WITHOUT_ENTRY those found in the folder; entry is NULL then.
 */
void plan_dicom_add_doses(struct loading *loading, size_t index, const struct plan_file_dose *entry);
/* Adds one object as a component of a dose that plan.json puts together. */
void plan_dicom_add_component(struct loading *loading, struct dose *dose, struct part_reading *reading);
