#pragma once
/* What lies in a folder, as far as it is DICOM: every object with its kind and identifiers, and the pictures among them
 * put together to stacks. Reads heads only, and of other files no more than their beginning. Knows no voxels and no
 * plan; keeps no names of people. */
#include <stdatomic.h>

#include "core/formats/dicom/dicom_object.h"
#include "core/formats/folder.h"
#include "core/report/report.h"

struct dicom_progress {
    void (*step)(void *context, size_t n_done, size_t n_all); /* one call at a time, from any thread; may be NULL */
    void *context;
    const atomic_bool *cancel; /* may be NULL */
    int n_threads;             /* 0: one per core, at most 8 */
};

/* Looks at files, and into folders down to FOLDER_MAX_DEPTH. Files that are DICOM but cannot be read, copies, objects
 * of no use here and everything left out are lines of the report: codes dicom.* and image.split. names    files and
 * folders; NULL and 0: the whole folder returns  the index, which may be empty; NULL on failure errors ERROR_CANCELLED,
 * ERROR_IO, ERROR_MEMORY */
NODISCARD struct dicom_index *dicom_index_scan(const struct folder *folder, char *const *names, size_t n_names,
                                               const struct dicom_progress *progress, struct report *report,
                                               struct error *err);
void dicom_index_destroy(struct dicom_index *index);

/* The object with this SOP instance UID, NULL when there is none. */
const struct dicom_object *dicom_index_find(const struct dicom_index *index, const char *sop_instance);
