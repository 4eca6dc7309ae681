#pragma once
/* Picking: what lies under a pixel and which of it is seen, computed from univels and slices, not from the
 * picture. */
#include "core/scene/snapshot.h"

/* One thing under a pixel of the full-size view. */
struct pick_hit {
    struct vec3 point_lps_mm;
    struct subject subject; /* a region, an isodose, a beam, or the image of a slice or of the volume (pick_volume.h) */
    double distance_mm;
    /* How much of what lies behind it the hit covers, 0 to 1: as the picture blends surfaces away from their
     * silhouettes. Outlines and points leave most of the picture free and cover a tenth of their opacity; slices and
     * caps cover all, and so does every hit in a slice pane. */
    double alpha;
    bool is_on_cap; /* on the cap of a clip plane, inside the region or the volume */
};
enum { PICK_MAX_HITS = 32 };
/* Fills hits front to back, returns how many. Hits every region that the scene shows (visible, opacity > 0) as if it
 * were solid, whatever it is drawn as. What clip planes cut off is not hit. Where the ray comes through a clip plane
 * into a region that the plane cuts, the hit is on the cap; without a cap, or if the region is drawn as lines, points
 * or a fan, it is on the region's wall behind, seen from inside. Where the ray leaves what is kept inside a region, it
 * hits the cap from behind. On one cap the innermost region comes first. An isodose is hit where its surface is
 * (pick_isodoses.h), a beam where its line is drawn within a few pixels (pick_beams.h). On a slice pane: the point on
 * the plane with the beams drawn there, then the regions, innermost first, then the image.
 * px, py: pixel centres are at + 0.5. */
size_t snapshot_pick(const struct snapshot *snapshot, double px, double py, struct pick_hit hits[PICK_MAX_HITS]);

/* Index of the hit that a person sees, of the n > 0 hits of snapshot_pick. Light goes through the hits front to back,
 * each lets 1 - alpha of it pass: the first hit behind which less than half is left; if there is none, the hit that
 * covers most. preferred, a region's index or -1, is the hit seen instead wherever at least half of the light reaches
 * it. */
size_t pick_seen(const struct pick_hit *hits, size_t n, int preferred);
