#pragma once
/* Inside core/formats/dicom: the positions of the slices of a stack, and the grid they form. Reads no pixels. Any
 * thread. */
#include "core/formats/dicom/dicom_object.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

/* Share of the slice distance by which a slice may miss its even position and still count as even. */
#define DICOM_EVEN 0.05

/* One slice: a single-frame image, or one frame of a multi-frame image. */
struct dicom_slice {
    size_t object; /* in index->objects */
    uint32_t frame;
    struct vec3 position_lps_mm;
    double along_mm; /* position along the slice normal */
    double slope, offset;
};

/* Geometry shared by all slices of a stack. */
struct dicom_plane {
    double row[3], column[3]; /* direction cosines, as in the file */
    double spacing_mm[2];     /* between rows, between columns */
    double thickness_mm;      /* slice thickness; 0: not given */
    uint32_t rows, columns;
};

/* The slices from which one plane of the grid is made: one slice, or two that are interpolated. */
struct dicom_plane_source {
    uint32_t a, b; /* slice numbers; b == a for a plane that is a slice */
    double weight; /* weight of b, 0 to 1 */
};
struct dicom_slice_layout {
    struct grid grid;
    struct dicom_plane_source *planes; /* grid.size[2] planes; the caller frees it */
    bool is_exact;                     /* plane k is slice k */
};

/* Chooses the grid: even slices become one plane each, uneven or missing ones are interpolated.
 *
 *   slices  sorted by along_mm, no two at the same position; n >= 1
 *   where   for the report
 *   errors  ERROR_FORMAT directions that span no plane; ERROR_UNSUPPORTED slices that are not on a straight line;
 *           ERROR_LIMIT; ERROR_RANGE; ERROR_MEMORY */
NODISCARD bool dicom_slices_lay_out(const struct dicom_slice *slices, size_t n, const struct dicom_plane *plane,
                                    const char *where, struct dicom_slice_layout *layout, struct report *report,
                                    struct error *err);

/* Geometry of one frame of a multi-frame file, from its own and the shared functional groups. */
struct dicom_frame_place {
    double position_mm[3], cosines[6];
    double spacing_mm[2];            /* between rows, between columns */
    double thickness_mm, between_mm; /* 0: not given; between_mm: Spacing Between Slices */
};
/* Reads geometry and rescale of a frame. Returns false if position, orientation or pixel size is absent or malformed,
 * or another number is malformed. */
bool dicom_frame_read(const struct dicom_item *frame, const struct dicom_item *shared, struct dicom_frame_place *place,
                      struct dicom_slice *slice);
/* Returns true if orientation and pixel size are equal. */
bool dicom_frames_fit(const struct dicom_frame_place *a, const struct dicom_frame_place *b);

/* Lists the slices of a multi-frame file: geometry and rescale of each frame from its functional groups. Frames with
 * another orientation, size or time than the first are left out and reported.
 *
 *   file    parsed at least to DICOM_HEAD
 *   n       number of slices found; at most n_frames
 *   errors  ERROR_FORMAT */
NODISCARD bool dicom_frames_find(const struct dicom_file *file, const char *path, size_t object, uint32_t n_frames,
                                 struct dicom_slice *slices, size_t *n, struct dicom_plane *plane,
                                 struct report *report, struct error *err);
/* Reports contradictions between the images of a stack: sign, bits, unit; for a CT also the rescale. */
void dicom_slices_compare(const struct dicom_index *index, const struct dicom_stack *stack, struct report *report);
/* Sorts by along_mm and drops every slice at the position of another; returns how many remain. */
size_t dicom_slices_sort(struct dicom_slice *slices, size_t n, size_t *n_repeated);
/* Reports pixel data that hold at least a frame more than declared; a few bytes behind the pixels are usual. */
void dicom_slices_report_surplus(const struct dicom_index *index, const struct dicom_stack *stack,
                                 struct report *report);
