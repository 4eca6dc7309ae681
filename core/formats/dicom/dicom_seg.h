#pragma once
/* DICOM Segmentation: named segments as masks of frames, on the grid that the frames themselves make. */
#include "core/formats/dicom/dicom_file.h"
#include "core/formats/nrrd.h"

enum {
    DICOM_SEG_MAX_SEGMENTS = REGION_MAX, /* more are refused */
    DICOM_SEG_MAX_FRAMES = 1 << 16       /* more are refused */
};

/* Segments into layers of labels, as few as hold those that overlap. Frames may come in any order, and those without a
 * voxel be missing: planes between frames, and one at either end, are empty. A fractional segment holds the voxels of
 * half of its largest value and more, and the report says so. only     the one segment that is wanted, by its label; ""
 * all of them layers   as of a NRRD; on success the caller calls nrrd_layers_finish errors   ERROR_UNSUPPORTED another
 * kind of object, or encoding; ERROR_FORMAT; ERROR_RANGE; ERROR_LIMIT; ERROR_MEMORY source   DICOM PS3.3 A.51
 * (segmentation), C.8.20 (segments, frames), C.10.7.1.1 (colours) */
NODISCARD bool dicom_seg_read(const struct dicom_file *file, const char *where, const char *only,
                              struct nrrd_layers *layers, struct report *report, struct error *err);

/* What the grid and the labels will take, without reading pixels; false when the frames make no grid. */
bool dicom_seg_measure(const struct dicom_file *file, uint64_t *n_voxels, size_t *n_segments);

/* CIELab as DICOM stores it (three 16-bit numbers, white D50) to sRGB. IEC 61966-2-1; B. Lindbloom's Bradford matrix
 * D50 to D65. */
void dicom_seg_color(const uint16_t lab[3], uint8_t rgb[3]);
