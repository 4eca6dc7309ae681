#pragma once
/* Reads DICOM Segmentation objects: named segments as label layers, on the grid spanned by the frames of the file. */
#include "core/formats/dicom/dicom_file.h"
#include "core/formats/nrrd.h"

enum {
    DICOM_SEG_MAX_SEGMENTS = REGION_MAX, /* with voxels; further ones are reported and left out */
    DICOM_SEG_MAX_DESCRIBED = 8192,      /* more are an error */
    DICOM_SEG_MAX_FRAMES = 1 << 16       /* more are an error */
};

/* Packs the segments into label layers, as few as the overlaps between segments allow. Frames may come in any order,
 * and empty frames may be absent: planes without a frame, and one more plane at either end, are empty. Segments far
 * apart lie on grids of their own, which leave out the planes between them. A segment beyond a limit is reported and
 * left out. Of a fractional segment the voxels with at least half of its largest value belong to the region, and the
 * report says so.
 *
 *   only    label of a single segment to read; "" for all
 *   layers  as of an NRRD; after success the caller calls nrrd_layers_finish
 *   errors  ERROR_UNSUPPORTED another kind of object, or an encoding; ERROR_FORMAT; ERROR_RANGE; ERROR_LIMIT;
 *           ERROR_MEMORY
 *   thread  any
 *   source  DICOM PS3.3 A.51 (segmentation), C.8.20 (segments, frames), C.10.7.1.1 (colours) */
NODISCARD bool dicom_seg_read(const struct dicom_file *file, const char *where, const char *only,
                              struct nrrd_layers *layers, struct report *report, struct error *err);

/* Gives the number of voxels in all boxes (dicom_seg_grid.h) and of segments without reading pixels, to estimate
 * memory. Returns false when the frames form no grid. */
bool dicom_seg_measure(const struct dicom_file *file, uint64_t *n_voxels, size_t *n_segments);

/* Converts CIELab as DICOM stores it (three 16-bit numbers, white point D50) to sRGB. Source: IEC 61966-2-1; B.
 * Lindbloom's Bradford matrix D50 to D65. */
void dicom_seg_color(const uint16_t lab[3], uint8_t rgb[3]);
