/* Reads RT Plan objects: beams from control points and patient setups, doses and metersets from fraction groups. */
#include "core/formats/dicom/dicom_rtplan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_rtplan_opening.h"

#define RTPLAN_CLASS "1.2.840.10008.5.1.4.1.1.481.5"
#define RTIONPLAN_CLASS "1.2.840.10008.5.1.4.1.1.481.8"
#define ASSUMED_SAD_MM 1000.0
#define NEAREST_MM 1e-3           /* smallest distance accepted */
#define FURTHEST_MM 1e5           /* largest distance accepted: no source in a treatment room is further away */
#define FURTHEST_ISOCENTRE_MM 1e4 /* same for an isocentre coordinate; equals GRID_FARTHEST_MM */
#define MOST_ENERGY 2000.0        /* MeV, or MeV per nucleon; X-ray tubes, in kV, are far below */
#define MOST_DOSE_GY 1000.0
#define MOST_METERSET 1e6
#define MOST_FRACTIONS 1000

enum {
    SOP_CLASS = DICOM_TAG(0x0008, 0x0016),
    SOP_INSTANCE = DICOM_TAG(0x0008, 0x0018),
    MODALITY = DICOM_TAG(0x0008, 0x0060),
    REFERENCED_INSTANCE = DICOM_TAG(0x0008, 0x1155),
    PATIENT_POSITION = DICOM_TAG(0x0018, 0x5100),
    FRAME_UID = DICOM_TAG(0x0020, 0x0052),
    PLAN_LABEL = DICOM_TAG(0x300a, 0x0002),
    PLAN_NAME = DICOM_TAG(0x300a, 0x0003),
    PLAN_DESCRIPTION = DICOM_TAG(0x300a, 0x0004),
    PLAN_DATE = DICOM_TAG(0x300a, 0x0006),
    PLAN_TIME = DICOM_TAG(0x300a, 0x0007),
    PLAN_INTENT = DICOM_TAG(0x300a, 0x000a),
    PLAN_GEOMETRY = DICOM_TAG(0x300a, 0x000c),
    PRESCRIPTION = DICOM_TAG(0x300a, 0x000e),
    DOSE_REFERENCE_SEQUENCE = DICOM_TAG(0x300a, 0x0010),
    DOSE_REFERENCE_TYPE = DICOM_TAG(0x300a, 0x0020),
    TARGET_DOSE = DICOM_TAG(0x300a, 0x0026),
    FRACTION_SEQUENCE = DICOM_TAG(0x300a, 0x0070),
    N_FRACTIONS = DICOM_TAG(0x300a, 0x0078),
    BEAM_DOSE = DICOM_TAG(0x300a, 0x0084),
    BEAM_METERSET = DICOM_TAG(0x300a, 0x0086),
    BEAM_SEQUENCE = DICOM_TAG(0x300a, 0x00b0),
    MACHINE_NAME = DICOM_TAG(0x300a, 0x00b2),
    METERSET_UNIT = DICOM_TAG(0x300a, 0x00b3),
    SOURCE_AXIS_DISTANCE = DICOM_TAG(0x300a, 0x00b4),
    BEAM_NUMBER = DICOM_TAG(0x300a, 0x00c0),
    BEAM_NAME = DICOM_TAG(0x300a, 0x00c2),
    BEAM_DESCRIPTION = DICOM_TAG(0x300a, 0x00c3),
    RADIATION_TYPE = DICOM_TAG(0x300a, 0x00c6),
    DELIVERY_TYPE = DICOM_TAG(0x300a, 0x00ce),
    N_CONTROL_POINTS = DICOM_TAG(0x300a, 0x0110),
    CONTROL_POINT_SEQUENCE = DICOM_TAG(0x300a, 0x0111),
    BEAM_ENERGY = DICOM_TAG(0x300a, 0x0114),
    GANTRY_ANGLE = DICOM_TAG(0x300a, 0x011e),
    GANTRY_DIRECTION = DICOM_TAG(0x300a, 0x011f),
    COLLIMATOR_ANGLE = DICOM_TAG(0x300a, 0x0120),
    SUPPORT_ANGLE = DICOM_TAG(0x300a, 0x0122),
    ECCENTRIC_ANGLE = DICOM_TAG(0x300a, 0x0125),
    ISOCENTRE = DICOM_TAG(0x300a, 0x012c),
    SURFACE_DISTANCE = DICOM_TAG(0x300a, 0x0130),
    PITCH_ANGLE = DICOM_TAG(0x300a, 0x0140),
    ROLL_ANGLE = DICOM_TAG(0x300a, 0x0144),
    GANTRY_PITCH_ANGLE = DICOM_TAG(0x300a, 0x014a),
    SETUP_SEQUENCE = DICOM_TAG(0x300a, 0x0180),
    SETUP_NUMBER = DICOM_TAG(0x300a, 0x0182),
    VIRTUAL_DISTANCES = DICOM_TAG(0x300a, 0x030a),
    ION_BEAM_SEQUENCE = DICOM_TAG(0x300a, 0x03a2),
    ION_CONTROL_POINT_SEQUENCE = DICOM_TAG(0x300a, 0x03a8),
    REFERENCED_BEAM_SEQUENCE = DICOM_TAG(0x300c, 0x0004),
    REFERENCED_BEAM = DICOM_TAG(0x300c, 0x0006),
    REFERENCED_STRUCT_SEQUENCE = DICOM_TAG(0x300c, 0x0060),
    REFERENCED_SETUP = DICOM_TAG(0x300c, 0x006a),
    APPROVAL_STATUS = DICOM_TAG(0x300e, 0x0002),
    REVIEW_DATE = DICOM_TAG(0x300e, 0x0004),
    REVIEWER = DICOM_TAG(0x300e, 0x0008)
};

