#pragma once
/* Fills in what the files of a plan's parts say of patient, frame of reference, study, treatment plan and structure
 * set (core/plan/origin.h). Judges nothing, but for what cannot be one part: see origin_join. */
#include "core/load/loading.h"

struct dicom_patient;
struct rtplan;

/* Copies what one file says into the form of a plan. patient: index in the plan's patients; -1: unknown. */
void origin_patient(const struct dicom_patient *from, struct plan_patient *patient);
void origin_treatment_plan(const struct rtplan *from, int patient, struct treatment_plan *added);

/* Lists the patients of the DICOM files and the treatment plans that were read. Call it once, after reading. */
void origins_begin(struct loading *loading);

/* The origin of one file that was read: of no patient and without a frame of reference if it is not DICOM. */
struct part_origin origin_of_reading(const struct loading *loading, const struct part_reading *reading);
/* Like origin_of_reading, for a structure set's region with a frame of reference of its own; "" takes the file's. */
struct part_origin origin_of_roi(const struct loading *loading, const struct part_reading *reading,
                                 const char *frame_uid);

/* Adds what an entry of plan.json says of the frame of reference. */
void origin_state(struct part_origin *origin, const struct plan_file_dose *entry);

/* Gives an origin to all regions of the plan from number first on that have none yet. errors ERROR_MEMORY */
NODISCARD bool origins_add_regions(struct plan *plan, const struct part_origin *origin, size_t first,
                                   struct error *err);
/* Adds to a dose's origin that of another of its files: a frame of reference that is not the first file's makes the
 * whole dose is_stated_other. Returns false if the two files are of different patients: they are no one dose. */
NODISCARD bool origin_join(struct part_origin *origin, const struct part_origin *other);
