#pragma once
/* Folders of made-up slices. A pixel's stored value is base + 10 y + x, so that the value tells its position. */
#include "core/formats/dicom/dicom_series.h"
#include "tests/unit/made_dicom.h"

struct made_slice {
    const char *transfer_syntax, *series, *instance_uid, *modality, *description, *color, *image_type,
        *frame_of_reference;
    const char *patient_id, *patient_name, *birth_date, *study; /* NULL: no ID, "SECRET^NAME", no date, "1.2.1" */
    double position[3], cosines[6], spacing[2] /* rows, columns */, thickness;
    int number, echo, rows, columns, bits, stored, is_signed, base;
    bool has_rescale;
    double slope, offset;
    int n_padding, padding[2]; /* 0: not given; 1: the padding value; 2: and its range limit; as US */
};
/* A CT slice of 3 columns and 2 rows of 16 signed bits, axial, at the origin, 1 x 1 mm. */
extern const struct made_slice made_slice_defaults;

/* Writes the slice's file (calls made_begin). instance_uid NULL: one derived from series, number and position. */
void made_slice_bytes(struct made_dicom *made, const struct made_slice *slice);
void made_slice_put(const char *folder, const char *name, const struct made_slice *slice);
void made_number(struct made_dicom *made, uint32_t tag, const char *vr, const double *values, int n); /* DS text */

/* A scanned folder with its report. */
struct scanned {
    char path[1024];
    bool is_kept; /* the folder is not the test's own and is not removed */
    struct folder folder;
    struct dicom_index *index;
    struct report report;
};
void scanned_open(struct scanned *scanned);   /* set path before */
void scanned_finish(struct scanned *scanned); /* removes the folder, unless it is kept */
/* Reads the volume of a stack; fails the test if it fails. */
struct volume *scanned_read(struct scanned *scanned, size_t stack);
/* The first report line with the code, or NULL. */
const struct report_line *scanned_said(const struct scanned *scanned, const char *code);
