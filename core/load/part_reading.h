#pragma once
/* The reading of one file of a plan: the entry that the file stands for, and what its reader filled in. Plain data. */
#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtstruct.h"
#include "core/formats/dicom/dicom_series.h"
#include "core/formats/nrrd.h"
#include "core/formats/plan_file.h"
#include "core/formats/sera/sera_doses.h"
#include "core/formats/sera/sera_uvh.h"
#include "core/load/grid_content.h"
#include "core/load/part_reader.h"

#define PART_WITHOUT_ENTRY SIZE_MAX

/* Listed by part_list.c, filled by one thread by its reader (read_part.h), emptied by assemble*.c. Which of the results
 * is filled depends on kind and reader. */
struct part_reading {
    enum part_kind kind;
    size_t index;     /* of the entry in its list of the plan file; PART_WITHOUT_ENTRY: found in the folder */
    size_t component; /* index of the component in the dose of that entry */
    const char *path; /* relative to the plan's folder; borrowed from the plan file or the DICOM index */
    const struct part_reader *reader; /* of its format; never NULL */
    int stack;                        /* of a DICOM image: which stack of the index */
    uint64_t bytes;                   /* size of the file, for the order of reading and for progress */

    struct volume *volume;
    struct nrrd_layers *layers;      /* of a NRRD label map or a DICOM segmentation, instead of volume */
    struct sera_doses doses;         /* of a SERA dose, instead of volume */
    struct uvh uvh;                  /* of SERA univels */
    struct rtstruct *structs;        /* of a DICOM structure set */
    struct rtdose rtdose;            /* of a DICOM dose */
    struct rtplan *rtplan;           /* of a DICOM treatment plan */
    struct dicom_series_facts facts; /* of a DICOM image */
    struct label_names names;        /* of a label map */
    char modality[16];               /* of an image, as its own header says it */
    bool is_grid_doubtful;           /* the .qhd describes another image */
    struct report report;
    struct error err;
    struct grid_content content; /* of a NIfTI or NRRD image or label map that was recognised */
    bool is_no_labels;           /* named like a label map, but its values are none; volume holds an image */
    bool is_label_like;          /* an image whose values may be labels */
    bool is_failed;              /* after plan_read_parts: reported and left out */

    struct loading *loading; /* for the progress a reader reports */
    uint64_t bytes_counted;  /* of bytes, how many the progress counts already */
    size_t image;            /* index in the plan, once the image is added */
};
