#pragma once
/* Inside the reader of segmentations: where frames lie, and the grid they make. Reads no pixels. */
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

#define DICOM_SEG_MAX_VOXELS ((uint64_t)1 << 29) /* of the grid; voxels x layers may be at most VOLUME_MAX_BYTES */

struct seg_frame {
    int64_t segment;
    uint32_t plane; /* of the grid */
    bool is_used;
};

struct seg_grid {
    uint32_t rows, columns, n_frames; /* filled by the caller */
    struct seg_frame *frames;         /* n_frames of them; freed by the caller, after a failure too */
    struct grid grid;
};

/* Planes at the distance the file gives (0018,0088) where all frames fit to it, else at the smallest distance of two
 * frames. One empty plane lies before the first frame and one behind the last. Frames of another orientation or pixel
 * size than the first are left out, and said so. errors ERROR_FORMAT, ERROR_UNSUPPORTED frames on uneven planes or not
 * behind each other, ERROR_LIMIT, ERROR_RANGE, ERROR_MEMORY */
NODISCARD bool seg_grid_find(struct seg_grid *grid, const struct dicom_item *root, const char *where,
                             struct report *report, struct error *err);