struct reading {
    const struct dicom_item *root;
    struct rtplan *plan;
    struct opening *opening;
    const char *where;
    struct report *report;
    struct dicom_doubts *doubts; /* doubts about the current beam */
};

/* ---- one beam --------------------------------------------------------------------------------------------------- */

static bool left_out(const struct reading *reading, const struct beam *beam, const char *why)
{
    report_add(reading->report, REPORT_WARNING, "beam.left-out", reading->where, "Beam \"%s\" %s; it is not shown.",
               beam->name, why);
    return false;
}

/* Patient position of the setup that the beam refers to; without a reference, that of the only setup. */
static enum patient_position position_of(const struct reading *reading, const struct dicom_item *beam_item,
                                         const struct beam *beam)
{
    size_t n = dicom_n_items(reading->root, SETUP_SEQUENCE);
    int64_t wanted;
    bool is_wanted = dicom_integer(beam_item, REFERENCED_SETUP, &wanted);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *setup = dicom_item_at(reading->root, SETUP_SEQUENCE, i);
        int64_t number;
        if (is_wanted && n > 1 && (!dicom_integer(setup, SETUP_NUMBER, &number) || number != wanted))
            continue;
        char word[17];
        enum patient_position position;
        if (!dicom_text(setup, PATIENT_POSITION, word, sizeof word))
            break;
        if (patient_position_from_word(word, &position))
            return position;
        report_add(
            reading->report, REPORT_WARNING, "beam.position-assumed", reading->where,
            "Beam \"%s\": the patient's position is \"%s\", which is not known; head first, on the back (HFS) was taken.",
            beam->name, word);
        return PATIENT_HFS;
    }
    report_add(reading->report, REPORT_WARNING, "beam.position-assumed", reading->where,
               "Beam \"%s\": the plan does not say how the patient lies; head first, on the back (HFS) was taken.",
               beam->name);
    return PATIENT_HFS;
}

static void fill_unknown(struct beam_delivery *d)
{
    *d = (struct beam_delivery){ 0 };
    d->gantry_deg = d->collimator_deg = d->couch_deg = d->energy_mev = d->gantry_stop_deg = NAN;
    d->sad_mm = d->ssd_mm = d->opening_cm2 = d->dose_gy = d->meterset = NAN;
    for (int i = 0; i < 2; i++)
        d->jaws_x_mm[i] = d->jaws_y_mm[i] = d->opening_x_mm[i] = d->opening_y_mm[i] = NAN;
}

static bool read_distance(const struct reading *reading, const struct dicom_item *item, uint32_t tag, const char *name,
                          double *mm)
{
    return dicom_number_within(item, tag, name, NEAREST_MM, FURTHEST_MM, mm, reading->doubts);
}

