/* Counts and reports codestreams that contradict their elements. */
#include "core/formats/dicom/dicom_codestreams.h"

void dicom_codestreams_add(struct dicom_codestreams *coded, struct dicom_decoded decoded,
                           const struct dicom_image *image)
{
    if (decoded.n_bits == 0)
        return;
    coded->n_unsaid += decoded.is_lossy && !image->is_lossy;
    coded->n_other_sign += decoded.is_signed != image->pixels.is_signed;
    if (decoded.n_bits != image->pixels.bits_stored) {
        coded->n_other_bits++;
        coded->n_bits = decoded.n_bits;
    }
}

void dicom_codestreams_join(struct dicom_codestreams *all, const struct dicom_codestreams *more)
{
    all->n_unsaid += more->n_unsaid;
    all->n_other_sign += more->n_other_sign;
    all->n_other_bits += more->n_other_bits;
    all->n_bits = more->n_bits ? more->n_bits : all->n_bits;
}

void dicom_codestreams_report(const struct dicom_codestreams *coded, const struct dicom_object *first, size_t n_slices,
                              struct report *report)
{
    const struct dicom_pixels *pixels = &first->image->pixels;
    if (coded->n_unsaid > 0)
        report_add(report, REPORT_WARNING, "image.lossy", first->path,
                   "%zu of %zu slices were compressed with loss (JPEG 2000 with its irreversible "
                   "transform), and their element (0028,2110) does not say so.",
                   coded->n_unsaid, n_slices);
    if (coded->n_other_sign > 0)
        report_add(report, REPORT_WARNING, "image.coded-otherwise", first->path,
                   "Element (0028,0103), pixel representation: found %d, but the JPEG "
                   "2000 codestream of %zu of %zu slices holds %s values; their bits were taken as the element says.",
                   pixels->is_signed, coded->n_other_sign, n_slices, pixels->is_signed ? "unsigned" : "signed");
    if (coded->n_other_bits > 0)
        report_add(report, REPORT_WARNING, "image.coded-otherwise", first->path,
                   "Element (0028,0101), bits stored: found %u, but the JPEG 2000 "
                   "codestream of %zu of %zu slices holds values of %u bits; those were taken.",
                   pixels->bits_stored, coded->n_other_bits, n_slices, coded->n_bits);
}
