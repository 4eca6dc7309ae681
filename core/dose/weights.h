#pragma once
/* How the components of a dose add up: biological weights of one tissue, as factors of what the files hold. Knows no
 * scene and no grid. Any thread. */
#include "core/dose/dose.h"

/* Weights in one tissue, as people state them. */
struct tissue_weights {
    double boron_ratio;                  /* boron-10 concentration, as a multiple of that in blood */
    double cbe;                          /* compound biological effectiveness: weight of the boron dose */
    double nitrogen, fast, gamma, other; /* weights (RBE) of these doses */
};

/* Origin of a shown value: a quantity of the files, or one that is computed from several. */
enum dose_shown {
    DOSE_SHOWN_QUANTITY, /* of dose_quantity; a total that the dose lacks is the sum of its components */
    DOSE_SHOWN_WEIGHTED,
    DOSE_SHOWN_ISOEFFECTIVE
};

/* Factors of a dose's quantities in a sum; 0: not in it. */
struct dose_factors {
    double of[DOSE_N_QUANTITIES];
};

/* The components that physical and weighted totals are summed from: boron, nitrogen, fast and gamma, which a complete
 * dose has, and other. */
bool dose_is_summand(enum dose_quantity quantity);
/* The component of a quantity; NULL: the dose has none. */
const struct dose_component *dose_component_of(const struct dose *dose, enum dose_quantity quantity);
/* True if a sum must be made for the shown quantity: of a weighted one, and of a total that the dose lacks. */
bool dose_is_summed(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity);
/* Bits 1 << quantity of boron, nitrogen, fast and gamma that the dose lacks: a sum is too low by them. */
uint32_t dose_missing_summands(const struct dose *dose);
/* True if the value depends on the tissue: sums, and boron that is per ppm. */
bool dose_depends_on_tissue(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity);

/* The biological weight of a summand; NAN: the quantity is none. */
double dose_weight_of(enum dose_quantity quantity, const struct tissue_weights *weights);
/* The factors of a shown quantity in a tissue. Weighted: D = cbe ppm D_boron + w_N D_nitrogen + w_f D_fast + w_g
 * D_gamma
 * + w_o D_other, with ppm = boron_ratio blood_ppm where boron is per 1 ppm, else 1 (J. Coderre, G. Morris, Radiat. Res.
 * 151, 1999). Physical: the same with all weights 1. A quantity that is not a sum has one factor: ppm of boron per ppm,
 * blood_ppm of blood boron per ppm, else 1. Isoeffective doses are not linear: the factors are those of the physical
 * doses. */
struct dose_factors dose_factors_of(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity,
                                    const struct tissue_weights *weights, double blood_ppm);

/* Unit of a shown quantity, as dose_unit_of; weighted ones get "(w)", isoeffective ones "(IsoE)". */
void dose_shown_unit(const struct dose *dose, enum dose_shown shown, enum dose_quantity quantity,
                     char unit[DOSE_UNIT_SIZE]);
