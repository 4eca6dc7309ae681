#pragma once
/* Inside core/formats/dicom: pictures put together to stacks that each make one volume. */
#include "core/formats/dicom/dicom_object.h"
#include "core/math/vec.h"
#include "core/report/report.h"

#define DICOM_SAME_PLACE_MM 1e-3

/* Directions of rows and columns made perpendicular, of length 1; the normal completes them to a right-handed set.
 * error: by how much the given ones were off (cosine between them, lengths). false when they do not span a plane. */
bool dicom_axes(const double row[3], const double column[3], struct vec3 axes[3], double *error);

/* Fills index->stacks. errors ERROR_MEMORY */
NODISCARD bool dicom_stacks_find(struct dicom_index *index, struct report *report, struct error *err);
