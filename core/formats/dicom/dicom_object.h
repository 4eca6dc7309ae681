#pragma once
/* What the head of a DICOM file says, as plain data: objects, and the stacks of pictures among them. */
#include "core/formats/dicom/dicom_file.h"

enum {
    DICOM_MAX_OBJECTS = 50000, /* further ones are counted, not kept */
    DICOM_MAX_SLICES = 4096,   /* of one stack: a volume's longest side */
    DICOM_MAX_STACKS = 256,    /* further ones are reported and left out */
    DICOM_TEXT_SIZE = 128      /* of a description, as UTF-8 */
};

enum dicom_kind {
    DICOM_KIND_IMAGE,  /* a grey picture, or several, with a place in the patient */
    DICOM_KIND_STRUCT, /* RTSTRUCT */
    DICOM_KIND_DOSE,   /* RTDOSE */
    DICOM_KIND_SEGMENTATION,
    DICOM_KIND_PLAN, /* RTPLAN, photons, electrons or ions */
    DICOM_KIND_OTHER /* not used; reason says why */
};

/* What the head of a picture says. */
struct dicom_image {
    struct dicom_pixels pixels;
    bool has_place;           /* position and orientation are the picture's own; else they stand in its frames */
    double position_mm[3];    /* centre of the first pixel, LPS */
    double row[3], column[3]; /* directions along a row and down a column, as the file gives them */
    double spacing_mm[2];     /* between rows, between columns */
    double thickness_mm;      /* 0: not said */
    double slope, offset;     /* value = stored * slope + offset; 1 and 0 when not said */
    int64_t instance, acquisition, echo, temporal; /* numbers; INT64_MIN: not said */
    double echo_ms, trigger_ms, b_value;           /* not-a-number: not said */
    char image_type[64];
    char unit[17];      /* Rescale Type, else Units: "HU", "BQML", ...; "" when not said */
    uint32_t bad_tag;   /* an element that is no number and counts as not said, the first; 0: none */
    char bad_found[24]; /* what stands there */
    bool is_lossy;
    bool has_stored; /* native pixels: stored says where */
    struct dicom_stored stored;
};

struct dicom_object {
    char *path;       /* relative to the folder */
    uint64_t n_bytes; /* of the file */
    enum dicom_kind kind;
    char modality[17]; /* "CT", "MR", "PT", "RTSTRUCT", ... */
    char sop_class[DICOM_UID_SIZE], sop_instance[DICOM_UID_SIZE], series[DICOM_UID_SIZE], study[DICOM_UID_SIZE];
    char frame_of_reference[DICOM_UID_SIZE]; /* "" when not said; of an RTSTRUCT the first it refers to */
    char transfer_syntax[DICOM_UID_SIZE];
    char description[DICOM_TEXT_SIZE];      /* of the series */
    char label[DICOM_TEXT_SIZE];            /* of a structure set or plan */
    char referenced_series[DICOM_UID_SIZE]; /* STRUCT, SEGMENTATION: the first it was drawn on */
    char referenced_struct[DICOM_UID_SIZE]; /* PLAN, DOSE: SOP instance */
    char referenced_plan[DICOM_UID_SIZE];   /* DOSE: SOP instance, the first */
    char reason[160];                       /* OTHER */
    struct dicom_image *image;              /* IMAGE, else NULL */
};

/* Pictures that make one volume: of one series, size, spacing and orientation, each at a place of its own. */
struct dicom_stack {
    char series[DICOM_UID_SIZE], study[DICOM_UID_SIZE], frame_of_reference[DICOM_UID_SIZE], modality[17];
    char description[DICOM_TEXT_SIZE]; /* of the series, and what sets the stack apart: "T2 (echo 2)" */
    size_t *objects;                   /* in index->objects, by position along the normal of the slices, growing */
    size_t n_objects;                  /* 1 when all slices are in one file */
    uint32_t rows, columns, n_slices;
    uint64_t n_bytes; /* memory the volume will take, at most; not of the resampling that uneven slices need */
};

struct dicom_index {
    struct dicom_object *objects; /* by path */
    size_t n_objects;
    struct dicom_stack *stacks; /* the one with most slices first */
    size_t n_stacks;
    size_t n_files, n_foreign; /* looked at; of those not DICOM */
};
