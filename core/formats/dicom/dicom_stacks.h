#pragma once
/* Inside core/formats/dicom: groups images into stacks that each form one volume. Any thread; the index is not shared
 * yet. */
#include "core/formats/dicom/dicom_object.h"
#include "core/math/vec.h"
#include "core/report/report.h"

#define DICOM_SAME_PLACE_MM 1e-3

/* Makes orthonormal axes from row and column directions: right-handed, axes[2] is the slice normal. error: how far the
 * given directions were from orthonormal (cosine between them, lengths). Returns false if they do not span a plane. */
bool dicom_axes(const double row[3], const double column[3], struct vec3 axes[3], double *error);

/* Fills index->stacks. Errors: ERROR_MEMORY. */
NODISCARD bool dicom_stacks_find(struct dicom_index *index, struct report *report, struct error *err);
