#pragma once
/* The values of a volume within a flat ellipse in the patient. */
#include "core/volume/volume.h"

/* Largest number of samples, about: a larger ellipse is sampled more coarsely. */
enum { ELLIPSE_MAX_SAMPLES = 1000000 };

struct ellipse_values {
    double area_mm2, step_mm;   /* step: the distance of samples */
    size_t n, n_left_out;       /* samples with a value; those outside the grid or beside a value that is not finite */
    double mean, sd, low, high; /* of n samples, in the volume's unit; sd divides by n. NAN without a sample */
};
/* Samples a square lattice in the ellipse's plane, with the centre as one of its points, tri-linearly; the step is the
 * grid's smallest spacing.
 *   a, b    ends of two conjugate half axes: the ellipse is centre + s (a - centre) + t (b - centre) with
 *           s^2 + t^2 <= 1. Square to each other they are the half axes
 *   returns false if the three points are on one line: there is no plane. thread any */
NODISCARD bool ellipse_values(const struct volume *volume, struct vec3 centre_lps_mm, struct vec3 a_lps_mm,
                              struct vec3 b_lps_mm, struct ellipse_values *values);
