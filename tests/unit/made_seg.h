#pragma once
/* Made-up DICOM segmentations of 11 x 3 pixels: a frame's pixel (x, y) is set where x + y + segment + plane is divisible by 3. */
#include "tests/unit/made_dicom.h"

enum { MADE_SEG_COLUMNS = 11, MADE_SEG_ROWS = 3 };

struct made_seg_frame {
    int segment;
    double z_mm;
};
struct made_seg {
    const struct made_seg_frame *frames;
    int n_frames, n_segments;
    bool is_fractional;
    double between_mm;   /* 0: not said */
    const char *frame_of_reference, *series; /* NULL: not said */
};
bool made_seg_is_set(int segment, double z_mm, int x, int y);
/* Pixels of 0.5 x 2 mm (columns, rows), the first at (10, 20, z). made is begun by it. */
void made_seg_bytes(struct made_dicom *made, const struct made_seg *seg);