static void read_words(const struct reading *reading, const struct dicom_item *item, size_t index, struct beam *beam)
{
    struct beam_delivery *d = &beam->delivery;
    if (!dicom_integer(item, BEAM_NUMBER, &d->number))
        d->number = (int64_t)index + 1;
    if (!dicom_text(item, BEAM_NAME, beam->name, sizeof beam->name) &&
        !dicom_text(item, BEAM_DESCRIPTION, beam->name, sizeof beam->name))
        snprintf(beam->name, sizeof beam->name, "Beam %lld", (long long)d->number);
    snprintf(beam->id, sizeof beam->id, "%.*s", (int)sizeof beam->id - 1, beam->name);
    dicom_text(item, RADIATION_TYPE, d->radiation, sizeof d->radiation);
    dicom_text(item, MACHINE_NAME, d->machine, sizeof d->machine);
    dicom_text(item, METERSET_UNIT, d->meterset_unit, sizeof d->meterset_unit);
    if (!read_distance(reading, item, SOURCE_AXIS_DISTANCE, "source-axis distance", &d->sad_mm) &&
        !read_distance(reading, item, VIRTUAL_DISTANCES, "virtual source-axis distance", &d->sad_mm)) {
        d->sad_mm = ASSUMED_SAD_MM;
        report_add(reading->report, REPORT_WARNING, "beam.distance-assumed", reading->where,
                   "Beam \"%s\": the plan does not say how far the source is from the isocentre; %g mm was taken.",
                   beam->name, ASSUMED_SAD_MM);
    }
}

/* The state of a beam as control points go by: a control point inherits every value it does not give. */
struct beam_state {
    struct beam_angles angles;
    double collimator_deg;
    struct vec3 isocentre_lps_mm;
    bool has_gantry, has_isocentre;
    bool moves_isocentre, moves_couch, has_gantry_pitch;
    char direction[8];
};

/* Reads an angle in degrees. More than a whole turn is reduced and reported. Returns false if there is no number. */
static bool read_angle(const struct reading *reading, const struct dicom_item *item, uint32_t tag, const char *name,
                       double *deg)
{
    double found;
    if (!dicom_number(item, tag, &found))
        return false;
    *deg = found;
    if (fabs(found) > 360) {
        *deg = fmod(found, 360);
        dicom_doubt_place(reading->doubts, tag, "%s (%04X,%04X) is %g, expected -360 to 360; %g was taken", name,
                          tag >> 16, tag & 0xFFFF, found, *deg);
    }
    return true;
}

/* Reads the isocentre, patient LPS. Returns false if it is absent, or out of range, which is reported. */
static bool read_isocentre(const struct reading *reading, const struct dicom_item *item, struct vec3 *isocentre)
{
    double at[3];
    size_t n = dicom_numbers(item, ISOCENTRE, at, 3);
    if (n == 0)
        return false;
    if (n != 3) {
        dicom_doubt_place(reading->doubts, ISOCENTRE, "isocentre (300A,012C) has %zu values, expected 3", n);
        return false;
    }
    for (int i = 0; i < 3; i++)
        if (!(fabs(at[i]) <= FURTHEST_ISOCENTRE_MM)) {
            dicom_doubt_place(reading->doubts, ISOCENTRE,
                              "isocentre (300A,012C): value %d is %g mm, expected at most %g", i + 1, at[i],
                              FURTHEST_ISOCENTRE_MM);
            return false;
        }
    *isocentre = vec3(at[0], at[1], at[2]);
    return true;
}

/* Signed angle from one control point to the next, in the rotation direction given at the first of the two. */
static double travelled_deg(double from_deg, double to_deg, const char *direction)
{
    double clockwise = fmod(to_deg - from_deg, 360);
    clockwise += clockwise < 0 ? 360 : 0;
    if (strcmp(direction, "CW") == 0)
        return clockwise;
    if (strcmp(direction, "CC") == 0)
        return clockwise > 0 ? clockwise - 360 : 0;
    return clockwise > 180 ? clockwise - 360 : clockwise; /* no direction given: the shorter way */
}

