#pragma once
/* The phantom's anatomy: nested ellipsoids in patient LPS, and the voxel grids that contain them. Knows no files. */
#include "core/volume/volume.h"

enum phantom_label {
    PHANTOM_AIR,
    PHANTOM_SCALP,
    PHANTOM_CRANIUM,
    PHANTOM_BRAIN,
    PHANTOM_TARGET,
    PHANTOM_TUMOUR,
    PHANTOM_N_LABELS
};

struct ellipsoid {
    struct vec3 centre_lps_mm, semi_axes_mm;
};

/* A tissue fills its ellipsoid except for the ellipsoids after it, which are inside. */
struct phantom_tissue {
    const char *name;  /* also the region's name */
    const char *color; /* #rrggbb */
    struct ellipsoid shape;
    double hounsfield;
};
extern const struct phantom_tissue phantom_tissues[PHANTOM_N_LABELS]; /* [PHANTOM_AIR] has no shape */

/* A dense ball on the scalp, on the patient's left side only, to tell left from right. It is in the image, but in no
 * region. */
extern const struct ellipsoid phantom_marker;
extern const double phantom_marker_hounsfield;

/* Label at a patient point; a point on a surface belongs to the inner tissue. */
enum phantom_label phantom_label_at(struct vec3 point_lps_mm);
/* z of the scalp's upper surface at (x, y); NaN beside the head. */
double phantom_scalp_top_mm(double x_lps_mm, double y_lps_mm);

/* The image's grid: 256 x 256 x 204.8 mm around the origin for any size; indices grow towards L, P, S. Errors: as
 * grid_init. */
NODISCARD bool phantom_image_grid(const uint32_t size[3], struct grid *grid, struct error *err);

/* Makes image and labels on one grid: int16 Hounsfield units, uint8 labels. The noise is a hash of seed and voxel, so
 * it is independent of the number of threads. One reference each, the caller's. Errors: ERROR_MEMORY, ERROR_LIMIT. */
NODISCARD bool phantom_fill_head(const struct grid *grid, uint64_t seed, struct volume **ct, struct volume **labels,
                                 struct error *err);

/* Hashes a 64-bit number to a well-mixed one; the phantom's only source of randomness. */
uint64_t phantom_mix(uint64_t value);
