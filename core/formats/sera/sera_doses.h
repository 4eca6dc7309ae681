#pragma once
/* The doses of one SERA dose file: several quantities on one grid, their reference for 100 %, and where they are valid.
 */
#include "core/dose/dose.h"

struct sera_doses {
    struct dose_component components[DOSE_N_QUANTITIES]; /* measured volumes, one reference each; no quantity twice */
    size_t n_components;
    struct volume *mask;                 /* may lie on another grid; NULL: valid everywhere */
    double reference[DOSE_N_QUANTITIES]; /* value of 100 %, by quantity; 0: the file gives none */
};
void sera_doses_finish(struct sera_doses *doses); /* also empties the struct */

/* Adds a component of zeros on the grid. Returns its voxels (F32); NULL with ERROR_MEMORY. */
NODISCARD float *sera_doses_add(struct sera_doses *doses, enum dose_quantity quantity, bool is_per_ppm,
                                const struct grid *grid, struct error *err);