static void read_control_point(const struct reading *reading, struct beam_state *state, const struct dicom_item *item,
                               bool is_first, struct beam_delivery *d)
{
    double gantry_before = state->angles.gantry_deg, couch_before = state->angles.couch_deg, pitch = 0;
    struct vec3 isocentre;
    state->has_gantry |= read_angle(reading, item, GANTRY_ANGLE, "gantry angle", &state->angles.gantry_deg);
    (void)read_angle(reading, item, SUPPORT_ANGLE, "patient support angle", &state->angles.couch_deg);
    (void)read_angle(reading, item, ECCENTRIC_ANGLE, "table top eccentric angle", &state->angles.eccentric_deg);
    (void)read_angle(reading, item, PITCH_ANGLE, "table top pitch angle", &state->angles.pitch_deg);
    (void)read_angle(reading, item, ROLL_ANGLE, "table top roll angle", &state->angles.roll_deg);
    (void)read_angle(reading, item, COLLIMATOR_ANGLE, "beam limiting device angle", &state->collimator_deg);
    state->has_gantry_pitch |= dicom_number(item, GANTRY_PITCH_ANGLE, &pitch) && fabs(pitch) > 0.01;
    if (read_isocentre(reading, item, &isocentre)) {
        if (!state->has_isocentre)
            state->isocentre_lps_mm = isocentre;
        state->moves_isocentre |= vec3_length(vec3_sub(isocentre, state->isocentre_lps_mm)) > 0.1;
        state->has_isocentre = true;
    }
    if (is_first) {
        (void)dicom_number_within(item, BEAM_ENERGY, "nominal beam energy", 0, MOST_ENERGY, &d->energy_mev,
                                  reading->doubts);
        (void)read_distance(reading, item, SURFACE_DISTANCE, "source to surface distance", &d->ssd_mm);
    } else {
        d->gantry_travel_deg += travelled_deg(gantry_before, state->angles.gantry_deg, state->direction);
        state->moves_couch |= fabs(state->angles.couch_deg - couch_before) > 0.1;
    }
    if (dicom_text(item, GANTRY_DIRECTION, state->direction, sizeof state->direction) &&
        strcmp(state->direction, "CW") != 0 && strcmp(state->direction, "CC") != 0 &&
        strcmp(state->direction, "NONE") != 0)
        dicom_doubt(reading->doubts, "gantry rotation direction (300A,011F) is \"%s\", expected CW, CC or NONE",
                    state->direction);
}

/* Sets the collimator axes in the patient by the first control point. */
static void place_collimator(struct beam_delivery *d, const struct beam_state *state)
{
    const struct beam_angles *angles = &state->angles;
    double turn = state->collimator_deg * MATH_PI / 180;
    d->gantry_deg = d->gantry_stop_deg = angles->gantry_deg;
    d->couch_deg = angles->couch_deg;
    d->collimator_deg = state->collimator_deg;
    d->collimator_x_lps = beam_patient_from_gantry(vec3(cos(turn), sin(turn), 0), angles, d->patient_position);
    d->collimator_y_lps = beam_patient_from_gantry(vec3(-sin(turn), cos(turn), 0), angles, d->patient_position);
}

static void report_state(const struct reading *reading, const struct beam *beam, const struct beam_state *state)
{
    if (!state->has_gantry)
        report_add(reading->report, REPORT_WARNING, "beam.angle-assumed", reading->where,
                   "Beam \"%s\": the plan does not give the gantry's angle; 0 was taken.", beam->name);
    if (state->moves_isocentre || state->moves_couch)
        report_add(reading->report, REPORT_NOTE, "beam.moves", reading->where,
                   "Beam \"%s\": %s moves during the beam; it is shown as it starts.", beam->name,
                   state->moves_isocentre ? "the isocentre" : "the table");
    if (state->has_gantry_pitch)
        report_add(reading->report, REPORT_WARNING, "beam.pitch", reading->where,
                   "Beam \"%s\": the gantry is pitched, which is not regarded; its direction is wrong by that angle.",
                   beam->name);
    const struct beam_delivery *d = &beam->delivery;
    if (fabs(d->gantry_travel_deg) > 0.1)
        report_add(
            reading->report, REPORT_NOTE, "beam.arc", reading->where,
            "Beam \"%s\" turns from %.1f to %.1f degrees over %zu control points; its line is shown where it starts.",
            beam->name, d->gantry_deg, d->gantry_stop_deg, d->n_control_points);
}

