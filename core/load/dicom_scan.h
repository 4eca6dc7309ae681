#pragma once
/* Reads the headers of the DICOM files of a plan's folder: those that plan.json names, or all of them. */
#include "core/formats/dicom/dicom_index.h"
#include "core/load/parts.h"

/* Reads the headers of the DICOM files that plan.json names, each a file or a folder with all below it, into
 * parts->dicom. Leaves it NULL when plan.json names none. errors as dicom_index_scan */
NODISCARD bool plan_dicom_scan_named(const struct folder *folder, struct plan_parts *parts,
                                     const struct dicom_progress *progress, struct report *report, struct error *err);
/* Finds the parts of a folder without plan.json; names are the files that may be DICOM. Images, structure sets and
 * segmentations become entries of parts->file, images in this order: CT first, then by number of slices. */
NODISCARD bool plan_dicom_recognise(const struct folder *folder, char *const *names, size_t n_names,
                                    struct plan_parts *parts, const struct dicom_progress *progress,
                                    struct report *report, struct error *err);
