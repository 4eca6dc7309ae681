#pragma once
/* Scans a folder for DICOM: lists every object with its kind and identifiers, and groups images into stacks. Reads the
 * head of each DICOM file and only the beginning of any other file. Knows no voxels and no plan. Lists the patients,
 * and writes their names and IDs nowhere. */
#include <stdatomic.h>

#include "core/formats/dicom/dicom_object.h"
#include "core/formats/folder.h"
#include "core/report/report.h"

struct dicom_progress {
    /* called on the calling thread, n_done ascending; may be NULL */
    void (*step)(void *context, size_t n_done, size_t n_all);
    void *context;
    const atomic_bool *cancel; /* may be NULL */
    int n_threads;             /* 0: one per core; at most 8 */
};

/* Scans files, and folders down to FOLDER_MAX_DEPTH. Reports unreadable DICOM files, duplicates, objects that are not
 * used and everything left out for a limit (codes dicom.* and image.split).
 *
 *   names    files and folders to scan; NULL and 0: the whole folder
 *   returns  the index, possibly empty, the caller's; NULL on failure
 *   errors   ERROR_CANCELLED, ERROR_IO, ERROR_MEMORY
 *   thread   any; runs progress->n_threads threads of its own */
NODISCARD struct dicom_index *dicom_index_scan(const struct folder *folder, char *const *names, size_t n_names,
                                               const struct dicom_progress *progress, struct report *report,
                                               struct error *err);
void dicom_index_destroy(struct dicom_index *index);

/* The object with this SOP Instance UID, or NULL. */
const struct dicom_object *dicom_index_find(const struct dicom_index *index, const char *sop_instance);
/* The object of the file at path, or NULL. */
const struct dicom_object *dicom_index_at(const struct dicom_index *index, const char *path);
