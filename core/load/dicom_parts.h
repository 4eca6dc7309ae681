#pragma once
/* Inside core/load: what of a plan's folder is DICOM, and which image a structure set, a dose or a treatment plan
 * belongs to. */
#include "core/formats/dicom/dicom_index.h"
#include "core/load/parts.h"

enum {
    PLAN_DICOM_MAX_FILE_BYTES = 256 << 20, /* of a structure set, dose or treatment plan */
    PLAN_DICOM_MAX_DOSES = 256,            /* RTDOSE objects of a plan; further ones are reported */
    PLAN_DICOM_MAX_PLANS = 16              /* RTPLAN objects of a plan; further ones are reported */
};

/* Heads of the DICOM files that plan.json names (a file, or a folder and all below). Nothing to do when it names none.
 * errors as dicom_index_scan */
NODISCARD bool plan_dicom_scan_named(const struct folder *folder, struct plan_parts *parts,
                                     const struct dicom_progress *progress, struct report *report, struct error *err);
/* The same for a folder without plan.json, of whose files these may be DICOM; images and structure sets become parts of
 * the plan file: CT first, then those with more slices. */
NODISCARD bool plan_dicom_recognise(const struct folder *folder, char *const *names, size_t n_names,
                                    struct plan_parts *parts, const struct dicom_progress *progress,
                                    struct report *report, struct error *err);

/* The stack that a path means: the series of the file, else the stack with most slices below the folder. -1: none. */
int plan_dicom_stack(const struct dicom_index *index, const char *path);
/* Whether the object is the file, or lies below the folder. */
bool plan_dicom_is_under(const struct dicom_object *object, const char *path);
/* The nth object of a kind at or below a path ("" everywhere), or NULL. */
const struct dicom_object *plan_dicom_object(const struct dicom_index *index, enum dicom_kind kind, const char *path,
                                             size_t nth);

/* The bytes of a file, parsed; both are the caller's. errors as folder_read and dicom_file_parse */
struct plan_dicom_file {
    struct bytes bytes;
    struct dicom_file *file;
};
NODISCARD bool plan_dicom_open(const struct folder *folder, const char *path, struct plan_dicom_file *opened,
                               struct error *err);
void plan_dicom_close(struct plan_dicom_file *opened);
