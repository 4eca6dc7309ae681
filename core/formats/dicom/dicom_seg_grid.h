#pragma once
/* Inside the segmentation reader: finds the positions of the frames, and the grid they span. Reads no pixels. Any
 * thread. */
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

#define DICOM_SEG_MAX_VOXELS ((uint64_t)1 << 29) /* of a box; the layers of all boxes: at most VOLUME_MAX_BYTES */
enum { SEG_MAX_BOXES = 64 };

struct seg_frame {
    int64_t segment;
    uint32_t plane; /* index in the grid */
    uint32_t box;   /* number of the box that holds it and all frames of its segment */
    bool is_used;
};

/* A range of planes of the grid, as a grid of its own. */
struct seg_box {
    uint32_t low_k, end_k;
    struct grid grid;
};

struct seg_grid {
    uint32_t rows, columns, n_frames; /* set by the caller */
    struct seg_frame *frames;         /* n_frames; the caller frees it, also after a failure */
    struct grid grid;                 /* all planes; never allocated as a whole */
    struct seg_box boxes[SEG_MAX_BOXES];
    size_t n_boxes;
};

/* Finds the plane distance: that of the file (0018,0088) if all frames fit to it; else the slice thickness if all fit
 * to that and no two frames are within 2.5 of it; else the smallest distance between two frames. The grid has one empty
 * plane before the first frame and one after the last. Frames with another orientation or pixel size than the first are
 * left out and reported.
 *
 *   errors  ERROR_UNSUPPORTED frames at uneven distances, or not on a straight line; ERROR_FORMAT; ERROR_LIMIT;
 *           ERROR_RANGE; ERROR_MEMORY */
NODISCARD bool seg_grid_find(struct seg_grid *grid, const struct dicom_item *root, const char *where,
                             struct report *report, struct error *err);

/* Groups segments into boxes: segments with at most a few empty planes between them share one. So lesions far apart do
 * not take the memory of what lies between them. Sets the box of every used frame. Errors: ERROR_MEMORY. */
NODISCARD bool seg_grid_find_boxes(struct seg_grid *grid, struct error *err);
