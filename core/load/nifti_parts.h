#pragma once
/* Reads NIfTI files of a plan's folder: a single file (.nii), or a pair (.hdr and .img) of which either may be named.
 */
#include "core/formats/nifti.h"

struct nifti_pair {
    char head[FOLDER_NAME_SIZE], voxels[FOLDER_NAME_SIZE];
};
bool plan_nifti_is_pair(const char *name);
/* Finds the other file of a pair, with or without .gz, in letters of the same case. errors ERROR_NOT_FOUND */
NODISCARD bool plan_nifti_find_pair(const struct folder *folder, const char *name, struct nifti_pair *pair,
                                    struct error *err);
/* The file that holds the voxels: name itself, or the .img of the pair; "" when that does not exist. */
void plan_nifti_voxels(const struct folder *folder, const char *name, char voxels[FOLDER_NAME_SIZE]);

/* Reads the header alone, and checks that the file of voxels exists. errors as nifti_peek; ERROR_NOT_FOUND */
NODISCARD bool plan_nifti_peek(const struct folder *folder, const char *name, struct nifti_header *header,
                               struct error *err);
/* errors as nifti_read, and those of folder_read */
NODISCARD struct volume *plan_nifti_read(const struct folder *folder, const char *name, enum raw_use use,
                                         struct report *report, struct error *err);
