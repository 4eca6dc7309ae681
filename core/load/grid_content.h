#pragma once
/* Tells whether a grid holds labels of regions or the grey values of an image. */
#include "core/volume/volume.h"

struct grid_content {
    bool is_whole;   /* every value is a whole number from 0 to 65535 */
    size_t n_values; /* different values above 0; valid with is_whole */
    double alike;    /* share of neighbours along i, both above 0, that are equal; 1 when there are none */
};

/* is_named: as below; without it counting ends when there are too many values for labels. */
void grid_content_measure(const struct volume *volume, bool is_named, struct grid_content *content);
/* True if the values can be labels: whole numbers of which neighbours are mostly equal, as they are within a region and
 * not within a picture. is_named: the file's name says labels, so that a few scattered values are believed. All 0
 * counts as labels when named. */
bool grid_content_is_labels(const struct grid_content *content, bool is_named);
/* True if the values can be a dose: the smallest is not far below 0. */
bool grid_content_may_be_dose(const struct volume *volume);
