#pragma once
/* Writes a volume as a NIfTI file (.nii, or .nii.gz when the path ends so). Knows nothing of plans. */
#include "core/volume/volume.h"

/* Writes volume with its slope and offset, sform always, qform where the axes are at right angles; world is RAS, mm.
 *
 *   description  at most 79 bytes are kept; NULL: none
 *   returns      equal volumes give equal bytes: no time stamp, one compressed member
 *   errors       ERROR_LIMIT a side that NIfTI-1's 16 bits do not hold; ERROR_MEMORY; ERROR_IO
 *   thread       any; volume is shared and frozen
 *   source       the NIfTI-1 header, nifti1.h of the NIfTI Data Format Working Group, 2007 */
NODISCARD bool nifti_write(const char *path, const struct volume *volume, const char *description, struct error *err);
/* Like nifti_write, but as NIfTI-2, which has 64-bit numbers, when NIfTI-1 would move a corner by more than 1e-7 mm or
 * change the values. */
NODISCARD bool nifti_write_exact(const char *path, const struct volume *volume, const char *description,
                                 struct error *err);
