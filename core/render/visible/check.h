#pragma once
/* The check of a segmentation on a slice pane: marks and counts the pixels where a region's univels and its surface
 * differ. */
#include "core/base/image.h"
#include "core/render/visible/cut.h"
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"

/* Pixels of a picture where they differ. */
struct check_counts {
    size_t n_added;    /* enclosed by the surface, but no univels of the region */
    size_t n_left_out; /* univels outside the surface */
};

/* The check samples this far beside the middle of pixels (in pixels) and beside the plane (in voxels), so that no
 * sample lies exactly on a face of a voxel, where rounding would decide. */
#define CHECK_NUDGE 1.7e-3

/* Marks pixels that the surface encloses but that are no univels (amber, hatched upwards) and univels outside the
 * surface (blue, hatched downwards); adds both to *check.
 *
 *   surface  closed lines, filled by the even-odd rule; a row that they cross an odd number of times is not checked
 *   plane    already nudged
 *   scale    pixels of the image for one pixel of the full picture
 *   errors   ERROR_MEMORY */
NODISCARD bool check_paint(const struct cut_region *univels, const struct cut_lines *surface,
                           const struct camera *camera, const struct plane *plane, struct image *image, double scale,
                           struct check_counts *check, struct error *err);