/* Reads one beam. Returns false without setting err for a beam that is reported and left out. */
static bool read_beam(const struct reading *reading, const struct dicom_item *item, size_t index, bool is_ion,
                      struct beam *beam, struct error *err)
{
    uint32_t sequence = is_ion ? ION_CONTROL_POINT_SEQUENCE : CONTROL_POINT_SEQUENCE;
    struct beam_delivery *d = &beam->delivery;
    struct beam_state state = { 0 };
    char type[17];
    *beam = (struct beam){ .has_delivery = true, .aperture_mm = NAN };
    fill_unknown(d);
    read_words(reading, item, index, beam);
    d->n_control_points = dicom_n_items(item, sequence);
    if (d->n_control_points > RTPLAN_MAX_CONTROL_POINTS)
        return error_set(err, ERROR_LIMIT, "%s: beam \"%s\" has %zu control points; the limit is %d", reading->where,
                         beam->name, d->n_control_points, RTPLAN_MAX_CONTROL_POINTS);
    if (dicom_text(item, DELIVERY_TYPE, type, sizeof type) && strcmp(type, "SETUP") == 0)
        return left_out(reading, beam, "is for setting up the patient and not for treatment");
    if (d->n_control_points == 0)
        return left_out(reading, beam, "has no control point");
    if (!opening_init(reading->opening, item, err)) {
        error_prefix(err, "%s: beam \"%s\"", reading->where, beam->name);
        return false;
    }
    d->patient_position = position_of(reading, item, beam);
    for (size_t i = 0; i < d->n_control_points; i++) {
        const struct dicom_item *point = dicom_item_at(item, sequence, i);
        read_control_point(reading, &state, point, i == 0, d);
        opening_move(reading->opening, point, i + 1);
        opening_measure(reading->opening, i == 0, d);
        if (i == 0)
            place_collimator(d, &state);
        if (i == 0 && !isnan(d->opening_cm2))
            opening_outline(reading->opening, &d->outline);
    }
    if (!state.has_isocentre)
        return left_out(reading, beam, "has no isocentre, so nothing says where it is in the patient");
    beam->target_lps_mm = state.isocentre_lps_mm;
    /* the z axis of the collimator system points to the source */
    beam->entry_lps_mm =
        vec3_add(beam->target_lps_mm, vec3_scale(vec3_cross(d->collimator_x_lps, d->collimator_y_lps), d->sad_mm));
    d->gantry_stop_deg = state.angles.gantry_deg;
    double diameter_mm = opening_diameter_mm(reading->opening, d);
    beam->aperture_mm = diameter_mm > 0 && diameter_mm <= BEAM_MAX_APERTURE_MM ? diameter_mm : NAN;
    int64_t n_said;
    if (dicom_integer(item, N_CONTROL_POINTS, &n_said) && n_said != (int64_t)d->n_control_points)
        report_add(reading->report, REPORT_WARNING, "beam.control-points", reading->where,
                   "Beam \"%s\" says %lld control points and has %zu; those it has were taken.", beam->name,
                   (long long)n_said, d->n_control_points);
    report_state(reading, beam, &state);
    return true;
}

/* ---- the whole plan --------------------------------------------------------------------------------------------- */

/* Lists the numbers of the beams that treat. */
static void list_treating(const struct reading *reading, uint32_t sequence, size_t n)
{
    struct rtplan *plan = reading->plan;
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(reading->root, sequence, i);
        int64_t number;
        char type[17];
        bool is_double = false;
        if (dicom_text(item, DELIVERY_TYPE, type, sizeof type) && strcmp(type, "SETUP") == 0)
            continue;
        if (!dicom_integer(item, BEAM_NUMBER, &number))
            number = (int64_t)i + 1;
        for (size_t o = 0; o < plan->n_treating; o++)
            is_double |= plan->treating[o] == number;
        if (is_double || plan->n_treating == RTPLAN_MAX_BEAMS) {
            plan->n_treating = 0;
            return;
        }
        plan->treating[plan->n_treating++] = number;
    }
}

