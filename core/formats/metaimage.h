#pragma once
/* Reads MetaImage: one grid with its voxels behind the header (.mha, or .mhd with LOCAL) or in a file beside it (.raw,
 * .zraw), packed by zlib or not. Works on bytes in memory; opens no file. Places are taken as ITK writes them: mm, and
 * the first index's direction first in TransformMatrix, in LPS; what the file does not say of them is reported.
 *
 * source  ITK, MetaIO: documentation of the format (itk.org) */
#include "core/formats/folder.h"
#include "core/formats/raw_voxels.h"

enum { METAIMAGE_HEAD_BYTES = 1 << 16 }; /* longest header */

struct metaimage_header {
    struct grid grid;
    enum raw_type type;
    bool is_swapped, is_packed;       /* byte order other than this machine's; a zlib stream */
    uint64_t data_bytes;              /* of the voxels, unpacked */
    int64_t skip;                     /* bytes before the voxels in their own file; -1: they are its last bytes */
    size_t head_bytes;                /* length of the header, where the voxels follow it */
    char data_file[FOLDER_NAME_SIZE]; /* relative to the plan's folder; "": behind the header */
};

/* Reads and checks a header; head holds the first bytes of the file, METAIMAGE_HEAD_BYTES are enough.
 *   name    of the file in the plan's folder: for error and report, and to find its data file; report may be NULL
 *   errors  ERROR_FORMAT, with the line; ERROR_UNSUPPORTED (several values a voxel, four dimensions, a list of files,
 *           lengths not in mm); ERROR_RANGE (geometry, a data file outside the folder); ERROR_LIMIT */
NODISCARD bool metaimage_parse_header(const uint8_t *head, size_t size, const char *name,
                                      struct metaimage_header *header, struct report *report, struct error *err);
/* data: the whole file that holds the voxels, called data_name. Returns the volume, measured; one reference, the
 * caller's; NULL on failure. errors  as raw_unpack and raw_read; ERROR_FORMAT a damaged stream */
NODISCARD struct volume *metaimage_read(const struct metaimage_header *header, const struct bytes *data,
                                        const char *data_name, enum raw_use use, struct report *report,
                                        struct error *err);
