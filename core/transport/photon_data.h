#pragma once
/* How photons interact with tissue: water's coefficients by electron density, Compton scattering. Constants and pure
 * functions: any thread. */

#define PHOTON_LOWEST_MEV 0.03  /* a photon below this ends where it is */
#define PHOTON_HIGHEST_MEV 20.0 /* energies above count as this */

/* Mass attenuation and energy absorption of water, cm2/g, by logarithms between tabulated energies. */
double photon_attenuation_cm2_g(double energy_mev);
double photon_absorption_cm2_g(double energy_mev);
/* Share of interactions that are Compton scattering, by Klein and Nishina; at most 1. */
double photon_compton_share(double energy_mev);
