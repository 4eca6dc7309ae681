#pragma once
/* SERA's medical images (QSH): a text header .qhd and raw pixels .qim, .qim.gz or .qim.sz. Works on bytes in memory. */
#include "core/formats/folder.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

enum { QHD_MAX_BYTES = 1 << 20, QHD_MAX_LOCATIONS = 4096 };

struct qhd {
    uint32_t columns, rows, slices; /* as the header says */
    uint32_t pixel_bytes;           /* 1 or 2 */
    bool is_big;
    double mm;       /* of one unit, as the header says */
    double given_mm; /* as the plan says, which wins; 0 after qhd_parse */
    double step_columns, step_rows, spacing;
    double reference;
    bool has_spacing, has_reference;
    char orientation; /* 'A' axial, 'C' coronal, 'S' sagittal */
    char modality[16];
    double *locations; /* [n_locations] slice centres in the header's unit, in file order */
    size_t n_locations;
};
void qhd_finish(struct qhd *qhd);

/* errors ERROR_FORMAT, ERROR_UNSUPPORTED, ERROR_RANGE; line and key named */
NODISCARD bool qhd_parse(const uint8_t *data, size_t size, const char *name, struct qhd *qhd, struct report *report,
                         struct error *err);

/* The pixels, U8 or U16, on the header's grid. pixels may be gzip, or zlib when name ends with .sz. The number of bytes
 * is believed over the header's number of slices; is_doubtful then says that the header described another image, so
 * that its geometry should be taken from elsewhere if it can be. errors  ERROR_FORMAT not whole slices,
 * ERROR_UNSUPPORTED slices far from evenly spaced, ERROR_RANGE, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD struct volume *qhd_read_pixels(const struct qhd *qhd, const struct bytes *pixels, const char *header_name,
                                         const char *name, bool *is_doubtful, struct report *report, struct error *err);
