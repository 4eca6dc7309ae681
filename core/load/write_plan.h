#pragma once
/* A plan as a plan folder of ours: what opens as DICOM, NRRD or SERA's files becomes NIfTI, labels.json and plan.json.
 */
#include "core/plan/plan.h"

/* Writes images/, regions/ (a label map for each layer, so that overlapping regions stay whole), doses/, curves/,
 * tracks.pp, preferences.rsc, colors.cmap and plan.json. All of it appears at once or not at all: it is built in a
 * folder beside and renamed. What was noticed on opening the plan is not part of its folder.
 *
 *   folder  a new name in a folder that is there, or an empty folder
 *   lost    gets a line for whatever of the plan's voxels is not written; NULL: not wanted
 *   errors  ERROR_STATE the folder is there and holds something; ERROR_MEMORY; ERROR_IO; what the reader of plan.json
 * would refuse thread  any; uses all cores; equal plans give equal bytes exact   opened again, the plan has the same
 * values, matrices to 1e-7 mm, regions, ids, colours, doses, beams, tracks, curves and preferences. A voxel of a label
 * layer that belongs to no region (SERA's filling around the patient) is written as 0. */
NODISCARD bool plan_write(const struct plan *plan, const char *folder, struct report *lost, struct error *err);
