#pragma once
/* A stack of DICOM pictures as one volume. Slices are placed by what they say of their position, never by name or
 * number. */
#include "core/formats/dicom/dicom_index.h"
#include "core/volume/volume.h"

enum { DICOM_MAX_WINDOWS = 8 };

struct dicom_window {
    double center, width;
    char name[64]; /* "" when the file gives none */
};

struct dicom_series_facts {
    char unit[17]; /* "HU", "BQML", ...; "" when not said */
    struct dicom_window windows[DICOM_MAX_WINDOWS];
    size_t n_windows;
    bool is_inverted; /* MONOCHROME1: low values are meant to be white; they are given as the file has them */
};

/* Slices are read into place, several at once. Where they lie on a line at even distances their grid is theirs exactly,
 * sheared when the gantry was tilted. Slices within DICOM_EVEN of the pitch of an even place are taken as even; else,
 * and where slices are missing, the volume has even slices of the smallest usual distance, and those that no file holds
 * are interpolated between their neighbours; slices that are there keep their values. All of that, and all else that is
 * not as one would expect, is a line of the report: codes image.*. stack    of index->stacks facts    NULL: not wanted
 *   returns  the volume, measured; one reference, the caller's
 *   errors   ERROR_FORMAT, ERROR_UNSUPPORTED (an encoding, named), ERROR_LIMIT, ERROR_MEMORY, ERROR_IO (a file changed
 * since), ERROR_CANCELLED source   DICOM PS3.3 C.7.6.2 (image plane), C.7.6.16 (multi-frame functional groups), C.11.1
 * (rescale) */
NODISCARD struct volume *dicom_series_read(const struct folder *folder, const struct dicom_index *index, size_t stack,
                                           const struct dicom_progress *progress, struct dicom_series_facts *facts,
                                           struct report *report, struct error *err);