static bool read_beams(const struct reading *reading, struct error *err)
{
    struct rtplan *plan = reading->plan;
    bool is_ion = dicom_n_items(reading->root, BEAM_SEQUENCE) == 0;
    uint32_t sequence = is_ion ? ION_BEAM_SEQUENCE : BEAM_SEQUENCE;
    size_t n = dicom_n_items(reading->root, sequence);
    plan->beams = mem_array(n < RTPLAN_MAX_BEAMS ? n : RTPLAN_MAX_BEAMS, sizeof *plan->beams, UINT64_MAX, err);
    if (!plan->beams)
        return false;
    list_treating(reading, sequence, n);
    for (size_t i = 0; i < n; i++) {
        if (plan->n_beams >= RTPLAN_MAX_BEAMS) {
            report_add(reading->report, REPORT_WARNING, "beam.left-out", reading->where,
                       "Beams from the %zu. of %zu on are left out: at most %d.", i + 1, n, RTPLAN_MAX_BEAMS);
            break;
        }
        struct error reason = { 0 };
        struct beam *beam = &plan->beams[plan->n_beams];
        *reading->doubts = (struct dicom_doubts){ 0 };
        bool is_read = read_beam(reading, dicom_item_at(reading->root, sequence, i), i, is_ion, beam, &reason);
        char who[80];
        snprintf(who, sizeof who, "Beam \"%s\"", beam->name);
        dicom_doubts_report(reading->doubts, "beam.bad-value", who, reading->where, reading->report);
        if (is_read) {
            plan->n_beams++;
        } else if (reason.code != ERROR_NONE) {
            if (err)
                *err = reason;
            return false;
        }
    }
    if (n > 0 && is_ion)
        report_add(reading->report, REPORT_WARNING, "beam.ion", reading->where,
                   "An RT Ion Plan of %zu beams: their lines, angles, jaws and blocks are "
                   "shown; snouts, range shifters, modulators, scan spots and the energies behind the first are not.",
                   n);
    if (n == 0)
        report_add(reading->report, REPORT_NOTE, "beam.none", reading->where, "The plan has no external beam.");
    return true;
}

/* Reads dose and meterset of one beam in a fraction group. Returns false if the plan has no beam of that number. */
static bool read_reference(const struct reading *reading, const struct dicom_item *item, int64_t number,
                           int64_t n_fractions)
{
    struct rtplan *plan = reading->plan;
    bool is_known = false;
    for (size_t b = 0; b < plan->n_beams; b++) {
        struct beam_delivery *d = &plan->beams[b].delivery;
        is_known |= d->number == number;
        if (d->number != number || d->n_fractions != 0 || !isnan(d->meterset))
            continue;
        d->n_fractions = n_fractions;
        (void)dicom_number_within(item, BEAM_DOSE, "beam dose", 0, MOST_DOSE_GY, &d->dose_gy, reading->doubts);
        (void)dicom_number_within(item, BEAM_METERSET, "beam meterset", 0, MOST_METERSET, &d->meterset,
                                  reading->doubts);
    }
    return is_known;
}

/* Returns true if the plan has a beam of that number, also one that is left out. */
static bool has_beam_number(const struct reading *reading, int64_t number)
{
    for (int kind = 0; kind < 2; kind++) {
        uint32_t sequence = kind ? ION_BEAM_SEQUENCE : BEAM_SEQUENCE;
        size_t n = dicom_n_items(reading->root, sequence);
        for (size_t i = 0; i < n; i++) {
            int64_t other;
            if (dicom_integer(dicom_item_at(reading->root, sequence, i), BEAM_NUMBER, &other)
                    ? other == number
                    : (int64_t)i + 1 == number)
                return true;
        }
    }
    return false;
}

/* Reads meterset and dose of each beam from the fraction groups; the first group with the beam counts. */
static void read_fractions(const struct reading *reading)
{
    struct rtplan *plan = reading->plan;
    size_t n_groups = dicom_n_items(reading->root, FRACTION_SEQUENCE);
    for (size_t g = 0; g < n_groups; g++) {
        const struct dicom_item *group = dicom_item_at(reading->root, FRACTION_SEQUENCE, g);
        double n_said = 0;
        (void)dicom_number_within(group, N_FRACTIONS, "number of fractions planned", 0, MOST_FRACTIONS, &n_said,
                                  reading->doubts);
        int64_t n_fractions = (int64_t)n_said;
        plan->n_fractions = plan->n_fractions ? plan->n_fractions : n_fractions;
        size_t n = dicom_n_items(group, REFERENCED_BEAM_SEQUENCE);
        for (size_t i = 0; i < n; i++) {
            const struct dicom_item *item = dicom_item_at(group, REFERENCED_BEAM_SEQUENCE, i);
            int64_t number;
            if (dicom_integer(item, REFERENCED_BEAM, &number) && !read_reference(reading, item, number, n_fractions) &&
                !has_beam_number(reading, number))
                dicom_doubt(reading->doubts,
                            "fraction group %zu refers to beam %lld (300C,0006), which the plan does not have", g + 1,
                            (long long)number);
        }
    }
    for (size_t a = 0; a < plan->n_beams; a++)
        for (size_t b = 0; b < a; b++)
            if (plan->beams[a].delivery.number == plan->beams[b].delivery.number)
                dicom_doubt(reading->doubts, "beam number (300A,00C0) is %lld for both \"%.40s\" and \"%.40s\"",
                            (long long)plan->beams[a].delivery.number, plan->beams[b].name, plan->beams[a].name);
}

