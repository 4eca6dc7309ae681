#pragma once
/* Particle tracks as straight segments with a class. Knows no file. Any thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/math/vec.h"

/* Seven particle classes, and the line of the beam itself. */
enum track_class {
    TRACK_NEUTRON_HIGH,
    TRACK_NEUTRON_MEDIUM,
    TRACK_NEUTRON_LOW,
    TRACK_GAMMA_HIGH,
    TRACK_GAMMA_MEDIUM,
    TRACK_GAMMA_LOW,
    TRACK_LOST,
    TRACK_BEAM_LINE,
    TRACK_N_CLASSES
};
const char *track_class_word(enum track_class class); /* "neutron-high", ..., "lost", "beam-line" */

enum { TRACK_MAX_SEGMENTS = 2000000 };

struct track_segment {
    float from_lps_mm[3], to_lps_mm[3];
    uint8_t class; /* enum track_class; SERA's gammas have no energy code and are read as gamma-high, which the report
                      says */
};

struct track_set {
    struct track_segment *segments;
    size_t n_segments;
    size_t n_of_class[TRACK_N_CLASSES];
};
void track_set_finish(struct track_set *set);
