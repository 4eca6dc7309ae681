#pragma once
/* Inside core/formats/dicom: whether what was decoded is what the file says, for objects of one file. */
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

struct dicom_coded {
    size_t n_frames, n_lossy, n_other_sign, n_other_bits;
    uint32_t n_bits; /* of the last with other bits */
};
/* Takes what the codestream of the frame read last says. */
void dicom_coded_count(struct dicom_coded *coded, const struct dicom_file *file, const struct dicom_pixels *pixels);
/* Says loss (also the one that the file itself says, (0028,2110)), another sign and other bits. */
void dicom_coded_report(const struct dicom_coded *coded, const struct dicom_file *file,
                        const struct dicom_pixels *pixels, const char *where, struct report *report);
