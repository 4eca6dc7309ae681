#pragma once
/* What one dose file of SERA's holds: several quantities on one grid, what it calls 100 %, and where it is valid. */
#include "core/dose/dose.h"

struct sera_doses {
    struct dose_component components[DOSE_N_QUANTITIES]; /* measured; one reference each; no quantity twice */
    size_t n_components;
    struct volume *mask;                 /* may lie on another grid; NULL: valid everywhere */
    double reference[DOSE_N_QUANTITIES]; /* by quantity; 0 where the file gives none */
};
void sera_doses_finish(struct sera_doses *doses); /* and empties it */

/* A component of zeros on the grid, added; its voxels (F32), or NULL: ERROR_MEMORY. */
NODISCARD float *sera_doses_add(struct sera_doses *doses, enum dose_quantity quantity, bool is_per_ppm,
                                const struct grid *grid, struct error *err);
