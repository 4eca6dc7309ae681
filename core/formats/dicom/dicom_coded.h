#pragma once
/* Inside core/formats/dicom: compares the values found in JPEG 2000 codestreams with the elements of the same file (RT
 * Dose, segmentation), and reports differences. Any thread; one struct per file being read. */
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

struct dicom_coded {
    size_t n_frames, n_lossy, n_other_sign, n_other_bits;
    uint32_t n_bits; /* in the last frame whose number of bits differs */
};
/* Counts the last frame read from file: whether it is lossy, and whether its sign or number of bits differs from
 * pixels. */
void dicom_coded_count(struct dicom_coded *coded, const struct dicom_file *file, const struct dicom_pixels *pixels);
/* Reports lossy frames (also where only element (0028,2110) says so), frames of another sign, and frames of another
 * number of bits. */
void dicom_coded_report(const struct dicom_coded *coded, const struct dicom_file *file,
                        const struct dicom_pixels *pixels, const char *where, struct report *report);
