#pragma once
/* Whom and what a part of a plan belongs to, as its files say: patient, frame of reference, study, series, treatment
 * plan, structure set. Plain data, filled while loading. Judges nothing: core/plan/fit.h does. */
#include <stddef.h>
#include <stdint.h>

#include "core/math/vec.h"

enum {
    ORIGIN_UID_SIZE = 66, /* a DICOM UID of at most 64 characters */
    ORIGIN_MAX_PATIENTS = 64,
    ORIGIN_MAX_TREATMENT_PLANS = 16,
    ORIGIN_MAX_REGISTRATIONS = 64
};

/* One person: Patient ID with its issuer, name and birth date. Parts of two patients of the list are never of one
 * person by their files: files with the same ID and another name or birth date make a patient of their own, and all
 * patients with that ID have has_conflict. source: DICOM PS3.3 C.7.1.1. Never written to logs, metrics, addresses or
 * file names; who may read it in full is decided by the server. */
struct plan_patient {
    char id[130], issuer[65]; /* (0010,0020), (0010,0021); "" not given */
    char name[200];           /* (0010,0010) as UTF-8, with its groups: "Family^Given=ideographic=phonetic" */
    char birth_date[9];       /* (0010,0030) YYYYMMDD; "" not given */
    char sex[17];             /* (0010,0040) */
    bool has_conflict;        /* another patient of the list has the same id, and another name or birth date */
};

/* A treatment plan (RTPLAN) of the folder. source: DICOM PS3.3 C.8.8.9, C.8.8.16 (approval). */
struct treatment_plan {
    char uid[ORIGIN_UID_SIZE];         /* SOP Instance UID */
    char structs_uid[ORIGIN_UID_SIZE]; /* structure set that it refers to; "" none */
    char label[65], name[65];
    char date[9], time[15];            /* RT Plan Date and Time as in the file; "" not given */
    char approval[17];                 /* "APPROVED", "UNAPPROVED", "REJECTED"; "" not stated */
    char review_date[9], reviewer[65]; /* "" not given */
    int64_t n_fractions;               /* planned; 0 not given */
    size_t n_beams; /* for treatment, also those that cannot be placed; 0: none, or their numbers are not clear */
    double prescription_gy; /* largest target prescription; NaN not given */
    int patient;            /* index in the plan's patients; -1 unknown */
};

/* A rigid registration (REG) between two frames of reference. source: DICOM PS3.3 C.20.2. */
struct plan_registration {
    char from_uid[ORIGIN_UID_SIZE], to_uid[ORIGIN_UID_SIZE];
    struct affine to_from_lps_mm; /* a point of frame `from` to frame `to` */
    int patient;
};

/* Origin of one image, dose, beam, set of tracks, or source of regions (a structure set, segmentation or label map). */
struct part_origin {
    int patient;        /* index in the plan's patients; -1: the files do not say */
    int treatment_plan; /* index in the plan's treatment plans that it belongs to or refers to; -1: none, or not here */
    size_t beam; /* of a dose of one beam: 1.., its place among the treatment plan's beams; 0: of several, unknown */
    char frame_uid[ORIGIN_UID_SIZE];
    char study_uid[ORIGIN_UID_SIZE];
    char series_uid[ORIGIN_UID_SIZE];  /* an image's own; of regions the series they were drawn on */
    char plan_uid[ORIGIN_UID_SIZE];    /* RTPLAN that a dose refers to, or a beam comes from; "" none stated */
    char structs_uid[ORIGIN_UID_SIZE]; /* of regions their own structure set; of a dose the one it refers to */
    char set_label[128];               /* of regions: how their structure set is called; "" not given */
    char path[512];                    /* of its first file, relative to the plan's folder */
    bool is_registered;                /* a registration brought it into frame_uid while loading (core/load) */
    bool is_stated_same;               /* plan.json says that its frame is the image's */
    bool is_stated_other;              /* plan.json says that it is not */
};
