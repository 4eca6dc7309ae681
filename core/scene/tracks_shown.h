#pragma once
/* Which segments of a plan's tracks a scene shows: its classes, its range and its limits of energy. Knows no clip
 * planes and no pixels. Any thread. */
#include "core/track/track.h"
#include "scene.h" /* generated from proto/scene.json */

struct tracks_shown {
    size_t first, end;                      /* of the segments in the order of the files those first <= i < end */
    uint32_t classes;                       /* bit by class; only classes that have segments */
    double energy_low_mev, energy_high_mev; /* of segments with an energy only these, both included; +-infinity: all */
};
struct tracks_shown tracks_shown_of(const struct track_set *set, const struct scene_track_style *style);
/* True if the scene shows this one of the segments first .. end - 1. */
static inline bool track_is_shown(const struct tracks_shown *shown, const struct track_segment *segment)
{
    double energy_mev = (double)segment->energy_mev;
    return (shown->classes >> segment->class & 1) && !(energy_mev < shown->energy_low_mev) &&
           !(energy_mev > shown->energy_high_mev);
}
