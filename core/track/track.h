#pragma once
/* Particle tracks as straight segments with a class. Knows no file. Any thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
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
/* The word's class; TRACK_N_CLASSES if it is none. */
enum track_class track_class_of_word(const char *word);

/* How the lines of a class are drawn, in pictures and in the page's lists. No two classes differ by colour alone where
 * red and green look alike: photons of medium and low energy are dashed, lost particles have a cross too. On the dark
 * background of a picture all colours have a contrast of at least 4.5; apart from lost and beam-line any two differ by
 * at least 15 (CIEDE2000), also with protanopia, deuteranopia or tritanopia (simulated after Machado et al. 2009). */
struct track_look {
    uint32_t color_rgb;
    double on_px, off_px; /* dashes along a segment from its first end, on the full picture; off_px 0: none */
    bool has_cross;       /* at the segment's second end */
};
struct track_look track_class_look(enum track_class class);

enum { TRACK_MAX_SEGMENTS = 2000000, TRACK_MAX_FILES = 16, TRACK_FILE_NAME_SIZE = 512 };

struct track_segment {
    float from_lps_mm[3], to_lps_mm[3];
    uint8_t class; /* enum track_class; SERA's gammas have no energy code and are read as gamma-high, which the report
                      says */
    float energy_mev; /* NaN: the file gives none */
};

/* One file of tracks; the segments stand in the order of the files, in each as in the file. */
struct track_file {
    char path[TRACK_FILE_NAME_SIZE]; /* inside the plan's folder */
    size_t n_segments;
    double unit_mm; /* length of the file's unit, given or judged: 1 or 10 */
};

struct track_set {
    struct track_segment *segments;
    size_t n_segments;
    size_t n_of_class[TRACK_N_CLASSES];
    struct track_file files[TRACK_MAX_FILES];
    size_t n_files;
};
void track_set_finish(struct track_set *set);
/* Room for one more segment behind the last one. *capacity is the number that segments has room for.
 *   name    of the file that is read, for the sentence
 *   errors  ERROR_LIMIT there are TRACK_MAX_SEGMENTS; ERROR_MEMORY */
NODISCARD bool track_set_make_room(struct track_set *set, size_t *capacity, const char *name, struct error *err);
/* True if the end points are equal. */
bool track_segment_is_point(const struct track_segment *segment);
