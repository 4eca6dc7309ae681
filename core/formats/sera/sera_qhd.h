#pragma once
/* Reads SERA's medical images (QSH): a text header .qhd and raw pixels .qim, .qim.gz or .qim.sz. Works on bytes in
 * memory. */
#include "core/formats/folder.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

enum { QHD_MAX_BYTES = 1 << 20, QHD_MAX_LOCATIONS = 4096 };

struct qhd {
    uint32_t columns, rows, slices; /* as the header says */
    uint32_t pixel_bytes;           /* 1 or 2 */
    bool is_big;
    double mm;       /* length of one unit, as the header says */
    double given_mm; /* length of one unit as the plan gives it, used instead; 0: not given. qhd_parse sets 0 */
    double step_columns, step_rows, spacing;
    double reference;
    bool has_spacing, has_reference;
    char orientation; /* 'A' axial, 'C' coronal, 'S' sagittal */
    char modality[16];
    double *locations; /* [n_locations] slice centres in the header's unit, in file order */
    size_t n_locations;
};
void qhd_finish(struct qhd *qhd);

/* Reads the header. errors ERROR_FORMAT, ERROR_UNSUPPORTED, ERROR_RANGE; the text names line and key */
NODISCARD bool qhd_parse(const uint8_t *data, size_t size, const char *name, struct qhd *qhd, struct report *report,
                         struct error *err);

/* Reads the pixels as U8 or U16 on the header's grid. pixels may be gzip, or zlib when name ends with .sz. When the
 * number of bytes contradicts the header's number of slices the bytes are right, and is_doubtful is set: the header
 * describes another image, so the geometry should come from elsewhere when possible. errors  ERROR_FORMAT not whole
 * slices, ERROR_UNSUPPORTED slices far from evenly spaced, ERROR_RANGE, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD struct volume *qhd_read_pixels(const struct qhd *qhd, const struct bytes *pixels, const char *header_name,
                                         const char *name, bool *is_doubtful, struct report *report, struct error *err);
