#pragma once
/* Reads NIfTI-1 and NIfTI-2, one file (.nii, .nii.gz) or a pair of header and voxels (.hdr and .img, each packed or
 * not), as an image, a label map or a mask. Works on bytes in memory. Analyze 7.5, whose header looks alike but does
 * not say which side is left, is refused. source   nifti1.h, nifti2.h (R. W. Cox, C. Holmes and others, NIMH);
 * geometry: method 3 (sform), else 2 (qform), else 1 */
#include "core/formats/folder.h"
#include "core/formats/raw_voxels.h"

enum { NIFTI_HEAD_BYTES = 544 }; /* enough for either header and the four bytes after it */

struct nifti_header {
    struct grid grid;
    enum raw_type type;
    uint32_t voxel_bytes;
    bool is_swapped;      /* the file's byte order is the other one than this machine's */
    double slope, offset; /* value = stored * slope + offset; 1 and 0 when the file gives none */
    uint64_t data_at;     /* offset of the voxels in the unpacked file */
    uint64_t data_bytes;
    bool is_pair; /* the voxels lie in the .img file, and data_at is an offset in that */
};

/* Reads and checks a header; head holds the first bytes of the unpacked file.
 *   name     of the file, for error and report; report may be NULL
 *   errors   ERROR_FORMAT, ERROR_UNSUPPORTED (a data type, a series of volumes, Analyze 7.5), ERROR_RANGE (geometry),
 *            ERROR_LIMIT */
NODISCARD bool nifti_parse_header(const uint8_t *head, size_t size, const char *name, struct nifti_header *header,
                                  struct report *report, struct error *err);
/* Like nifti_parse_header, from the file's own bytes, packed or not. */
NODISCARD bool nifti_peek(const struct bytes *file, const char *name, struct nifti_header *header,
                          struct report *report, struct error *err);

/* Checks that the header is of a pair or of a single file, as the file's name says. errors ERROR_FORMAT */
NODISCARD bool nifti_check_place(const struct nifti_header *header, bool is_pair, const char *name, struct error *err);

/* Reads a single file; refuses a header with is_pair.
 *   returns  the volume, measured. One reference, the caller's; NULL on failure.
 *   errors   as nifti_parse_header, and ERROR_MEMORY */
NODISCARD struct volume *nifti_read(const struct bytes *file, const char *name, enum raw_use use, struct report *report,
                                    struct error *err);
/* Reads a pair. voxels is gzip when voxels_name ends with .gz, not by its first bytes: raw voxels may begin like gzip.
 */
NODISCARD struct volume *nifti_read_pair(const struct bytes *head, const char *head_name, const struct bytes *voxels,
                                         const char *voxels_name, enum raw_use use, struct report *report,
                                         struct error *err);
