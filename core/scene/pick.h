#pragma once
/* Picking: what lies under a pixel, computed from univels and slices, not from the picture. */
#include "core/scene/snapshot.h"

/* One thing under a pixel of the full-size view. */
struct pick_hit {
    struct vec3 point_lps_mm;
    struct subject subject; /* a region, or the image of a slice */
    double distance_mm;
};
enum { PICK_MAX_HITS = 32 };
/* Fills hits front to back, returns how many. Hits every region that the scene shows (visible, opacity > 0) as if it
 * were solid, whatever it is drawn as. On a slice pane: the point on the plane with the regions there, innermost first,
 * then the image. px, py: pixel centres are at + 0.5. */
size_t snapshot_pick(const struct snapshot *snapshot, double px, double py, struct pick_hit hits[PICK_MAX_HITS]);
