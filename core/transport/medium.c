/* Macroscopic cross-sections of materials. */
#include "core/transport/medium.h"

#include <math.h>

#include "core/transport/photon_data.h"

#define AVOGADRO_B .602214 /* 1e24 per mol */
#define BORON_2200_B 3835. /* absorption of boron-10 at 2200 m/s: Sears, as below */
#define BORON_G_MOL 10.0129

/* Atomic mass, charge; absorption and radiative capture at 2200 m/s, barn; photon energy a capture emits, MeV; the
 * nuclide that stands for it in scattering. Source of cross-sections: V. F. Sears, Neutron News 3 (3), 26 (1992); of
 * energies: neutron separation energies, IAEA Database of Prompt Gamma Rays (2007). Magnesium, 0.2 % of bone, scatters
 * as sodium. */
static const struct {
    double g_mol, charge, absorption_b, capture_b, emitted_mev;
    enum nuclide_id nuclide;
} elements[N_ELEMENTS] = {
    { 1.008, 1, .3326, .3326, 2.2246, NUCLIDE_H },    { 12.011, 6, .0035, 0, 0, NUCLIDE_C },
    { 14.007, 7, 1.90, .0750, 10.833, NUCLIDE_N_14 }, { 15.999, 8, .00019, 0, 0, NUCLIDE_O },
    { 22.990, 11, .530, .530, 6.96, NUCLIDE_NA },     { 24.305, 12, .063, .063, 8.5, NUCLIDE_NA },
    { 30.974, 15, .172, .172, 7.94, NUCLIDE_P },      { 32.06, 16, .53, .53, 8.64, NUCLIDE_S },
    { 35.45, 17, 33.5, 33.1, 8.58, NUCLIDE_CL },      { 39.098, 19, 2.1, 2.1, 7.80, NUCLIDE_K },
    { 40.078, 20, .43, .43, 8.36, NUCLIDE_CA },
};

/* Photon lines of captures: MeV, and photons per 100 captures. Source: IAEA Database of Prompt Gamma Rays for Slow
 * Neutron Capture (2007), the strong lines; elements of less than 1 % of the energy emit one mean energy. Boron: 94 %
 * of captures leave lithium excited. */
enum { BORON = N_ELEMENTS };
static const struct {
    int element;
    double mev, per_100;
} lines[] = {
    { ELEMENT_H, 2.2233, 100 }, { ELEMENT_CL, .517, 24 },   { ELEMENT_CL, .788, 16 },  { ELEMENT_CL, 1.165, 27 },
    { ELEMENT_CL, 1.951, 19 },  { ELEMENT_CL, 1.959, 12 },  { ELEMENT_CL, 2.864, 6 },  { ELEMENT_CL, 3.062, 3.5 },
    { ELEMENT_CL, 4.980, 3.7 }, { ELEMENT_CL, 5.715, 5.5 }, { ELEMENT_CL, 6.111, 20 }, { ELEMENT_CL, 6.620, 8 },
    { ELEMENT_CL, 6.978, 2.3 }, { ELEMENT_CL, 7.414, 10 },  { ELEMENT_CL, 7.790, 8 },  { ELEMENT_N, 1.885, 19 },
    { ELEMENT_N, 3.678, 14.5 }, { ELEMENT_N, 4.509, 17 },   { ELEMENT_N, 5.269, 51 },  { ELEMENT_N, 5.533, 20 },
    { ELEMENT_N, 6.322, 18 },   { ELEMENT_N, 7.299, 9 },    { ELEMENT_N, 10.829, 14 }, { ELEMENT_NA, 3.5, 100 },
    { ELEMENT_MG, 3.5, 100 },   { ELEMENT_P, 3.5, 100 },    { ELEMENT_S, 3.5, 100 },   { ELEMENT_K, 3.5, 100 },
    { ELEMENT_CA, 3.5, 100 },   { BORON, .4776, 94 },
};
enum { N_LINES = sizeof lines / sizeof *lines };

