#pragma once
/* Finds the DICOM objects of a plan's folder, and opens them. */
#include "core/formats/dicom/dicom_index.h"
#include "core/load/parts.h"

enum {
    PLAN_DICOM_MAX_FILE_BYTES = 256 << 20, /* of a structure set, dose or treatment plan */
    PLAN_DICOM_MAX_DOSES = 256,            /* RTDOSE objects of a plan; further ones are reported */
    PLAN_DICOM_MAX_PLANS = 16              /* RTPLAN objects of a plan; further ones are reported */
};

/* The stack with a slice at path, when path is a file; the stack with the most slices below path, when it is a folder.
 * -1: none. */
int plan_dicom_stack(const struct dicom_index *index, const char *path);
/* True if the object's file is path or lies below it. */
bool plan_dicom_is_under(const struct dicom_object *object, const char *path);
/* The nth object of a kind at or below path, from 0; "" is the whole folder. NULL: there are fewer. */
const struct dicom_object *plan_dicom_object(const struct dicom_index *index, enum dicom_kind kind, const char *path,
                                             size_t nth);

/* A DICOM file and its bytes, which it borrows; plan_dicom_close releases both. errors as folder_read and
 * dicom_file_parse */
struct plan_dicom_file {
    struct bytes bytes;
    struct dicom_file *file;
};
NODISCARD bool plan_dicom_open(const struct folder *folder, const char *path, struct plan_dicom_file *opened,
                               struct error *err);
void plan_dicom_close(struct plan_dicom_file *opened);
