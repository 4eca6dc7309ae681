#pragma once
/* A beam: the line it enters along, its aperture, and what a treatment plan says about its delivery. */
#include <stddef.h>
#include <stdint.h>

#include "core/math/vec.h"

/* How the patient lies on the table: head or feet first (towards the gantry); on the back (supine), on the face
 * (prone), or on the right or left side (decubitus). */
enum patient_position {
    PATIENT_POSITION_UNKNOWN,
    PATIENT_HFS,
    PATIENT_HFP,
    PATIENT_FFS,
    PATIENT_FFP,
    PATIENT_HFDR,
    PATIENT_HFDL,
    PATIENT_FFDR,
    PATIENT_FFDL
};
const char *patient_position_word(enum patient_position position); /* "HFS", ...; "" when unknown */
bool patient_position_from_word(const char *word, enum patient_position *position);

/* Numbers that the plan does not give are not-a-number. Angles in degrees, IEC 61217. */
struct beam_delivery {
    int64_t number;     /* in the plan */
    char radiation[17]; /* "PHOTON", "ELECTRON", "NEUTRON", "PROTON", ...; "" when the plan does not say */
    char machine[17];
    enum patient_position patient_position; /* as used: PATIENT_HFS where the plan gives none */
    double gantry_deg, collimator_deg, couch_deg, energy_mev;
    double gantry_stop_deg;   /* at the last control point; gantry_deg for a fixed gantry */
    double gantry_travel_deg; /* over all control points, clockwise positive as seen by who faces the gantry; 0 for a
                                 fixed one */
    size_t n_control_points;
    double sad_mm, ssd_mm;
    /* Edges of the opening in the plane of the isocentre, along the collimator's axes. */
    double jaws_x_mm[2], jaws_y_mm[2];       /* of the jaws, at the first control point */
    double opening_x_mm[2], opening_y_mm[2]; /* of jaws, leaves and blocks together, the hull over all control points */
    double opening_cm2;                      /* at the first control point */
    struct vec3 collimator_x_lps, collimator_y_lps; /* unit vectors */
    double dose_gy, meterset;                       /* per fraction */
    char meterset_unit[8];                          /* "MU", "MINUTE" */
    int64_t n_fractions;                            /* 0 when the plan does not say */
};

#define BEAM_MAX_APERTURE_MM 2000.0
#define BEAM_MAX_PLACE_MM 1e6   /* no coordinate of a beam is further out */
#define BEAM_MIN_LENGTH_MM 1e-6 /* entry and target are further apart */
struct beam {
    char id[64];
    struct vec3 entry_lps_mm,
        target_lps_mm;  /* BEAM_MIN_LENGTH_MM apart; from a plan: source at the first control point, isocentre */
    double aperture_mm; /* diameter up to BEAM_MAX_APERTURE_MM; not-a-number when unknown or not round */
    bool has_delivery;  /* a treatment plan gave it */
    char name[65];      /* as the plan gives it, UTF-8; "" without one */
    struct beam_delivery delivery;
};

/* Where a point of the gantry's system is in the patient, relative to the isocentre.
 *
 *   point_gantry_mm  IEC 61217: origin in the isocentre, +z to the source, +y (gantry at 0) from the table's foot to
 * the gantry, +x to the right of who faces the gantry angles           gantry rotates by the right-hand rule about +y
 * of the room, the table about +z of the room (up), the table top about its eccentric axis the same way, then pitches
 * about its +x and rolls about its +y returns          in patient axes (L, P, S), mm source           IEC 61217
 * coordinate systems f, g, s, e, t as DICOM PS3.3 C.8.8.14 and C.8.8.25 use them; patient axes for the position from
 * PS3.3 C.7.3.1.1.2 */
struct beam_angles {
    double gantry_deg, couch_deg, eccentric_deg, pitch_deg, roll_deg;
};
struct vec3 beam_patient_from_gantry(struct vec3 point_gantry_mm, const struct beam_angles *angles,
                                     enum patient_position position);