double neutron_bin_ev(int bin)
{
    return ldexp(1 + (bin % 16 + .5) / 16, bin / 16 - 10);
}

double photon_bin_mev(int bin)
{
    return ldexp(1 + (bin % 32 + .5) / 32, bin / 32 - 6);
}

double medium_atoms(const struct material *material, enum element element)
{
    return AVOGADRO_B * material->g_cm3 * material->weight[element] / elements[element].g_mol;
}

enum nuclide_id medium_nuclide(enum element element)
{
    return elements[element].nuclide;
}

static void densities(const struct material *material, double atoms[N_ELEMENTS + 1])
{
    for (int i = 0; i < N_ELEMENTS; i++)
        atoms[i] = medium_atoms(material, (enum element)i);
    atoms[BORON] = AVOGADRO_B * material->g_cm3 * material->boron_ppm * 1e-6 / BORON_G_MOL;
}

static void scattering(struct medium *medium, const double atoms[N_ELEMENTS + 1])
{
    double mass_sum = 0, mass_weight = 0;
    for (int bin = 0; bin < NEUTRON_N_BINS; bin++) {
        double energy_ev = neutron_bin_ev(bin), of[N_ELEMENTS], rest = 0, cosine = 0;
        for (int i = 0; i < N_ELEMENTS; i++) {
            of[i] = atoms[i] * nuclide_scatter_b(elements[i].nuclide, energy_ev);
            if (i <= ELEMENT_O)
                continue;
            const struct nuclide *nuclide = &nuclide_table[elements[i].nuclide];
            rest += of[i];
            cosine += of[i] * (double)nuclide->cosine[nuclide_group(energy_ev)];
            mass_sum += of[i] * (double)nuclide->mass;
            mass_weight += of[i];
        }
        double h = of[ELEMENT_H], hc = h + of[ELEMENT_C], hcn = hc + of[ELEMENT_N], hcno = hcn + of[ELEMENT_O];
        double scatter = hcno + rest, absorption = medium->absorption_2200_cm * sqrt(.0253 / energy_ev);
        double part = scatter > 0 ? 1 / scatter : 0, total = scatter + absorption;
        medium->neutron[bin] = (struct medium_bin){ (float)total,        (float)(total > 0 ? absorption / total : 0),
                                                    (float)(h * part),   (float)(hc * part),
                                                    (float)(hcn * part), (float)(hcno * part) };
        medium->rest_cosine[bin] = (float)(rest > 0 ? cosine / rest : 0);
    }
    medium->rest_mass = (float)(mass_weight > 0 ? mass_sum / mass_weight : 30);
}

static void emission(struct medium *medium, const double atoms[N_ELEMENTS + 1])
{
    double energy[N_ELEMENTS + 1], emitted = 0, sum_of[N_ELEMENTS + 1] = { 0 }, cumulative[N_LINES], sum = 0;
    for (int i = 0; i < N_ELEMENTS; i++)
        emitted += energy[i] = atoms[i] * elements[i].capture_b * elements[i].emitted_mev;
    emitted += energy[BORON] = atoms[BORON] * BORON_2200_B * .94 * .4776;
    medium->emitted_mev = medium->absorption_2200_cm > 0 ? emitted / medium->absorption_2200_cm : 0;
    for (int i = 0; i < N_LINES; i++)
        sum_of[lines[i].element] += lines[i].mev * lines[i].per_100;
    for (int i = 0; i < N_LINES; i++)
        cumulative[i] = sum += energy[lines[i].element] * lines[i].mev * lines[i].per_100 / sum_of[lines[i].element];
    for (int quantile = 0, i = 0; quantile < MEDIUM_N_LINES; quantile++) {
        while (i < N_LINES - 1 && cumulative[i] < (quantile + .5) / MEDIUM_N_LINES * sum)
            i++;
        medium->line_mev[quantile] = (float)lines[i].mev;
    }
}

