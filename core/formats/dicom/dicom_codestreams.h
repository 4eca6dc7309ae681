#pragma once
/* Counts the slices of a series whose JPEG 2000 codestream contradicts their elements, and reports them. */
#include "core/formats/dicom/dicom_index.h"

struct dicom_codestreams {
    size_t n_unsaid, n_other_sign, n_other_bits;
    uint32_t n_bits; /* number of bits in the last codestream that differs */
};
void dicom_codestreams_add(struct dicom_codestreams *coded, struct dicom_decoded decoded,
                           const struct dicom_image *image);
void dicom_codestreams_join(struct dicom_codestreams *all, const struct dicom_codestreams *more);
/* first: the series' first slice, whose path and elements the report names. */
void dicom_codestreams_report(const struct dicom_codestreams *coded, const struct dicom_object *first, size_t n_slices,
                              struct report *report);
