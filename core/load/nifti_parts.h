#pragma once
/* Inside core/load: NIfTI grids of a plan's folder, in one file (.nii) or as a pair (.hdr and .img), either of which
 * may be named. */
#include "core/formats/nifti.h"

/* The two files of a pair. */
struct nifti_pair {
    char head[FOLDER_NAME_SIZE], voxels[FOLDER_NAME_SIZE];
};
bool plan_nifti_is_pair(const char *name);
/* The file beside a named one is found with and without .gz, in letters of the same case. errors ERROR_NOT_FOUND */
NODISCARD bool plan_nifti_find_pair(const struct folder *folder, const char *name, struct nifti_pair *pair,
                                    struct error *err);
/* The file that holds the voxels: name itself, or that of the pair ("" when it is not there). */
void plan_nifti_voxels(const struct folder *folder, const char *name, char voxels[FOLDER_NAME_SIZE]);

/* The header alone; that the file of voxels is there is checked. errors as nifti_peek, and ERROR_NOT_FOUND */
NODISCARD bool plan_nifti_peek(const struct folder *folder, const char *name, struct nifti_header *header,
                               struct error *err);
/* errors as nifti_read, and those of folder_read */
NODISCARD struct volume *plan_nifti_read(const struct folder *folder, const char *name, enum raw_use use,
                                         struct report *report, struct error *err);
