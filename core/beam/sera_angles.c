/* SERA's numbers of a beam, from its line and back. */
#include "core/beam/sera_angles.h"

#include <stdio.h>

static const double pole = 1e-9; /* sine of phi: 2e-7 mm beside the axis, 200 mm from the target */

struct sera_angles sera_angles_of(struct vec3 entry_lps_mm, struct vec3 target_lps_mm)
{
    struct vec3 from = vec3_sub(entry_lps_mm, target_lps_mm);
    double across = hypot(from.x, from.y), length = vec3_length(from);
    struct sera_angles angles = { .target_cm = { -target_lps_mm.y / 10, target_lps_mm.x / 10, target_lps_mm.z / 10 },
                                  .z_cm = length / 10,
                                  .phi_deg = atan2(across, from.z) * 180 / MATH_PI };
    if (across > pole * length) {
        angles.theta_deg = atan2(-from.y, -from.x) * 180 / MATH_PI;
        if (angles.theta_deg <= -180)
            angles.theta_deg = 180;
    } else
        angles.phi_deg = from.z < 0 ? 180 : 0;
    return angles;
}

struct vec3 sera_angles_towards_source(double phi_deg, double theta_deg)
{
    double phi = phi_deg * MATH_PI / 180, theta = theta_deg * MATH_PI / 180;
    return vec3(-sin(phi) * cos(theta), -sin(phi) * sin(theta), cos(phi));
}

struct vec3 sera_angles_target_lps_mm(const struct sera_angles *angles)
{
    return vec3(10 * angles->target_cm[1], -10 * angles->target_cm[0], 10 * angles->target_cm[2]);
}

struct vec3 sera_angles_entry_lps_mm(const struct sera_angles *angles)
{
    struct vec3 way = sera_angles_towards_source(angles->phi_deg, angles->theta_deg);
    return vec3_add(sera_angles_target_lps_mm(angles), vec3_scale(way, 10 * angles->z_cm));
}

char *sera_card(const struct sera_angles *angles, char text[SERA_CARD_SIZE])
{
    const double *target = angles->target_cm;
    (void)snprintf(text, SERA_CARD_SIZE,
                   "# Lines 3 and 4 of a seraMC input card. The lines with # are no part of it.\n"
                   "# target, cm: x (PA, towards anterior), y (RL, towards patient left), z (IS, towards superior)\n"
                   "%20.7E%20.7E%20.7E\n"
                   "# Zb, cm: from the target to the centre of the source plane; phi, degrees: from superior;\n"
                   "# theta, degrees: 0 from patient right, 90 from anterior\n"
                   "%20.7E%20.7E%20.7E\n"
                   "# The run must not move the beam: no iop directive.\n",
                   target[0], target[1], target[2], angles->z_cm, angles->phi_deg, angles->theta_deg);
    return text;
}
