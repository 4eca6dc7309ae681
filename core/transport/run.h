#pragma once
/* A simulation's state, for the files that work on it: transport.c adds histories, result.c reads them. */
#include "core/transport/transport.h"
#include "core/transport/walk.h"

/* The error is the spread of lanes; what a lane adds up does not depend on the thread that works on it. A lane takes
 * its own entries of the list, so that the spread includes what the list's length costs. */
enum { LANES = PHASE_SPACE_LANES };

struct transport_run {
    struct transport_input input;
    struct geometry geometry;
    struct medium *media;
    struct particle_tables *tables;
    struct world world;
    size_t n_cells;
    double photon_weight; /* of a photon of the beam, for neutrons of weight 1 */

    double (*sums[LANES])[N_TALLIES]; /* by cell, cm: of whole batches */
    struct balance balances[LANES];
    uint64_t n_histories;
    double seconds; /* of all steps */

    struct lane lanes[LANES]; /* of the batch at work */
    uint64_t n_batch, n_step;
    atomic_int next_lane;
    atomic_uint_fast64_t n_done; /* of the step */
    atomic_bool is_cancelled;
};
