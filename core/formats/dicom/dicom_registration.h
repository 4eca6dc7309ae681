#pragma once
/* Reads Spatial Registration objects (REG): rigid transformations between frames of reference. Applies none. */
#include "core/formats/dicom/dicom_file.h"
#include "core/math/vec.h"
#include "core/report/report.h"

#define DICOM_REGISTRATION_TOLERANCE 1e-4 /* of the entries of a rotation matrix times its transpose */

struct dicom_registration {
    char from_uid[DICOM_UID_SIZE], to_uid[DICOM_UID_SIZE];
    struct affine to_from_lps_mm; /* a point of frame `from` to frame `to` */
};

/* Reads the transformations of one object; the matrices of one transformation are multiplied, the first is applied
 * first. What is not rigid (a matrix that is no rotation within DICOM_REGISTRATION_TOLERANCE, a type other than RIGID),
 * names no frame of reference or is malformed is reported and left out.
 *
 *   out      room for `most`; further ones are reported
 *   returns  how many
 *   thread   any
 *   source   DICOM PS3.3 C.20.2 (spatial registration) */
size_t dicom_registration_read(const struct dicom_file *file, const char *where, struct dicom_registration *out,
                               size_t most, struct report *report);
