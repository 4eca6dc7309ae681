#pragma once
/* The phantom's dose: the published table on the beam's axis, and a stated formula off it. Knows no files. */
#include "core/dose/dose.h"

enum { PHANTOM_N_DEPTHS = 12, PHANTOM_N_COMPONENTS = 4 };

/* The beam enters along -z (from above the head) on the axis x = y = 0. */
extern const double phantom_beam_radius_mm;  /* 50 */
extern const double phantom_source_z_lps_mm; /* 150: where the parallel beam starts */

/* One column of the table: dose in Gy per minute of beam at 1e10 n/cm2/s, in brain tissue at every depth. */
struct phantom_component {
    enum dose_quantity quantity;
    bool is_per_ppm;
    double table[PHANTOM_N_DEPTHS];
    double edge_mm, edge_per_depth; /* width of the beam's edge at depth d: edge_mm + edge_per_depth * d */
};
extern const struct phantom_component phantom_components[PHANTOM_N_COMPONENTS];
extern const double phantom_depths_mm[PHANTOM_N_DEPTHS]; /* beneath the scalp, on the axis */

/* Dose of a component at a depth and a distance from the axis:
 *
 *     D(d, r) = T(d) (1 + exp(-R / w)) / (1 + exp((r - R) / w)),   w = edge_mm + edge_per_depth d,   R = the beam's
 * radius
 *
 * T passes through the table: between depths the logarithm is a monotone cubic (F. N. Fritsch, R. E. Carlson, SIAM J.
 * Numer. Anal. 17 (1980) 238), before the first and after the last it goes on with the slope it has there. The lateral
 * factor is 1 on the axis. The edges are ours, near those of the BMRR 8 cm depth-radius table that SERA distributes.
 * depth_mm >= 0, radius_mm >= 0 */
double phantom_dose(const struct phantom_component *component, double depth_mm, double radius_mm);

/* The same at a patient point, its depth measured downward from the scalp above it; 0 outside the head. */
double phantom_dose_at(const struct phantom_component *component, struct vec3 point_lps_mm);

/* Cells of 4 mm over the head; every depth of the table is the centre of a cell on the axis, the first at 2 mm. */
NODISCARD bool phantom_dose_grid(struct grid *grid, struct error *err);
/* float32 and bytes (1 inside the head). One reference, the caller's; NULL on failure. errors ERROR_MEMORY */
NODISCARD struct volume *phantom_dose_volume(const struct phantom_component *component, const struct grid *grid,
                                             struct error *err);
NODISCARD struct volume *phantom_dose_mask(const struct grid *grid, struct error *err);
