#pragma once
/* Picking a particle track: the segment near a pixel that a person sees there, computed from the segments, not from the
 * picture. */
#include "core/scene/snapshot.h"

struct pick_track_hit {
    size_t segment;           /* index in the plan's tracks */
    struct vec3 point_lps_mm; /* of the segment, where it is nearest to the pixel in the picture */
    double distance_mm;       /* of that point from the eye */
    double distance_px;       /* of the line from the pixel, on the full-size picture; 0 within its width */
};

#define PICK_TRACK_PX 6.0
/* The segment that is drawn nearest to a pixel, of those whose line passes within PICK_TRACK_PX and that the scene
 * shows there: its classes, range and energies, what clip planes leave, what the eye sees. A point of a segment is
 * hidden behind surfaces, volumes, slices and caps that together let less than a tenth of the light pass
 * (snapshot_pick). Of segments equally near, such as those that cross under the pixel, the nearest to the eye; of those
 * equally far the first. False: there is none, tracks are not visible, or the picture is a slice pane. thread any */
bool pick_track(const struct snapshot *snapshot, double px, double py, struct pick_track_hit *hit);
