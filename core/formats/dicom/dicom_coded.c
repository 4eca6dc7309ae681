/* Counts and reports differences between JPEG 2000 codestreams and the elements of the same file. */
#include "core/formats/dicom/dicom_coded.h"

#include <string.h>

#define LOSSY DICOM_TAG(0x0028, 0x2110)

void dicom_coded_count(struct dicom_coded *coded, const struct dicom_file *file, const struct dicom_pixels *pixels)
{
    struct dicom_decoded decoded = dicom_pixels_decoded(file);
    coded->n_frames++;
    if (decoded.n_bits == 0)
        return;
    coded->n_lossy += decoded.is_lossy;
    coded->n_other_sign += decoded.is_signed != pixels->is_signed;
    if (decoded.n_bits != pixels->bits_stored) {
        coded->n_other_bits++;
        coded->n_bits = decoded.n_bits;
    }
}

void dicom_coded_report(const struct dicom_coded *coded, const struct dicom_file *file,
                        const struct dicom_pixels *pixels, const char *where, struct report *report)
{
    char lossy[8];
    bool is_said = dicom_text(dicom_root(file), LOSSY, lossy, sizeof lossy) && strcmp(lossy, "01") == 0;
    if (is_said)
        report_add(report, REPORT_WARNING, "image.lossy", where,
                   "Its values were compressed with loss, as its element (0028,2110) says.");
    else if (coded->n_lossy > 0)
        report_add(report, REPORT_WARNING, "image.lossy", where,
                   "%zu of %zu frames were compressed with loss (JPEG 2000 with its irreversible "
                   "transform), and element (0028,2110) does not say so.",
                   coded->n_lossy, coded->n_frames);
    if (coded->n_other_sign > 0)
        report_add(report, REPORT_WARNING, "image.coded-otherwise", where,
                   "Element (0028,0103), pixel representation: found %d, but the JPEG 2000 "
                   "codestream of %zu of %zu frames holds %s values; their bits were taken as the element says.",
                   pixels->is_signed, coded->n_other_sign, coded->n_frames, pixels->is_signed ? "unsigned" : "signed");
    if (coded->n_other_bits > 0)
        report_add(report, REPORT_WARNING, "image.coded-otherwise", where,
                   "Element (0028,0101), bits stored: found %u, but the JPEG 2000 codestream "
                   "of %zu of %zu frames holds values of %u bits; those were taken.",
                   pixels->bits_stored, coded->n_other_bits, coded->n_frames, coded->n_bits);
}
