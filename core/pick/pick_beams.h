#pragma once
/* Where the lines of the beams that a picture draws lie under a pixel. Walls of openings are not hit. Any thread. */
#include "core/scene/beams_drawn.h"
#include "core/scene/snapshot.h"

#define PICK_BEAM_PX 4.0 /* the largest distance of a line from the pixel, on the full-size picture */

struct pick_beam_hit {
    struct vec3 point_lps_mm; /* of the line, the nearest to the pixel in the picture */
    struct subject subject;
    double px; /* distance from the pixel */
};
/* The lines within PICK_BEAM_PX of a place in the picture, the nearest to it first; returns how many. On a slice pane
 * the lines are those projected on its plane, and the points are of the lines themselves. camera: the snapshot's. */
size_t pick_beams(const struct snapshot *snapshot, const struct camera *camera, double px, double py,
                  struct pick_beam_hit hits[BEAMS_DRAWN_MAX]);
