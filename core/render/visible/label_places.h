#pragma once
/* Places for labels on lines of a picture, so that no label covers another. Plain geometry: knows no dose. Any thread.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

/* The group of what has no labels and may not lie under one: its points are pairs, the ends of segments. */
enum { LABEL_KEPT_FREE = -1 };

/* A line to be labelled. Lines before others get the better places. */
struct label_line {
    const double (*points_px)[2]; /* y down; a closed line ends with the point that it begins with */
    size_t n_points;
    int group;       /* 0..31: lines of other groups near a label make its place worse; LABEL_KEPT_FREE */
    double width_px; /* of its label */
};

/* A rectangle around a label, turned with the line. */
struct label_place {
    size_t line;       /* index in the lines */
    double x_px, y_px; /* its middle */
    double angle_deg;  /* -90..90, from the picture's right towards its bottom */
    double width_px, height_px;
};

/* True if two labels overlap. */
bool label_places_overlap(const struct label_place *a, const struct label_place *b);

/* Chooses places: whole labels within the picture, none over another, along the straightest stretches of their lines,
 * away from lines of other groups. A line shorter than LABEL_LENGTHS labels has none, a long one has several. Returns
 * how many, at most max; -1 on failure.
 *   style   of every label
 *   errors  ERROR_MEMORY */
#define LABEL_LENGTHS 2.5
struct label_style {
    double height_px;
    bool is_upright; /* labels are not turned with their lines */
    /* Many places of each line, the best one first, to choose one from: those of different groups may overlap. */
    bool is_choice;
};
int label_places_find(const struct label_line *lines, size_t n_lines, double width_px, double picture_height_px,
                      const struct label_style *style, struct label_place *places, int max, struct error *err);
