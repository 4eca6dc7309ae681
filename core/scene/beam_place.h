#pragma once
/* Ways of placing a beam: by angles, by its gap to the skin, through a point, on the shortest way to its target. They
 * move the entry and keep the target. The skin is where a line, from outside, enters the first region. Any thread. */
#include "core/scene/beam_shown.h"

/* A line's skin, seen from its entry. Without a region on the line gap_mm and depth_mm are NaN. */
struct beam_skin {
    double gap_mm;   /* from the entry to the skin; negative: the entry lies behind it */
    double depth_mm; /* from the skin to the target; negative: the target lies before it */
};
NODISCARD bool beam_skin_of(const struct region_set *regions, struct vec3 entry_lps_mm, struct vec3 target_lps_mm,
                            struct beam_skin *skin, struct error *err);

/* Where the entry comes to lie. Errors of all: ERROR_MEMORY; and ERROR_RANGE, with a sentence for people, when the beam
 * cannot be placed so.
 *
 *   beam         the beam that is moved; its target and, unless said otherwise, its gap to the skin stay
 *   gap_mm       from the entry to the skin, at least 0, so that the entry lies outside; NaN: that of the beam, 0 if it
 *                begins behind the skin; where the beam meets no region its length stays instead */

/* SERA's angles (core/beam/sera_angles.h); the length stays. */
NODISCARD bool beam_place_angles(const struct beam_shown *beam, double phi_deg, double theta_deg,
                                 struct vec3 *entry_lps_mm, struct error *err);
/* Keeps the direction. gap_mm is a number. */
NODISCARD bool beam_place_gap(const struct region_set *regions, const struct beam_shown *beam, double gap_mm,
                              struct vec3 *entry_lps_mm, struct error *err);
/* Places the beam on the point's side, through the point to the target. */
NODISCARD bool beam_place_through(const struct region_set *regions, const struct beam_shown *beam,
                                  struct vec3 point_lps_mm, double gap_mm, struct vec3 *entry_lps_mm,
                                  struct error *err);
/* Places the beam in the direction of the least depth (core/region/shortest.h). Takes up to a second. */
NODISCARD bool beam_place_shortest(const struct region_set *regions, const struct beam_shown *beam, double gap_mm,
                                   struct vec3 *entry_lps_mm, struct error *err);
