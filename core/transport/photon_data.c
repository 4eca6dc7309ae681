/* Coefficients of photons in water. */
#include "core/transport/photon_data.h"

#include <math.h>

/* Source: J. H. Hubbell and S. M. Seltzer, Tables of X-Ray Mass Attenuation Coefficients (NISTIR 5632), liquid water.
 */
static const struct {
    double energy_mev, attenuation_cm2_g, absorption_cm2_g;
} water[] = {
    { .03, .3756, .1557 },  { .04, .2683, .06947 }, { .05, .2269, .04223 },   { .06, .2059, .03190 },
    { .08, .1837, .02597 }, { .1, .1707, .02546 },  { .15, .1505, .02764 },   { .2, .1370, .02967 },
    { .3, .1186, .03192 },  { .4, .1061, .03279 },  { .5, .09687, .03299 },   { .6, .08956, .03284 },
    { .8, .07865, .03206 }, { 1, .07072, .03103 },  { 1.25, .06323, .02965 }, { 1.5, .05754, .02833 },
    { 2, .04942, .02608 },  { 3, .03969, .02281 },  { 4, .03403, .02066 },    { 5, .03031, .01915 },
    { 6, .02770, .01806 },  { 8, .02429, .01658 },  { 10, .02219, .01566 },   { 15, .01941, .01441 },
    { 20, .01813, .01382 },
};
enum { N_WATER = sizeof water / sizeof *water };

static double between(double energy_mev, double low_mev, double low, double high_mev, double high)
{
    return exp(log(low) + log(high / low) * log(energy_mev / low_mev) / log(high_mev / low_mev));
}

static int interval(double energy_mev)
{
    int i = 0;
    while (i < N_WATER - 2 && energy_mev > water[i + 1].energy_mev)
        i++;
    return i;
}

double photon_attenuation_cm2_g(double energy_mev)
{
    double energy = fmin(fmax(energy_mev, PHOTON_LOWEST_MEV), PHOTON_HIGHEST_MEV);
    int i = interval(energy);
    return between(energy, water[i].energy_mev, water[i].attenuation_cm2_g, water[i + 1].energy_mev,
                   water[i + 1].attenuation_cm2_g);
}

double photon_absorption_cm2_g(double energy_mev)
{
    double energy = fmin(fmax(energy_mev, PHOTON_LOWEST_MEV), PHOTON_HIGHEST_MEV);
    int i = interval(energy);
    return between(energy, water[i].energy_mev, water[i].absorption_cm2_g, water[i + 1].energy_mev,
                   water[i + 1].absorption_cm2_g);
}

/* Source: O. Klein and Y. Nishina, Z. Phys. 52, 853 (1929), total cross-section; 2 pi r_e^2 = 0.49893 b. */
double photon_compton_share(double energy_mev)
{
    double a = fmax(energy_mev, PHOTON_LOWEST_MEV) / .510999, b = 1 + 2 * a, l = log(b);
    double electron_b = .49893 * ((1 + a) / (a * a) * (2 * (1 + a) / b - l / a) + l / (2 * a) - (1 + 3 * a) / (b * b));
    double electrons_per_g = 10 / 18.0153 * .602214; /* 1e24 */
    return fmin(1, electron_b * electrons_per_g / photon_attenuation_cm2_g(energy_mev));
}
