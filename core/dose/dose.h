#pragma once
/* A dose as the plan gives it: components on their own grids, their unit and what they are per. No weights, no pictures. */
#include "core/volume/volume.h"

enum dose_quantity { DOSE_TOTAL, DOSE_BORON, DOSE_NITROGEN, DOSE_FAST, DOSE_GAMMA, DOSE_N_QUANTITIES };
const char *dose_quantity_word(enum dose_quantity quantity); /* "total", "boron", ... */
bool dose_quantity_from_word(const char *word, enum dose_quantity *quantity);

struct dose_component {
    enum dose_quantity quantity;
    bool is_per_ppm;       /* boron per 1 ppm of boron-10 */
    struct volume *values; /* physical dose in the dose's unit */
};

struct dose {
    char id[64];
    char unit[16]; /* "Gy", "cGy"; as the plan says it, never assumed */
    char per[64];  /* "fraction", "250 kW-min", "minute"; "" when the plan does not say, and the report then says so */
    struct dose_component components[DOSE_N_QUANTITIES];
    size_t n_components;
    struct volume *mask; /* where values are valid; NULL: everywhere on the grid */
};
void dose_finish(struct dose *dose);
