#pragma once
/* Writes a plan as a plan folder of our own: NIfTI, labels.json and plan.json, whatever files it was opened from. */
#include "core/plan/plan.h"

/* Writes images/, regions/ (a label map for each layer, so that overlapping regions stay whole), doses/, curves/,
 * tracks.pp or, when there are energies, tracks.csv, preferences.rsc, colors.cmap and plan.json. The folder appears
 * whole or not at all: it is built beside its place and renamed. The report of opening the plan is not written. Opened
 * again, the plan has the same values, matrices to 1e-7 mm, regions, ids, colours, doses, beams, tracks, curves and
 * preferences. A voxel of a label layer that belongs to no region (SERA's filling around the patient) is written as 0.
 *
 *   folder  a new name in an existing folder, or an empty folder
 *   lost    gets a line for each label layer with voxels that are written as 0, and for each part that is left out
 *           because it is of another patient or, but for doses, which say so, of another frame of reference than the
 *           first image; NULL: not wanted
 *   errors  ERROR_STATE the folder exists and holds something; ERROR_MEMORY; ERROR_IO; those of plan_file_parse, when
 *           the plan could not be opened again
 *   thread  any; uses all cores; equal plans give equal bytes */
NODISCARD bool plan_write(const struct plan *plan, const char *folder, struct report *lost, struct error *err);