/* In a gram, in those of a gram of water. */
static double electrons_of(const struct material *material)
{
    double electrons = 0, weight = 0, water_per_g = 10 / 18.0153;
    for (int i = 0; i < N_ELEMENTS; i++) {
        electrons += material->weight[i] * elements[i].charge / elements[i].g_mol;
        weight += material->weight[i];
    }
    return weight > 0 ? electrons / weight / water_per_g : .9;
}

void medium_init(struct medium *medium, const struct material *material)
{
    double atoms[N_ELEMENTS + 1];
    densities(material, atoms);
    medium->absorption_2200_cm = atoms[BORON] * BORON_2200_B;
    for (int i = 0; i < N_ELEMENTS; i++)
        medium->absorption_2200_cm += atoms[i] * elements[i].absorption_b;
    medium->electrons = (float)(material->g_cm3 * electrons_of(material));
    scattering(medium, atoms);
    emission(medium, atoms);
}

static void water_tables(struct particle_tables *tables)
{
    for (int group = 0; group < WATER_N_GROUPS; group++) {
        float low_ev = fmaxf(water_bounds_ev[group + 1], NEUTRON_LOWEST_EV);
        tables->water_low_ev[group] = low_ev;
        tables->water_width_ev[group] = water_bounds_ev[group] - low_ev;
        double sum = 0, running = (double)water_scatter_b[group][0];
        for (int to = 0; to < WATER_N_GROUPS; to++) {
            sum += (double)water_scatter_b[group][to];
            tables->water_cosine[group][to] =
                water_scatter_b[group][to] > 0 ? water_cosine_b[group][to] / water_scatter_b[group][to] : 0;
        }
        for (int outcome = 0, to = 0; outcome < WATER_N_OUTCOMES; outcome++) {
            while (to < WATER_N_GROUPS - 1 && running < (outcome + .5) / WATER_N_OUTCOMES * sum)
                running += (double)water_scatter_b[group][++to];
            tables->water_outcome[group][outcome] = (uint8_t)to;
        }
    }
}

/* A recoiling hydrogen nucleus carries half of the neutron's energy on average. Brain's 0.107 of hydrogen. */
static double recoil_gy_cm2(double energy_ev)
{
    double atoms_per_g = AVOGADRO_B * .107 / 1.008;
    return energy_ev >= (double)NEUTRON_FAST_EV
               ? atoms_per_g * nuclide_scatter_b(NUCLIDE_H, energy_ev) * .5 * energy_ev * 1.602177e-16
               : 0;
}

void particle_tables_init(struct particle_tables *tables)
{
    water_tables(tables);
    struct material brain = { 0 };
    double brain_electrons = material_of_word("brain", &brain, NULL) ? electrons_of(&brain) : 1;
    for (int bin = 0; bin < NEUTRON_N_BINS; bin++) {
        double energy_ev = neutron_bin_ev(bin);
        tables->water_group_of_bin[bin] = (uint8_t)water_group(energy_ev);
        for (int i = 0; i < 3; i++)
            tables->cosine[i][bin] = nuclide_table[NUCLIDE_C + i].cosine[nuclide_group(energy_ev)];
        tables->inverse_speed[bin] = (float)sqrt(.0253 / energy_ev);
        tables->recoil_gy_cm2[bin] = (float)recoil_gy_cm2(energy_ev);
    }
    for (int bin = 0; bin < PHOTON_N_BINS; bin++) {
        double energy_mev = photon_bin_mev(bin);
        tables->photon_cm2_g[bin] = (float)photon_attenuation_cm2_g(energy_mev);
        tables->photon_gy_cm2[bin] =
            (float)(photon_absorption_cm2_g(energy_mev) * brain_electrons * energy_mev * 1.602177e-10);
        tables->photon_compton[bin] = (float)photon_compton_share(energy_mev);
    }
    for (int i = 0; i < 1024; i++) {
        tables->azimuth[i][0] = (float)cos(2 * M_PI * (i + .5) / 1024);
        tables->azimuth[i][1] = (float)sin(2 * M_PI * (i + .5) / 1024);
    }
}
