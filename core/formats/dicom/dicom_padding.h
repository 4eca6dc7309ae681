#pragma once
/* Inside of reading images: pixels that hold the file's padding value, where nothing was measured. They get no value
 * (NaN). Any thread. Source: DICOM PS3.3 C.7.5.1.1.2 (pixel padding). */
#include "core/formats/dicom/dicom_object.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

/* Reads padding value and range limit (0028,0120), (0028,0121). A value that was written with the other sign is taken
 * as the pixels' own: 63536 for -2000. */
struct dicom_padding dicom_padding_read(const struct dicom_item *root, const struct dicom_pixels *pixels);
/* True if a stored value is padding. */
static inline bool dicom_is_padding(const struct dicom_padding *padding, double stored)
{
    return padding->is_given && stored >= padding->low && stored <= padding->high;
}
/* Counts the cells that are padding. Cells of type U8, U16 or I16 as stored. */
size_t dicom_padding_count(const struct dicom_padding *padding, enum voxel_type type, const void *cells, size_t n);
/* Converts stored cells to values; padding becomes NaN. Types as above. */
void dicom_padding_convert(const struct dicom_padding *padding, enum voxel_type type, const void *cells, size_t n,
                           double slope, double offset, float *out);
/* Reports pixels without a value, n of n_all. If all are padding, it cannot be meant: stored whole numbers keep their
 * values. */
void dicom_padding_report(const struct dicom_padding *padding, size_t n, size_t n_all, bool is_float, const char *where,
                          struct report *report);
