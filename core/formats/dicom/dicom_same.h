#pragma once
/* Inside of scanning folders: compares two files that give one SOP Instance UID. Any thread. */
#include "core/formats/dicom/dicom_object.h"
#include "core/formats/folder.h"

/* True if the files are equal byte for byte, or if both are images or both doses and have equal pixels, places and
 * scales; so a copy may be compressed or have other words. is_same false: other contents, or a file cannot be read.
 * Errors: ERROR_MEMORY alone. */
NODISCARD bool dicom_same_content(const struct folder *folder, const struct dicom_object *a,
                                  const struct dicom_object *b, bool *is_same, struct error *err);
