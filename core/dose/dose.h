#pragma once
/* A dose as the plan gives it: components on their own grids, its unit, and its reference (per what). No weights, no
 * pictures. Frozen once part of a plan; functions without state: any thread. */
#include "core/volume/volume.h"

/* Physical doses, fluences, and two quantities whose files already contain weights that cannot be removed. Those last
 * two have names of their own, and no sum may mix them with the others. */
enum dose_quantity {
    DOSE_TOTAL, /* physical, sum of all components */
    DOSE_BORON,
    DOSE_NITROGEN,
    DOSE_FAST,
    DOSE_GAMMA,
    DOSE_OTHER, /* recoils and captures other than the above */
    DOSE_FAST_FLUENCE,
    DOSE_EPITHERMAL_FLUENCE,
    DOSE_THERMAL_FLUENCE,
    DOSE_BLOOD_BORON,    /* boron per ppm in blood; each tissue's ratio to blood is included */
    DOSE_WEIGHTED_TOTAL, /* biological weights are included, and the boron that the file assumes */
    DOSE_N_QUANTITIES
};
const char *dose_quantity_word(enum dose_quantity quantity); /* "total", "boron", "thermal-fluence", ... */
bool dose_quantity_from_word(const char *word, enum dose_quantity *quantity);
bool dose_quantity_is_fluence(enum dose_quantity quantity);

struct dose_component {
    enum dose_quantity quantity;
    bool is_per_ppm;       /* boron or blood boron: values are per 1 ppm of boron-10 */
    struct volume *values; /* unit: dose_unit_of */
    struct volume *error;  /* statistical error, one standard deviation, in the unit of the values; NULL: not given */
    bool has_boron_ppm;    /* total or weighted total: boron_ppm is known */
    double boron_ppm; /* ppm of boron-10 in blood included in the values, with each tissue's ratio to blood as in the
                         program that wrote the file */
};

/* Tells if a dose and the image share a DICOM frame of reference; if not, the dose may be shifted against the image. A
 * greater value is worse. */
enum dose_frame {
    DOSE_FRAME_SAME,
    DOSE_FRAME_UNKNOWN, /* the files do not say */
    DOSE_FRAME_DIFFERS,
    DOSE_N_FRAMES
};
const char *dose_frame_word(enum dose_frame frame); /* "same", "unknown", "differs" */
bool dose_frame_from_word(const char *word, enum dose_frame *frame);

/* The planning program's own figures of the dose in a region, stated beside the dose. */
enum { DOSE_MAX_STATED = 64, DOSE_STATED_NAME_SIZE = 128 };
struct dose_stated {
    char region[DOSE_STATED_NAME_SIZE]; /* name of the region in the files; "" while only its number is known */
    int64_t number;                     /* of the region in the file (ROI number) */
    double low, mean, high;             /* in the dose's unit; NaN: not stated */
    double volume_cm3;                  /* NaN: not stated */
};

struct dose {
    char id[64];
    char name[64];  /* for people; "" if the files give none */
    char unit[16];  /* "Gy", "cGy", ...; as in the plan, never assumed */
    char per[64];   /* "fraction", "250 kW-min", "minute"; "" if the plan does not say, which the report mentions */
    bool has_frame; /* frame is valid: a DICOM dose beside a DICOM image, or stated in plan.json */
    enum dose_frame frame; /* valid if has_frame */
    struct dose_component components[DOSE_N_QUANTITIES];
    size_t n_components;
    struct volume *mask; /* nonzero where values are valid; NULL: on the whole grid */
    /* Indexed by quantity; 0: unknown. */
    double reference[DOSE_N_QUANTITIES]; /* the file's own 100 % */
    double body_high[DOSE_N_QUANTITIES]; /* largest value inside any region of the plan */
    /* Figures of the only component, a total or weighted total. */
    struct dose_stated stated[DOSE_MAX_STATED];
    size_t n_stated;
};
void dose_finish(struct dose *dose);

/* Unit of a quantity: the dose's unit, followed by "(w)" if weights are included, or "1/cm2" for a fluence. */
enum { DOSE_UNIT_SIZE = 24 };
void dose_quantity_unit(const char *dose_unit, enum dose_quantity quantity, char unit[DOSE_UNIT_SIZE]);
void dose_unit_of(const struct dose *dose, enum dose_quantity quantity, char unit[DOSE_UNIT_SIZE]);