static void read_prescription(const struct reading *reading)
{
    struct rtplan *plan = reading->plan;
    plan->target_dose_gy = NAN;
    size_t n = dicom_n_items(reading->root, DOSE_REFERENCE_SEQUENCE);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(reading->root, DOSE_REFERENCE_SEQUENCE, i);
        char type[17];
        double dose_gy;
        if (dicom_text(item, DOSE_REFERENCE_TYPE, type, sizeof type) && strcmp(type, "TARGET") == 0 &&
            dicom_number_within(item, TARGET_DOSE, "target prescription dose", 0, MOST_DOSE_GY, &dose_gy,
                                reading->doubts))
            plan->target_dose_gy = fmax(isnan(plan->target_dose_gy) ? dose_gy : plan->target_dose_gy, dose_gy);
    }
}

static void read_plan_words(const struct dicom_item *root, struct rtplan *plan)
{
    dicom_text(root, PLAN_LABEL, plan->label, sizeof plan->label);
    dicom_text(root, PLAN_NAME, plan->name, sizeof plan->name);
    dicom_text(root, PLAN_DESCRIPTION, plan->description, sizeof plan->description);
    dicom_text(root, PRESCRIPTION, plan->prescription, sizeof plan->prescription);
    dicom_text(root, PLAN_INTENT, plan->intent, sizeof plan->intent);
    dicom_text(root, PLAN_GEOMETRY, plan->geometry, sizeof plan->geometry);
    dicom_text(root, PLAN_DATE, plan->date, sizeof plan->date);
    dicom_text(root, PLAN_TIME, plan->time, sizeof plan->time);
    dicom_text(root, APPROVAL_STATUS, plan->approval, sizeof plan->approval);
    dicom_text(root, REVIEW_DATE, plan->review_date, sizeof plan->review_date);
    dicom_text(root, REVIEWER, plan->reviewer, sizeof plan->reviewer);
    dicom_text(root, SOP_INSTANCE, plan->uid, sizeof plan->uid);
    dicom_text(root, FRAME_UID, plan->frame_uid, sizeof plan->frame_uid);
}

struct rtplan *rtplan_read(const struct dicom_file *file, const char *where, struct report *report, struct error *err)
{
    const struct dicom_item *root = dicom_root(file);
    char class[DICOM_UID_SIZE], modality[17];
    dicom_text(root, SOP_CLASS, class, sizeof class);
    dicom_text(root, MODALITY, modality, sizeof modality);
    if (strcmp(class, RTPLAN_CLASS) != 0 && strcmp(class, RTIONPLAN_CLASS) != 0 && strcmp(modality, "RTPLAN") != 0) {
        error_set(err, ERROR_UNSUPPORTED, "%s: a DICOM object of modality \"%s\", expected RTPLAN", where, modality);
        return NULL;
    }
    struct rtplan *plan = mem_new(sizeof *plan);
    read_plan_words(root, plan);
    const struct dicom_item *structures = dicom_item_at(root, REFERENCED_STRUCT_SEQUENCE, 0);
    if (structures)
        dicom_text(structures, REFERENCED_INSTANCE, plan->struct_uid, sizeof plan->struct_uid);
    struct dicom_doubts doubts = { 0 };
    struct reading reading = { root, plan, mem_new(sizeof(struct opening)), where, report, &doubts };
    reading.opening->doubts = &doubts;
    dicom_numbers_report(file, 0, where, report);
    bool is_read = read_beams(&reading, err);
    free(reading.opening);
    if (!is_read) {
        rtplan_destroy(plan);
        return NULL;
    }
    doubts = (struct dicom_doubts){ 0 };
    read_fractions(&reading);
    read_prescription(&reading);
    dicom_doubts_report(&doubts, "beam.bad-value", "The plan", where, report);
    return plan;
}

void rtplan_destroy(struct rtplan *plan)
{
    if (!plan)
        return;
    free(plan->beams);
    free(plan);
}

const char *rtplan_beam_name(void *plan, int64_t number)
{
    const struct rtplan *known = plan;
    for (size_t i = 0; known && i < known->n_beams; i++)
        if (known->beams[i].delivery.number == number)
            return known->beams[i].name;
    return NULL;
}
