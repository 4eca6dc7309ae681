#pragma once
/* Reads a stack of DICOM images as one volume. Slices are placed by their Image Position, never by file name or
 * instance number. */
#include "core/formats/dicom/dicom_index.h"
#include "core/volume/volume.h"

enum { DICOM_MAX_WINDOWS = 8 };

struct dicom_window {
    double center, width;
    char name[64]; /* "" if not given */
};

struct dicom_series_facts {
    char unit[17]; /* Rescale Type or Units: "HU", "BQML", ...; "" if not given */
    struct dicom_window windows[DICOM_MAX_WINDOWS];
    size_t n_windows;
    bool is_inverted; /* MONOCHROME1, low values are meant to be white; the voxels are not inverted */
};

/* Reads the slices straight into the volume, several at once. Evenly spaced slices on a straight line give the volume
 * exactly their grid, sheared if the gantry was tilted. A slice within DICOM_EVEN (share of the slice distance) of its
 * even position counts as even. If slices are uneven or missing, the volume gets even slices at the smallest usual
 * distance; positions without a file are interpolated between the two neighbours, existing slices keep their values.
 * The report says all of this and every other irregularity: codes image.*.
 *
 *   stack    number in index->stacks
 *   facts    NULL: not wanted
 *   returns  the volume, patient LPS, measured; one reference, the caller's
 *   errors   ERROR_FORMAT, ERROR_UNSUPPORTED (an encoding, named), ERROR_LIMIT, ERROR_MEMORY, ERROR_IO (a file changed
 *            since the scan), ERROR_CANCELLED
 *   thread   any; runs progress->n_threads threads of its own
 *   source   DICOM PS3.3 C.7.6.2 (image plane), C.7.6.16 (multi-frame functional groups), C.11.1 (rescale) */
NODISCARD struct volume *dicom_series_read(const struct folder *folder, const struct dicom_index *index, size_t stack,
                                           const struct dicom_progress *progress, struct dicom_series_facts *facts,
                                           struct report *report, struct error *err);
