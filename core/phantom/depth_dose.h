#pragma once
/* The phantom's dose: the published table on the beam axis, and a stated formula off it. Knows no files. Any thread. */
#include "core/dose/dose.h"

enum { PHANTOM_N_DEPTHS = 12, PHANTOM_N_COMPONENTS = 4 };

/* The beam enters along -z (from above the head) on the axis x = y = 0, patient LPS. */
extern const double phantom_beam_radius_mm;  /* 50 */
extern const double phantom_source_z_lps_mm; /* 150: where the parallel beam starts */

/* One column of the table: dose in brain tissue at every depth, in Gy per minute of beam at 1e10 n/cm2/s. */
struct phantom_component {
    enum dose_quantity quantity;
    bool is_per_ppm;
    double table[PHANTOM_N_DEPTHS];
    double edge_mm, edge_per_depth; /* width of the lateral edge at depth d: edge_mm + edge_per_depth * d */
};
extern const struct phantom_component phantom_components[PHANTOM_N_COMPONENTS];
extern const double phantom_depths_mm[PHANTOM_N_DEPTHS]; /* below the scalp, on the axis */

/* Dose of a component at a depth and a distance from the axis, depth_mm >= 0, radius_mm >= 0:
 *
 *     D(d, r) = T(d) (1 + exp(-R / w)) / (1 + exp((r - R) / w)),   w = edge_mm + edge_per_depth d,   R = beam radius
 *
 * T passes through the table. Between depths, its logarithm is a monotone cubic (F. N. Fritsch, R. E. Carlson, SIAM J.
 * Numer. Anal. 17 (1980) 238); beyond the first and last depth it continues with the slope there. The lateral factor is
 * 1 on the axis. The edge widths are our own, near those of the BMRR 8 cm depth-radius table distributed with SERA. */
double phantom_dose(const struct phantom_component *component, double depth_mm, double radius_mm);

/* The dose at a patient point; depth is measured downward from the scalp above it. 0 outside the head. */
double phantom_dose_at(const struct phantom_component *component, struct vec3 point_lps_mm);

/* A grid of 4 mm cells over the head. Every depth of the table is the centre of a cell on the axis, the first one 2
 * mm. */
NODISCARD bool phantom_dose_grid(struct grid *grid, struct error *err);
/* Fills a volume: float32 dose, and uint8 with 1 inside the head. One reference, the caller's; NULL on failure. Errors:
 * ERROR_MEMORY. */
NODISCARD struct volume *phantom_dose_volume(const struct phantom_component *component, const struct grid *grid,
                                             struct error *err);
NODISCARD struct volume *phantom_dose_mask(const struct grid *grid, struct error *err);
