/* Words and colours of track classes. */
#include "core/track/track.h"

#include <stdlib.h>
#include <string.h>

static const char *const words[TRACK_N_CLASSES] = { "neutron-high", "neutron-medium", "neutron-low", "gamma-high",
                                                    "gamma-medium", "gamma-low",      "lost",        "beam-line" };

const char *track_class_word(enum track_class class)
{
    return words[class];
}

struct track_look track_class_look(enum track_class class)
{
    static const struct track_look looks[TRACK_N_CLASSES] = {
        [TRACK_NEUTRON_HIGH] = { .color_rgb = 0xa74eed },
        [TRACK_NEUTRON_MEDIUM] = { .color_rgb = 0x0bd4e6 },
        [TRACK_NEUTRON_LOW] = { .color_rgb = 0xedeb0c },
        [TRACK_GAMMA_HIGH] = { .color_rgb = 0xd34a57 },
        [TRACK_GAMMA_MEDIUM] = { .color_rgb = 0xf58e5e, .on_px = 8, .off_px = 3 },
        [TRACK_GAMMA_LOW] = { .color_rgb = 0xccaca5, .on_px = 2, .off_px = 3 },
        [TRACK_LOST] = { .color_rgb = 0xffffff, .on_px = 6, .off_px = 4, .has_cross = true },
        [TRACK_BEAM_LINE] = { .color_rgb = 0xf4f6f8 },
    };
    return looks[class];
}

enum track_class track_class_of_word(const char *word)
{
    int class = 0;
    while (class < TRACK_N_CLASSES && strcmp(words[class], word) != 0)
        class ++;
    return (enum track_class) class;
}

void track_set_finish(struct track_set *set)
{
    free(set->segments);
    *set = (struct track_set){ 0 };
}

bool track_set_make_room(struct track_set *set, size_t *capacity, const char *name, struct error *err)
{
    if (set->n_segments < *capacity)
        return true;
    if (set->n_segments >= TRACK_MAX_SEGMENTS)
        return error_set(err, ERROR_LIMIT, "%s: more than %d segments in the plan", name, TRACK_MAX_SEGMENTS);
    size_t wanted = *capacity < 1024 ? 1024 : *capacity * 2;
    wanted = wanted < TRACK_MAX_SEGMENTS ? wanted : TRACK_MAX_SEGMENTS;
    struct track_segment *segments = realloc(set->segments, wanted * sizeof *segments);
    if (!segments)
        return error_set(err, ERROR_MEMORY, "%s: no memory for %zu segments", name, wanted);
    set->segments = segments;
    *capacity = wanted;
    return true;
}

bool track_segment_is_point(const struct track_segment *segment)
{
    const float *a = segment->from_lps_mm, *b = segment->to_lps_mm;
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}
