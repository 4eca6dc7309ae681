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
    TALLY_SLOW,       /* fluence times sqrt(0.0253 eV / E): what a cross-section that falls with the speed sees */
    N_SLOW_TALLIES,
    TALLY_FAST = N_SLOW_TALLIES, /* fluence above NEUTRON_FAST_EV */
    TALLY_RECOIL,                /* kerma of recoils of fast neutrons, Gy cm3 */
    TALLY_PHOTON,                /* kerma of photons, Gy cm3 */
    N_TALLIES
};

/* Tallies in the matter of the wider cells of core/transport/smooth.h. */
enum smooth_tally {
    SMOOTH_FAST,   /* fluence above NEUTRON_FAST_EV */
    SMOOTH_RECOIL, /* its kerma */
    SMOOTH_PHOTON,
    N_SMOOTH
};

/* Where particles and their energy went, in units of weight; photon energies in MeV. */
struct balance {
    /* Neutrons; entered = leaked + absorbed + roulette + handed over, and what was handed over is leaked or absorbed.
     */
    double begun, entered, leaked, absorbed, roulette;
    double handed;
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
    bool is_whole_cells;       /* tallies in air too */
    float photons_per_neutron; /* that are followed for each absorbed neutron of weight 1 */
    const uint8_t *is_deep;    /* by cell: slow neutrons are handed over to diffusion there; NULL: nowhere */
    float slow_below_ev;       /* those */
    /* Fast neutrons by walk_fast alone, and photons, on wider cells. Hybrid mode. */
    bool has_smooth;
    size_t n_tallies; /* of a cell: all, or the first N_SLOW_TALLIES of them where the rest is on wider cells */
    float fast_highest[NEUTRON_N_BINS]; /* as neutron_highest, for walk_fast */
    double aperture_cm[3], axis[3][3];  /* of the beam: x, y and its direction, in the box's frame */
};
struct lane {
    float *tally;              /* by cell world->n_tallies, cm */
    float *born;               /* by cell, neutrons that were handed over to diffusion; NULL without it */
    float (*smooth)[N_SMOOTH]; /* by wider cell; NULL without them */
    struct balance balance;
};
void world_init(struct world *world); /* fills what follows from the rest */

void walk_neutron(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
                  struct random *random);
/* The fluence above NEUTRON_FAST_EV that a neutron brings: its first flight, as long as something is left of it; then
 * what becomes of it from a collision on the way until it is slower. No balance. */
void walk_fast(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
               struct random *random);
/* Photons of absorptions in a cell, of an energy in all: one of the spectrum, from a point of its matter. */
void walk_capture(const struct world *world, struct lane *lane, size_t cell, double emitted_mev, struct random *random);
void walk_photon(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
                 struct random *random);
