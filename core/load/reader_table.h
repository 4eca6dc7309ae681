#pragma once
/* The formats of files in a plan's folder, and how a file's format is found: by its name and, for some, by its first
 * bytes. A new format is a row here and a file that defines its part_reader. */
#include "core/load/part_reader.h"

/* In the order in which first bytes are looked at. */
#define PART_READERS(X) \
    X(part_nifti) \
    X(part_nrrd) \
    X(part_metaimage)     /* .mha, .mhd */ \
    X(part_uvh)           /* SERA's univels */ \
    X(part_qsh)           /* SERA's image: .qim with its .qhd */ \
    X(part_sera_rst)      /* SERA's dose on a mesh */ \
    X(part_sera_chd)      /* SERA's dose on planes */ \
    X(part_sera_curve)    /* SERA's dose over depth and radius along a beam */ \
    X(part_sera_settings) /* SERA's preferences: .rsc, .cmap, body_data.txt */ \
    X(part_tally)         /* fields of Monte Carlo codes: .tally.json and the file that it names */ \
    X(part_pp)            /* tracks of seraMC */ \
    X(part_track_csv)     /* a table with the columns of tracks */ \
    X(part_dicom)
#define PART_READER_DECLARE(reader) extern const struct part_reader reader;
PART_READERS(PART_READER_DECLARE)
extern const struct part_reader part_absent;  /* there is no such file */
extern const struct part_reader part_unknown; /* none of the formats */

/* The format of a file, never NULL. A folder counts as DICOM. */
const struct part_reader *part_reader_of(const struct folder *folder, const char *name);
/* Like part_reader_of, with the reason in err when a file whose first bytes are asked for cannot be read. */
const struct part_reader *part_reader_ask(const struct folder *folder, const char *name, struct error *err);

/* True for a file that holds several quantities of a dose. */
bool part_is_sera_dose(const struct part_reader *reader);

/* Length of a base name without the endings of its format: "case7.liver_mask" of case7.liver_mask.nii.gz. An ending
 * that names no format belongs to the name. */
int part_stem_length(const char *base);
