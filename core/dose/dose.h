#pragma once
/* A dose as the plan gives it: components on their own grids, their unit and what they are per. No weights, no
 * pictures. */
#include "core/volume/volume.h"

/* Physical doses, fluences, and two that a file may hold with weights already in them and no way to take them out. The
 * last two have words of their own, and no sum may mix them with the others. */
enum dose_quantity {
    DOSE_TOTAL, /* physical, of all components */
    DOSE_BORON,
    DOSE_NITROGEN,
    DOSE_FAST,
    DOSE_GAMMA,
    DOSE_OTHER, /* recoils and captures that are none of those */
    DOSE_FAST_FLUENCE,
    DOSE_EPITHERMAL_FLUENCE,
    DOSE_THERMAL_FLUENCE,
    DOSE_BLOOD_BORON,    /* boron per ppm in the blood: each tissue's own ratio to blood is in it */
    DOSE_WEIGHTED_TOTAL, /* biological weights, and boron as the file assumes it, are in it */
    DOSE_N_QUANTITIES
};
const char *dose_quantity_word(enum dose_quantity quantity); /* "total", "boron", "thermal-fluence", ... */
bool dose_quantity_from_word(const char *word, enum dose_quantity *quantity);
bool dose_quantity_is_fluence(enum dose_quantity quantity);

struct dose_component {
    enum dose_quantity quantity;
    bool is_per_ppm;       /* boron, or blood boron, per 1 ppm of boron-10 */
    struct volume *values; /* in what dose_unit_of says */
    bool has_boron_ppm;    /* total, weighted total: it is known which boron is in it */
    double boron_ppm;      /* then: of so many ppm of boron-10 in blood, with each tissue's ratio to blood as the file's
                              program had it */
};

/* Whether a dose and the image lie in one DICOM frame of reference: in another, the dose may be shifted against the
 * image. The greater the worse. */
enum dose_frame {
    DOSE_FRAME_SAME,
    DOSE_FRAME_UNKNOWN, /* the files do not say */
    DOSE_FRAME_DIFFERS,
    DOSE_N_FRAMES
};
const char *dose_frame_word(enum dose_frame frame); /* "same", "unknown", "differs" */
bool dose_frame_from_word(const char *word, enum dose_frame *frame);

struct dose {
    char id[64];
    char name[64];  /* for people; "" when the files give none */
    char unit[16];  /* "Gy", "cGy"; as the plan says it, never assumed */
    char per[64];   /* "fraction", "250 kW-min", "minute"; "" when the plan does not say, and the report then says so */
    bool has_frame; /* of a DICOM file beside a DICOM image, or said in plan.json */
    enum dose_frame frame; /* then */
    struct dose_component components[DOSE_N_QUANTITIES];
    size_t n_components;
    struct volume *mask; /* where values are valid; NULL: everywhere on the grid */
    /* by quantity; 0 where unknown */
    double reference[DOSE_N_QUANTITIES]; /* what the file itself calls 100 % */
    double body_high[DOSE_N_QUANTITIES]; /* largest value inside a region of the plan */
};
void dose_finish(struct dose *dose);

/* What the numbers of a quantity are in: the dose's unit, with "(w)" behind it when weights are in them, or "1/cm2". */
enum { DOSE_UNIT_SIZE = 24 };
void dose_quantity_unit(const char *dose_unit, enum dose_quantity quantity, char unit[DOSE_UNIT_SIZE]);
void dose_unit_of(const struct dose *dose, enum dose_quantity quantity, char unit[DOSE_UNIT_SIZE]);
