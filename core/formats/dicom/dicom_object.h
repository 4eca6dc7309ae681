#pragma once
/* The heads of DICOM files as plain data: objects, images, and the stacks formed by images. */
#include "core/formats/dicom/dicom_file.h"

enum {
    DICOM_MAX_OBJECTS = 50000, /* further objects are counted, not kept */
    DICOM_MAX_SLICES = 4096,   /* per stack; same as a volume's longest side */
    DICOM_MAX_STACKS = 256,    /* further ones are reported and left out */
    DICOM_MAX_PATIENTS = 64,   /* objects of further ones are not used */
    DICOM_TEXT_SIZE = 128      /* bytes of a description in UTF-8 */
};

enum dicom_kind {
    DICOM_KIND_IMAGE,  /* one or more greyscale frames with a position in the patient */
    DICOM_KIND_STRUCT, /* RTSTRUCT */
    DICOM_KIND_DOSE,   /* RTDOSE */
    DICOM_KIND_SEGMENTATION,
    DICOM_KIND_PLAN,         /* RTPLAN, photons, electrons or ions */
    DICOM_KIND_REGISTRATION, /* REG, rigid or affine */
    DICOM_KIND_OTHER         /* not used; reason says why not */
};

/* One person, as files of the folder say. Text is UTF-8; "" not given. */
struct dicom_patient {
    char id[130], issuer[65];
    char name[200];     /* with its groups: "Family^Given=ideographic=phonetic" */
    char birth_date[9]; /* YYYYMMDD */
    char sex[17];
    bool has_conflict; /* files with this ID differ in name or birth date: they are several patients of the index */
};

/* Stored values low .. high are padding: nothing was measured there. */
struct dicom_padding {
    bool is_given;
    double low, high;
};

/* The head of an image file. */
struct dicom_image {
    struct dicom_pixels pixels;
    struct dicom_padding padding;
    bool has_place;        /* position and orientation are elements of the file itself; false: each frame has its own */
    double position_mm[3]; /* centre of the first pixel, patient LPS */
    double row[3], column[3]; /* direction cosines along a row and down a column, as in the file */
    double spacing_mm[2];     /* between rows, between columns */
    double thickness_mm;      /* slice thickness; 0: not given */
    double slope, offset;     /* value = stored * slope + offset; 1 and 0 if not given */
    int64_t instance, acquisition, echo,
        temporal; /* instance, acquisition, echo and temporal position number; INT64_MIN: not given */
    double echo_ms, trigger_ms, b_value; /* NaN: not given */
    char image_type[64];
    char unit[17]; /* Rescale Type, else Units: "HU", "BQML", ...; "" if not given */
    uint32_t
        bad_tag; /* tag of the first optional element whose value is malformed, and is therefore ignored; 0: none */
    char bad_found[24]; /* beginning of that value */
    bool is_lossy;
    bool has_stored; /* native pixels: `stored` is valid */
    struct dicom_stored stored;
};

struct dicom_object {
    char *path;       /* relative to the scanned folder */
    uint64_t n_bytes; /* size of the file */
    enum dicom_kind kind;
    char modality[17]; /* "CT", "MR", "PT", "RTSTRUCT", ... */
    char sop_class[DICOM_UID_SIZE], sop_instance[DICOM_UID_SIZE], series[DICOM_UID_SIZE], study[DICOM_UID_SIZE];
    char frame_of_reference[DICOM_UID_SIZE]; /* "" if not given; for an RTSTRUCT the first one it refers to */
    char transfer_syntax[DICOM_UID_SIZE];
    char description[DICOM_TEXT_SIZE];      /* of the series */
    char label[DICOM_TEXT_SIZE];            /* of a structure set or plan */
    char referenced_series[DICOM_UID_SIZE]; /* STRUCT, SEGMENTATION: the first series it was drawn on */
    char referenced_struct[DICOM_UID_SIZE]; /* PLAN, DOSE: SOP Instance UID of the structure set */
    char referenced_plan[DICOM_UID_SIZE];   /* DOSE: SOP Instance UID of the first plan it refers to */
    char reason[160];                       /* OTHER: why it is not used */
    struct dicom_image *image;              /* IMAGE; NULL for all other kinds */
    int patient;                            /* number in the index's patients; -1: the file has neither ID nor name */
    struct dicom_patient *named; /* only until the object is in the index; NULL: neither ID nor name; owned */
};

/* Images that form one volume: same series, size, spacing and orientation, each at a different position. */
struct dicom_stack {
    char series[DICOM_UID_SIZE], study[DICOM_UID_SIZE], frame_of_reference[DICOM_UID_SIZE], modality[17];
    char description[DICOM_TEXT_SIZE]; /* of the series, with what distinguishes this stack: "T2 (echo 2)" */
    size_t *objects;                   /* indices into index->objects, by ascending position along the slice normal */
    size_t n_objects;                  /* 1 if all slices are in one file */
    uint32_t rows, columns, n_slices;
    uint64_t n_bytes; /* upper bound of the volume's memory, without the resampling that uneven slices need */
    int patient;      /* as of its objects */
};

struct dicom_index {
    struct dicom_object *objects; /* sorted by path */
    size_t n_objects;
    struct dicom_stack *stacks; /* the stack with most slices first */
    size_t n_stacks;
    size_t n_files, n_foreign;                         /* files looked at; those of them that are not DICOM */
    struct dicom_patient patients[DICOM_MAX_PATIENTS]; /* in the order of their first files by path */
    size_t n_patients;
};
