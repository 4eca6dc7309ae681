/* Which segments of a plan's tracks a scene shows. */
#include "core/scene/tracks_shown.h"

#include <math.h>

static uint32_t shown_classes(const struct scene_track_classes *shown, const struct track_set *set)
{
    const bool is_shown[TRACK_N_CLASSES] = {
        [TRACK_NEUTRON_HIGH] = shown->neutron_high,
        [TRACK_NEUTRON_MEDIUM] = shown->neutron_medium,
        [TRACK_NEUTRON_LOW] = shown->neutron_low,
        [TRACK_GAMMA_HIGH] = shown->gamma_high,
        [TRACK_GAMMA_MEDIUM] = shown->gamma_medium,
        [TRACK_GAMMA_LOW] = shown->gamma_low,
        [TRACK_LOST] = shown->lost,
        [TRACK_BEAM_LINE] = shown->beam_line,
    };
    uint32_t classes = 0;
    for (int class = 0; class < TRACK_N_CLASSES; class ++)
        classes |= (uint32_t)(is_shown[class] && set->n_of_class[class] > 0) << class;
    return classes;
}

struct tracks_shown tracks_shown_of(const struct track_set *set, const struct scene_track_style *style)
{
    size_t first = (size_t)style->first < set->n_segments ? (size_t)style->first : set->n_segments;
    size_t n_left = set->n_segments - first;
    return (struct tracks_shown){
        .first = first,
        .end = first + (style->has_count && (size_t)style->count < n_left ? (size_t)style->count : n_left),
        .classes = shown_classes(&style->classes, set),
        .energy_low_mev = style->has_energy_low_mev ? style->energy_low_mev : -INFINITY,
        .energy_high_mev = style->has_energy_high_mev ? style->energy_high_mev : INFINITY,
    };
}
