/* Words of track classes. */
#include "core/track/track.h"

#include <stdlib.h>

const char *track_class_word(enum track_class class)
{
    static const char *const words[TRACK_N_CLASSES] = { "neutron-high", "neutron-medium", "neutron-low", "gamma-high",
                                                        "gamma-medium", "gamma-low",      "lost",        "beam-line" };
    return words[class];
}

void track_set_finish(struct track_set *set)
{
    free(set->segments);
    *set = (struct track_set){ 0 };
}
