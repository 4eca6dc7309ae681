#pragma once
/* Inside core/formats/dicom: reads the head (the elements before the pixels) of one file into a struct dicom_object. */
#include "core/formats/dicom/dicom_object.h"

enum dicom_head_result {
    DICOM_HEAD_FOREIGN,   /* not DICOM */
    DICOM_HEAD_DIRECTORY, /* DICOMDIR, skipped: the files it lists are found in the folder anyway */
    DICOM_HEAD_BROKEN,    /* DICOM, but unreadable: err says why */
    DICOM_HEAD_READ
};
/* Fills all of object except path; dicom_object_finish frees what it owns. scratch is a buffer reused between calls;
 * start with a zeroed one, and free scratch->data at the end.
 *
 *   thread  any; one scratch per thread */
enum dicom_head_result dicom_head_read(const struct folder *folder, const char *path, struct dicom_object *object,
                                       struct bytes *scratch, struct error *err);
void dicom_object_finish(struct dicom_object *object);
