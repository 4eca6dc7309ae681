#pragma once
/* Folders of made-up slices. A voxel's stored value is base + 10 y + x, so that its place can be read off it. */
#include "core/formats/dicom/dicom_series.h"
#include "tests/unit/made_dicom.h"

struct made_slice {
    const char *transfer_syntax, *series, *instance_uid, *modality, *description, *color, *image_type,
        *frame_of_reference;
    double position[3], cosines[6], spacing[2] /* rows, columns */, thickness;
    int number, echo, rows, columns, bits, stored, is_signed, base;
    bool has_rescale;
    double slope, offset;
};
/* A CT slice of 3 columns and 2 rows of 16 signed bits, axial, at the origin, 1 x 1 mm. */
extern const struct made_slice made_slice_defaults;

/* Appends the slice's file to made (begun by it). instance_uid NULL: one made of series, number and position. */
void made_slice_bytes(struct made_dicom *made, const struct made_slice *slice);
void made_slice_put(const char *folder, const char *name, const struct made_slice *slice);
void made_number(struct made_dicom *made, uint32_t tag, const char *vr, const double *values, int n); /* DS text */

/* A folder scanned, and what was said. */
struct scanned {
    char path[1024];
    bool is_kept; /* the folder is not the test's own */
    struct folder folder;
    struct dicom_index *index;
    struct report report;
};
void scanned_open(struct scanned *scanned);   /* path is filled by the caller */
void scanned_finish(struct scanned *scanned); /* removes the folder, unless it is kept */
/* The volume of a stack; fails the test when there is none. */
struct volume *scanned_read(struct scanned *scanned, size_t stack);
/* Line with the code, NULL when there is none. */
const struct report_line *scanned_said(const struct scanned *scanned, const char *code);
