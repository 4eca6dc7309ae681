#pragma once
/* Inside core/formats/dicom: where the slices of a stack lie, and the grid that they make. Reads no pixels. */
#include "core/formats/dicom/dicom_object.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

/* Share of the distance between slices by which a slice may miss an even place and still count as even. */
#define DICOM_EVEN 0.05

/* One slice: a picture, or a frame of one. */
struct dicom_slice {
    size_t object; /* in index->objects */
    uint32_t frame;
    struct vec3 position_lps_mm;
    double along_mm; /* along the normal */
    double slope, offset;
};

/* What all slices of a stack have in common. */
struct dicom_plane {
    double row[3], column[3]; /* as given */
    double spacing_mm[2];     /* between rows, between columns */
    double thickness_mm;      /* 0: not said */
    uint32_t rows, columns;
};

/* How slices become planes of a grid: even slices one each, others interpolated. */
struct dicom_plane_source {
    uint32_t a, b; /* slices; b == a for one that is taken as it is */
    double weight; /* of b */
};
struct dicom_layout_of_slices {
    struct grid grid;
    struct dicom_plane_source *planes; /* grid.size[2] of them; freed by the caller */
    bool is_exact;                     /* plane k is slice k */
};

/* slices: sorted by along_mm, each at a place of its own; n >= 1. where: for the report.
 * errors ERROR_FORMAT directions that span no plane, ERROR_UNSUPPORTED slices that do not lie on a line, ERROR_LIMIT,
 * ERROR_RANGE, ERROR_MEMORY */
NODISCARD bool dicom_slices_lay_out(const struct dicom_slice *slices, size_t n, const struct dicom_plane *plane,
                                    const char *where, struct dicom_layout_of_slices *layout, struct report *report,
                                    struct error *err);

/* Where a frame of a file with many lies, by its own groups and those that all share. */
struct dicom_frame_place {
    double position_mm[3], cosines[6];
    double spacing_mm[2];            /* between rows, between columns */
    double thickness_mm, between_mm; /* 0: not said; between: of neighbouring slices */
};
/* Place and scale of a frame; false when it does not say where it lies or how large its pixels are, or a number there
 * is none. */
bool dicom_frame_read(const struct dicom_item *frame, const struct dicom_item *shared, struct dicom_frame_place *place,
                      struct dicom_slice *slice);
bool dicom_frames_fit(const struct dicom_frame_place *a,
                      const struct dicom_frame_place *b); /* orientation and pixel size */

/* The slices of a file with many frames: place and scale of each from its functional groups. Frames of another
 * orientation, size or time than the first are left out, and said so. Takes the head of the file. n       of slices
 * found; at most n_frames errors  ERROR_FORMAT */
NODISCARD bool dicom_frames_find(const struct dicom_file *file, const char *path, size_t object, uint32_t n_frames,
                                 struct dicom_slice *slices, size_t *n, struct dicom_plane *plane,
                                 struct report *report, struct error *err);
/* Says what the pictures of a stack contradict each other in: sign, bits, unit; of a CT also the scale. */
void dicom_slices_compare(const struct dicom_index *index, const struct dicom_stack *stack, struct report *report);
/* Sorts by along_mm and drops what lies where another slice does; returns how many are left. */
size_t dicom_slices_sort(struct dicom_slice *slices, size_t n, size_t *n_repeated);
