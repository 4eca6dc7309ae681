#pragma once
/* Photon-isoeffective dose: the dose of photons, given in one session, with the same effect as the doses of all
 * components together. Knows numbers only, no plans. Functions without state: any thread.
 *
 *   a D + b Gr D^2 = sum_i a_i d_i + sum_ij G_ij sqrt(b_i b_j) d_i d_j
 *
 * over the components i, j, with a, b of photons and a_i, b_i of each component; photons of the beam have a, b. With
 * one repair time all G_ij are the Lea-Catcheside factor G of the irradiation, and the second sum is
 * G (sum_i sqrt(b_i) d_i)^2. With a fast and a slow repair time, G_ij = Gs - p_ij (Gs - Gf), where p_ij is the part of
 * damage that is repaired fast: of low or of high LET, or for a pair of the two, weighted by their doses.
 *
 *   source   S. J. Gonzalez and G. A. Santa Cruz, The photon-isoeffective dose in boron neutron capture therapy,
 *            Radiat. Res. 178 (2012) 609; with two repair times as in isodose.m of
 *            https://github.com/sebastiang2010/BNCTAr, by its authors' group. */
#include <stddef.h>

struct isoeffective_response {
    double alpha; /* 1/Gy */
    double beta;  /* 1/Gy2 */
};

/* Parameters of a tissue; sets in proto/dose_presets.json. */
struct isoeffective_set {
    const char *name, *tissue, *source, *repair_source;
    struct isoeffective_response photon, boron, nitrogen, fast;
    double repair_fast_min, repair_slow_min; /* mean repair times: half-time / ln 2 */
    double low_let_fast_part;                /* part of damage with the fast time: of photons */
    double high_let_fast_part;               /* of the other components */
    double photon_min;                       /* duration of the photon irradiation it is compared with */
};

/* A set, prepared for an irradiation of some duration. */
struct isoeffective {
    double alpha, beta_g; /* of photons; beta times Gr */
    double alpha_boron, alpha_nitrogen, alpha_fast;
    double root_boron, root_nitrogen, root_fast, root_photon; /* square roots of beta */
    double g_slow, g_step;                                    /* Gs, Gs - Gf of the irradiation */
    double low_let_fast_part, high_let_fast_part;
};
void isoeffective_init(struct isoeffective *prepared, const struct isoeffective_set *set, double irradiation_min);

/* Doses in Gy of the whole irradiation: the result is not proportional to them. boron_gy is that of the tissue's own
 * boron concentration. Returns Gy(IsoE); NaN if a dose is NaN. */
double isoeffective_dose(const struct isoeffective *prepared, double boron_gy, double nitrogen_gy, double fast_gy,
                         double gamma_gy);

/* Like isoeffective_dose, for n points. Component i of a point is components[i][point] * factors[i], in the order
 * boron, nitrogen, fast, gamma; NULL: no such component, 0 Gy. */
void isoeffective_doses(const struct isoeffective *prepared, const float *const components[4], const double factors[4],
                        size_t n, float *doses);

/* Lea-Catcheside factor of an irradiation at a constant dose rate, with damage that is repaired exponentially. 1 for a
 * duration of 0. */
double lea_catcheside(double mean_repair_min, double duration_min);
