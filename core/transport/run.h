#pragma once
/* A simulation's state, for the files that work on it: transport.c adds histories, result.c reads them. */
#include "core/transport/diffusion.h"
#include "core/transport/smooth.h"
#include "core/transport/transport.h"
#include "core/transport/walk.h"

/* The error is the spread of lanes; what a lane adds up does not depend on the thread that works on it. A lane takes
 * its own entries of the list, so that the spread includes what the list's length costs. */
enum { LANES = PHASE_SPACE_LANES };

/* Which entries of the list are fast, lane by lane; with each history goes one of them. */
struct fast_entries {
    uint32_t *entries;
    size_t first[LANES], n[LANES];
    float weight[LANES]; /* their share of a lane's entries */
    float usual_weight;  /* of an entry that is not fast */
};

struct transport_run {
    struct transport_input input;
    struct geometry geometry;
    struct medium *media;
    struct particle_tables *tables;
    struct world world;
    size_t n_cells;
    int n_threads;
    struct diffusion diffusion;   /* hybrid mode */
    uint64_t neutrons_per_photon; /* of the beam */
    double photon_weight;         /* of a photon of the beam, for neutrons of weight 1 */
    struct fast_entries fast;     /* hybrid mode */
    struct smooth_cells wider;
    struct smoothing smoothing[N_SMOOTH];

    double *sums[LANES];                    /* by cell world.n_tallies, cm: of whole batches */
    double (*smooth_sums[LANES])[N_SMOOTH]; /* by wider cell; NULL in full mode */
    struct balance balances[LANES];
    uint64_t n_histories;
    double seconds; /* of all steps */

    struct lane lanes[LANES]; /* of the batch at work */
    uint64_t n_batch, n_step;
    float *scratch[LANES][1 + DIFFUSION_N_SCRATCH]; /* by thread: a fluence, and its solution's */
    atomic_int next_lane;
    atomic_uint_fast64_t n_done; /* of the step */
    atomic_bool is_cancelled;
};

bool run_is_asked_to_stop(const struct transport_run *run);
/* Asked after each chunk of histories. True if the lane has to stop. */
bool run_pause(struct transport_run *run, bool is_caller, uint64_t n_done);

/* Hybrid mode. */
NODISCARD bool hybrid_init(struct transport_run *run, struct error *err);
void hybrid_finish(struct transport_run *run);
/* The weight that an entry is followed with as a slowing neutron: 0 for most that the list has more of than their
 * share, for the fast fluence. */
float hybrid_weight(const struct transport_run *run, const struct particle *particle, struct random *random);
/* With the i-th history of a lane: the first flight of a fast neutron, and at times its collisions. */
void hybrid_fast(struct transport_run *run, int lane, uint64_t i);
/* Where the neutrons of a lane that were handed over went: into its tallies, with their photons.
 *
 *   from, to  histories of the lane that handed them over */
void hybrid_spread(struct transport_run *run, int lane, int thread, uint64_t from, uint64_t to);
