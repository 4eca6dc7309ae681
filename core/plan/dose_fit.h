#pragma once
/* Whether a dose belongs to the plan's image and regions, or may be another patient's, a phantom's, or shifted. A dose
 * that may not is not drawn over the image until a person accepts it. Any thread. */
#include "core/plan/plan.h"

enum dose_fit {
    DOSE_FIT_SAME,    /* the files say that dose and image share a frame of reference */
    DOSE_FIT_UNKNOWN, /* they do not say; the grids meet */
    DOSE_FIT_DIFFERS, /* they name different frames of reference */
    DOSE_FIT_APART,   /* a grid of the dose meets no region, or no image where there is no region */
    DOSE_N_FITS
};
const char *dose_fit_word(enum dose_fit fit); /* "same", "unknown", "differs", "apart" */

/* why, unless NULL: one sentence. */
enum { DOSE_FIT_WHY_SIZE = 200 };
enum dose_fit dose_fit_of(const struct plan *plan, size_t dose, char why[DOSE_FIT_WHY_SIZE]);
/* True if a person must accept the dose before it is drawn. */
static inline bool dose_fit_needs_acceptance(enum dose_fit fit)
{
    return fit == DOSE_FIT_DIFFERS || fit == DOSE_FIT_APART;
}
