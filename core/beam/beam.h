#pragma once
/* A beam: its line, its aperture, and the delivery data of a treatment plan. Knows no file. */
#include <stddef.h>
#include <stdint.h>

#include "core/math/vec.h"

/* Patient position on the table: head or feet first (towards the gantry); supine, prone, or decubitus right or left
 * (lying on that side). */
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
const char *patient_position_word(enum patient_position position); /* "HFS", ...; "" if unknown */
bool patient_position_from_word(const char *word, enum patient_position *position);

/* The outline of an opening, in the plane of the isocentre: closed polygons, apart from each other, the first point not
 * repeated. Of jaws, leaves and blocks it is the one that leaves the least area open, within the jaws. */
enum beam_outline_kind { BEAM_OUTLINE_NONE, BEAM_OUTLINE_JAWS, BEAM_OUTLINE_LEAVES, BEAM_OUTLINE_BLOCKS };
enum { BEAM_OUTLINE_MAX_POINTS = 1600, BEAM_OUTLINE_MAX_POLYGONS = 400 };
struct beam_outline {
    enum beam_outline_kind kind; /* NONE: not given, or closed; without polygons */
    uint16_t n_polygons;
    uint16_t ends[BEAM_OUTLINE_MAX_POLYGONS]; /* polygon i has the points from ends[i - 1], of the first from 0, up to
                                                 but without ends[i] */
    float points_mm[BEAM_OUTLINE_MAX_POINTS][2]; /* along the collimator's x and y axis */
};
const char *beam_outline_word(enum beam_outline_kind kind); /* "jaws", "leaves", "blocks"; "" for NONE */
bool beam_outline_kind_from_word(const char *word, enum beam_outline_kind *kind);
static inline size_t beam_outline_begin(const struct beam_outline *outline, size_t polygon)
{
    return polygon ? outline->ends[polygon - 1] : 0;
}
static inline size_t beam_outline_n_points(const struct beam_outline *outline)
{
    return beam_outline_begin(outline, outline->n_polygons);
}

/* Delivery data of a treatment plan. Numbers not given are NaN. Angles in degrees, IEC 61217. */
struct beam_delivery {
    int64_t number;     /* number in the plan */
    char radiation[17]; /* "PHOTON", "ELECTRON", "NEUTRON", "PROTON", ...; "" if not given */
    char machine[17];
    enum patient_position patient_position; /* as used: PATIENT_HFS if the plan gives none */
    double gantry_deg, collimator_deg, couch_deg, energy_mev;
    double gantry_stop_deg;   /* at the last control point; equals gantry_deg for a fixed gantry */
    double gantry_travel_deg; /* over all control points, clockwise positive as seen facing the gantry; 0 for a fixed
                                 one */
    size_t n_control_points;
    double sad_mm, ssd_mm;
    /* Edges of the opening in the plane of the isocentre, along the collimator axes. */
    double jaws_x_mm[2], jaws_y_mm[2];       /* of the jaws, at the first control point */
    double opening_x_mm[2], opening_y_mm[2]; /* of jaws, leaves and blocks together: hull over all control points */
    double opening_cm2;                      /* at the first control point */
    struct beam_outline outline;             /* at the first control point */
    struct vec3 collimator_x_lps, collimator_y_lps; /* unit vectors */
    double dose_gy, meterset;                       /* per fraction */
    char meterset_unit[8];                          /* "MU", "MINUTE" */
    int64_t n_fractions;                            /* 0 if not given */
};

#define BEAM_MAX_APERTURE_MM 2000.0
#define BEAM_MAX_PLACE_MM 1e6   /* limit on any coordinate of a beam */
#define BEAM_MIN_LENGTH_MM 1e-6 /* smallest distance of entry and target */
struct beam {
    char id[64];
    struct vec3 entry_lps_mm, target_lps_mm; /* from a plan: source at the first control point, and isocentre */
    double aperture_mm;                      /* diameter, up to BEAM_MAX_APERTURE_MM; NaN if unknown or not round */
    bool has_delivery;                       /* delivery is valid: a treatment plan gave it */
    char name[65];                           /* as in the plan, UTF-8; "" if none */
    struct beam_delivery delivery;
};

/* Converts a point from gantry coordinates to the patient's axes, relative to the isocentre.
 *
 *   point_gantry_mm  IEC 61217: origin in the isocentre, +z to the source, +y (gantry at 0) from the table's foot to
 *                    the gantry, +x to the right of a person facing the gantry
 *   angles           the gantry rotates by the right-hand rule about the room's +y, the table about the room's +z (up),
 *                    the table top about its eccentric axis in the same sense; then it pitches about its +x and rolls
 *                    about its +y
 *   returns          patient axes (L, P, S), mm
 *   thread           any
 *   source           IEC 61217 coordinate systems f, g, s, e, t as used in DICOM PS3.3 C.8.8.14 and C.8.8.25; patient
 *                    axes for a patient position from PS3.3 C.7.3.1.1.2 */
struct beam_angles {
    double gantry_deg, couch_deg, eccentric_deg, pitch_deg, roll_deg;
};
struct vec3 beam_patient_from_gantry(struct vec3 point_gantry_mm, const struct beam_angles *angles,
                                     enum patient_position position);
/* The gantry and couch angle at which a beam comes from a direction, on a level table: of the two pairs that there are
 * the one nearer to known angles. Fills only gantry_deg and couch_deg, 0 to below 360, the others with 0. Along the
 * couch's axis of rotation, where any couch angle does, that of near.
 *
 *   towards_source_lps  of unit length, patient LPS
 *   source              as beam_patient_from_gantry, of which it is the inverse */
struct beam_angles beam_angles_from_direction(struct vec3 towards_source_lps, enum patient_position position,
                                              const struct beam_angles *near);
