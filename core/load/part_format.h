#pragma once
/* The format of a file in a plan's folder, recognised by its name and, for DICOM and tables, by its first bytes. */
#include "core/formats/folder.h"

enum part_format {
    PART_ABSENT, /* there is no such file */
    PART_NIFTI,
    PART_UVH,
    PART_QSH, /* .qim with its .qhd */
    PART_PP,
    PART_TRACK_CSV, /* .csv with the columns of tracks */
    PART_DICOM,
    PART_NRRD,
    PART_SERA_RST,         /* dose on a mesh */
    PART_SERA_DOSE,        /* .chd: dose on planes */
    PART_SERA_CURVE,       /* .dose: dose over depth and radius along a beam */
    PART_SERA_PREFERENCES, /* .rsc, .cmap, body_data.txt */
    PART_UNKNOWN
};

/* The format by the ending of the name. A folder counts as DICOM. A file without a known ending counts as DICOM when
 * its first bytes say so, and a .csv as tracks when its header names their columns. */
enum part_format part_format_of(const struct folder *folder, const char *name);
/* Like part_format_of, with the reason in err when a file whose first bytes are asked for cannot be read. */
enum part_format part_format_read(const struct folder *folder, const char *name, struct error *err);
bool part_is_sera_dose(enum part_format format);       /* a file that holds several quantities */
const char *part_format_word(enum part_format format); /* "NIfTI", "DICOM", ... */
