#pragma once
/* A beam's line in the numbers that SERA takes and writes. Knows no file. Any thread.
 *
 *   source   SERA 1C1, input card of seraMC and header of its .rst. SERA's axes are x = PA (towards anterior), y = RL
 *            (towards the patient's left), z = IS (towards superior), in cm; so L = y, P = -x, S = z. The line begins
 * at target + z_cm (sin phi sin theta, -sin phi cos theta, cos phi): phi is the angle from superior, theta turns about
 * it, 0 from the patient's right, 90 from anterior. */
#include "core/math/vec.h"

struct sera_angles {
    double target_cm[3]; /* PA, RL, IS */
    double z_cm;         /* distance from the line's begin to the target; SERA's Zb */
    double phi_deg;      /* 0 to 180 */
    double theta_deg;    /* above -180 to 180; at phi 0 and 180, where it has no meaning, 0 */
};
/* entry and target, patient LPS in mm, are at least BEAM_MIN_LENGTH_MM (core/beam/beam.h) apart. */
struct sera_angles sera_angles_of(struct vec3 entry_lps_mm, struct vec3 target_lps_mm);
/* Unit vector from the target towards the source, patient LPS. Any finite angles. */
struct vec3 sera_angles_towards_source(double phi_deg, double theta_deg);
struct vec3 sera_angles_target_lps_mm(const struct sera_angles *angles);
struct vec3 sera_angles_entry_lps_mm(const struct sera_angles *angles);

/* The two lines that a beam has in seraMC's input card, its third and fourth, between lines with # that say what each
 * number is. Returns text. */
enum { SERA_CARD_SIZE = 1024 };
char *sera_card(const struct sera_angles *angles, char text[SERA_CARD_SIZE]);
