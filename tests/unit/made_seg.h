#pragma once
/* Made-up DICOM segmentations of 11 x 3 pixels. Pixel (x, y) of a frame is set where 2 x + 3 y + segment + 7 plane is
 * divisible by 5; planes are 3 mm apart, plane 0 at -5 mm. */
#include "core/math/vec.h"
#include "tests/unit/made_dicom.h"

enum { MADE_SEG_COLUMNS = 11, MADE_SEG_ROWS = 3 };

struct made_seg_frame {
    int segment;
    double z_mm; /* along the normal */
};
struct made_seg {
    const struct made_seg_frame *frames;
    int n_frames, n_segments;
    bool is_fractional;
    double between_mm, thickness_mm;         /* 0: not given */
    const double *cosines;                   /* direction cosines of rows and columns; NULL: 1 0 0 0 1 0 */
    bool is_big_endian;                      /* for BINARY only */
    const char *frame_of_reference, *series; /* NULL: not given */
};
bool made_seg_is_set(int segment, double z_mm, int x, int y);
/* Centre of a pixel, patient LPS: the first one is at (10, 20, 0) + z along the normal. */
struct vec3 made_seg_lps_mm(const struct made_seg *seg, double z_mm, int x, int y);
/* Writes the file; pixels are 0.5 x 2 mm (columns, rows). Calls made_begin. */
void made_seg_bytes(struct made_dicom *made, const struct made_seg *seg);
