#pragma once
/* Inside core/formats/dicom: the head of one file as an object of the index. */
#include "core/formats/dicom/dicom_object.h"

enum dicom_head_result {
    DICOM_HEAD_FOREIGN,   /* not DICOM */
    DICOM_HEAD_DIRECTORY, /* DICOMDIR: a list of files, which are found anyway */
    DICOM_HEAD_BROKEN,    /* DICOM that cannot be read: err says why */
    DICOM_HEAD_READ
};
/* Fills object but for its path; what it owns is freed by dicom_object_finish. scratch: memory that is kept between
 * calls, freed by the caller. */
enum dicom_head_result dicom_head_read(const struct folder *folder, const char *path, struct dicom_object *object,
                                       struct bytes *scratch, struct error *err);
void dicom_object_finish(struct dicom_object *object);
