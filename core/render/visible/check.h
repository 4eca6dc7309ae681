#pragma once
/* Checking a segmentation on a slice pane: where a region's univels and its surface differ. */
#include "core/base/image.h"
#include "core/render/visible/cut.h"
#include "core/scene/snapshot.h"

/* What the check of a segmentation found on a picture, in pixels of it. */
struct check_counts {
    size_t n_added;    /* enclosed by the surface, but no univels of the region */
    size_t n_left_out; /* univels outside the surface */
};

/* Everything is asked a little beside the middle of pixels and the position of the plane (in parts of a pixel, of a
 * voxel), so that what lies exactly on the border of a voxel is on the same side of its surface. */
#define CHECK_NUDGE 1.7e-3

/* Paints over what the surface encloses without being univels (amber, hatched upwards) and over univels outside it
 * (blue, hatched downwards), and counts both. surface: closed lines, filled by even and odd; a row where they do not
 * close is left as it is. errors ERROR_MEMORY */
NODISCARD bool check_paint(const struct cut_region *univels, const struct cut_lines *surface,
                           const struct camera *camera, const struct plane *plane, struct image *image, double scale,
                           struct check_counts *check, struct error *err);
