#pragma once
/* Histories of neutrons and photons through a geometry, into the tallies of a lane. Knows no threads. A lane is one
 * thread's at a time. */
#include <stdbool.h>

#include "core/transport/geometry.h"
#include "core/transport/medium.h"
#include "core/transport/phase_space.h"
#include "core/transport/random.h"

enum transport_tally {
    TALLY_THERMAL,    /* fluence below NEUTRON_THERMAL_EV */
    TALLY_EPITHERMAL, /* between it and NEUTRON_FAST_EV */
    TALLY_FAST,       /* above */
    TALLY_SLOW,       /* fluence times sqrt(0.0253 eV / E): what a cross-section that falls with the speed sees */
    TALLY_RECOIL,     /* kerma of recoils of fast neutrons, Gy cm3 */
    TALLY_PHOTON,     /* kerma of photons, Gy cm3 */
    N_TALLIES
};

/* Where particles and their energy went, in units of weight; photon energies in MeV. */
struct balance {
    double begun, entered, leaked, absorbed, roulette; /* neutrons; entered = leaked + absorbed + roulette */
    double emitted_mev, photon_entered_mev, photon_leaked_mev, photon_left_mev; /* left: in matter */
};

void balance_add(struct balance *sum, const struct balance *more);

struct world {
    const struct geometry *geometry;
    const struct medium *media; /* [n_media], of materials from 1 */
    size_t n_media;
    const struct particle_tables *tables;
    float neutron_highest[NEUTRON_N_BINS]; /* no medium's total is above, 1/cm */
    float photon_highest[PHOTON_N_BINS];
    bool is_whole_cells;               /* tallies in air too */
    double aperture_cm[3], axis[3][3]; /* of the beam: x, y and its direction, in the box's frame */
};
struct lane {
    float (*tally)[N_TALLIES]; /* by cell, cm */
    struct balance balance;
};
void world_init(struct world *world); /* fills what follows from the rest */

void walk_neutron(const struct world *world, struct lane *lane, const struct particle *particle, struct random *random);
void walk_photon(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
                 struct random *random);
