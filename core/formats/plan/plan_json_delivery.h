#pragma once
/* The keys of a beam's "delivery" in plan.json and the fields they stand for; the reader and the writer use it. */
#include "core/beam/beam.h"

struct delivery_number {
    const char *key;
    size_t at; /* offset of a double in struct beam_delivery */
};
static const struct delivery_number delivery_numbers[] = {
    { "gantry_deg", offsetof(struct beam_delivery, gantry_deg) },
    { "gantry_stop_deg", offsetof(struct beam_delivery, gantry_stop_deg) },
    { "gantry_travel_deg", offsetof(struct beam_delivery, gantry_travel_deg) },
    { "collimator_deg", offsetof(struct beam_delivery, collimator_deg) },
    { "couch_deg", offsetof(struct beam_delivery, couch_deg) },
    { "energy_mev", offsetof(struct beam_delivery, energy_mev) },
    { "sad_mm", offsetof(struct beam_delivery, sad_mm) },
    { "ssd_mm", offsetof(struct beam_delivery, ssd_mm) },
    { "opening_cm2", offsetof(struct beam_delivery, opening_cm2) },
    { "dose_gy", offsetof(struct beam_delivery, dose_gy) },
    { "meterset", offsetof(struct beam_delivery, meterset) },
};
enum { N_DELIVERY_NUMBERS = sizeof delivery_numbers / sizeof delivery_numbers[0] };

/* Lists of two edges or of the three components of a direction. */
static const struct delivery_list {
    const char *key;
    size_t at;
    int n;
} delivery_lists[] = {
    { "jaws_x_mm", offsetof(struct beam_delivery, jaws_x_mm), 2 },
    { "jaws_y_mm", offsetof(struct beam_delivery, jaws_y_mm), 2 },
    { "opening_x_mm", offsetof(struct beam_delivery, opening_x_mm), 2 },
    { "opening_y_mm", offsetof(struct beam_delivery, opening_y_mm), 2 },
    { "collimator_x_lps", offsetof(struct beam_delivery, collimator_x_lps), 3 },
    { "collimator_y_lps", offsetof(struct beam_delivery, collimator_y_lps), 3 },
};
enum { N_DELIVERY_LISTS = sizeof delivery_lists / sizeof delivery_lists[0] };
_Static_assert(sizeof(struct vec3) == 3 * sizeof(double), "a direction is read as three numbers");
