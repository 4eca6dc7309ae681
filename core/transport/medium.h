#pragma once
/* A material as particles see it: macroscopic cross-sections by energy, which nucleus is met, what a capture emits; and
 * how a neutron's energy and direction change. Built once a run, then constant: any thread. */
#include <stdint.h>
#include <string.h>

#include "core/transport/material.h"
#include "core/transport/nuclides.h"

enum { NEUTRON_N_BINS = 544, PHOTON_N_BINS = 352, MEDIUM_N_LINES = 64, WATER_N_OUTCOMES = 512 };

/* 16 bins an octave from 2^-10 eV; 32 an octave from 2^-6 MeV. Energies beyond count in the outermost bin. */
static inline int neutron_bin(float energy_ev)
{
    int32_t bits;
    memcpy(&bits, &energy_ev, sizeof bits);
    int bin = (bits >> 19) - (117 << 4);
    return bin < 0 ? 0 : bin >= NEUTRON_N_BINS ? NEUTRON_N_BINS - 1 : bin;
}
static inline int photon_bin(float energy_mev)
{
    int32_t bits;
    memcpy(&bits, &energy_mev, sizeof bits);
    int bin = (bits >> 18) - (121 << 5);
    return bin < 0 ? 0 : bin >= PHOTON_N_BINS ? PHOTON_N_BINS - 1 : bin;
}
double neutron_bin_ev(int bin); /* its middle */
double photon_bin_mev(int bin);

struct medium_bin {
    float total_cm;         /* scattering and absorption, 1/cm */
    float absorbed;         /* share of collisions that absorb */
    float h, hc, hcn, hcno; /* shares of scattering by hydrogen, by hydrogen or carbon, ...; the rest is heavier */
};
struct medium {
    struct medium_bin neutron[NEUTRON_N_BINS];
    float rest_mass, rest_cosine[NEUTRON_N_BINS]; /* mean of the heavier nuclei */
    double absorption_2200_cm;                    /* at 0.0253 eV, 1/cm; falls with the speed */
    double emitted_mev;                           /* photon energy, mean of all absorptions */
    float line_mev[MEDIUM_N_LINES];               /* photon energies that carry equal shares of it */
    float electrons;                              /* per cm3, in those of water of 1 g/cm3 */
};
void medium_init(struct medium *medium, const struct material *material);
double medium_atoms(const struct material *material, enum element element); /* per barn and cm */
enum nuclide_id medium_nuclide(enum element element);                       /* that stands for it in scattering */

/* Data shared by all media. */
struct particle_tables {
    uint8_t water_group_of_bin[NEUTRON_N_BINS];
    uint8_t water_outcome[WATER_N_GROUPS][WATER_N_OUTCOMES]; /* groups after a collision, equally probable */
    float water_low_ev[WATER_N_GROUPS], water_width_ev[WATER_N_GROUPS];
    float water_cosine[WATER_N_GROUPS][WATER_N_GROUPS];
    float cosine[3][NEUTRON_N_BINS];     /* of C, N, O */
    float inverse_speed[NEUTRON_N_BINS]; /* sqrt(0.0253 eV / E) */
    float recoil_gy_cm2[NEUTRON_N_BINS]; /* fast neutron's kerma per fluence in ICRU 46 brain */
    float photon_cm2_g[PHOTON_N_BINS], photon_compton[PHOTON_N_BINS];
    float photon_gy_cm2[PHOTON_N_BINS]; /* kerma per fluence in ICRU 46 brain */
    float azimuth[1024][2];             /* cosine, sine */
};
void particle_tables_init(struct particle_tables *tables);

#define NEUTRON_THERMAL_EV 0.414F /* upper edge of the thermal fluence; SERA's edit groups */
#define NEUTRON_FAST_EV 9120.F    /* lower edge of the fast fluence and dose */
#define NEUTRON_LOWEST_EV 1e-3F   /* of a neutron after a collision */
#define NEUTRON_BOUND_EV 2.38F    /* hydrogen is bound below */
/* Kerma per fluence at 0.0253 eV: boron-10 per ppm, and nitrogen of 2.2 % by weight (ICRU 46 brain).
 * Source: J. T. Goorley, W. S. Kiger, R. G. Zamenhof, Med. Phys. 29, 145 (2002). */
#define KERMA_BORON_GY_CM2 8.66e-14
#define KERMA_NITROGEN_GY_CM2 1.74e-13
