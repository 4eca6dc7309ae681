#pragma once
/* Doses of a beam of neutrons in a patient, by Monte Carlo: materials in voxels, a list of particles and a pose to
 * components on cells, with their statistical errors. Approximate, not for treatment. Knows no plan, files or scene. */
#include <stdatomic.h>

#include "core/transport/material.h"
#include "core/transport/phase_space.h"
#include "core/volume/volume.h"

#define TRANSPORT_MODEL "4" /* changes with whatever changes a number */
#define TRANSPORT_MAX_HISTORIES UINT64_C(100000000000)
#define TRANSPORT_BATCH UINT64_C(1048576) /* histories of a step that a cancelled one loses at most */

enum transport_quantity {
    TRANSPORT_BORON,        /* Gy per ppm of boron-10 */
    TRANSPORT_NITROGEN,     /* Gy, of 2.2 % by weight */
    TRANSPORT_FAST,         /* Gy, recoiling hydrogen of 10.7 % by weight, neutrons above 9.12 keV */
    TRANSPORT_GAMMA,        /* Gy, of the beam's photons and of those of captures */
    TRANSPORT_FAST_FLUENCE, /* 1/cm2 */
    TRANSPORT_EPITHERMAL_FLUENCE,
    TRANSPORT_THERMAL_FLUENCE, /* below 0.414 eV */
    TRANSPORT_N_QUANTITIES
};

enum transport_mode {
    TRANSPORT_FULL,  /* each neutron is followed to its end */
    TRANSPORT_HYBRID /* farther than 1 cm from air slow neutrons diffuse: faster, for previews */
};

struct transport_input {
    enum transport_mode mode; /* hybrid: cells of 5 mm of its own, not whole ones */
    const struct grid *grid;  /* of the voxels */
    const uint8_t *voxels;    /* [k][j][i]: 0 air, else 1 + index in materials */
    const struct material *materials;
    size_t n_materials; /* 1 to MATERIAL_MAX */
    const struct phase_space *beam;
    struct vec3 aperture_lps_mm, direction_lps; /* centre of the aperture plane; where the beam goes */
    uint64_t n_histories;                       /* of transport_run */
    uint64_t seed;
    const struct grid *cells; /* NULL: cells of cell_mm over the matter */
    double cell_mm;
    bool is_whole_cells; /* fluences over whole cells, air included, as seraMC does; else in what is not air */
    int n_threads;
    const atomic_bool *cancel;                     /* NULL: not wanted */
    void (*progress)(void *context, double share); /* of a step; NULL: not wanted; on the caller's thread */
    void *context;
};

/* Particles for each that entered, and energy by photons for each MeV that was emitted or entered. The parts of each
 * group add up to 1, neutrons' within the noise of the game in which weak ones are dropped. */
struct transport_balance {
    double missed; /* of the list's neutrons: past the patient */
    double leaked, absorbed, dropped;
    double photon_leaked, photon_left;
};
struct transport_result {
    struct volume *values[TRANSPORT_N_QUANTITIES]; /* per unit of the source */
    struct volume *errors[TRANSPORT_N_QUANTITIES]; /* one standard deviation, in the unit of the values */
    /* U8: 1 where a cell holds enough that is not air (a twentieth). Cells that count whole: where one lies wholly
     * within GEOMETRY_PAD_CM of the matter's bounds, beyond which nothing is followed. */
    struct volume *mask;
    uint64_t n_histories;
    double seconds;
    struct transport_balance balance;
};

/* A simulation that goes on: histories are added step by step, looked at in between, and begun anew for another pose of
 * the beam without what does not depend on the pose. Owned: create, destroy. One thread at a time, which starts
 * n_threads and joins them before it returns. Equal steps give equal bytes, whatever n_threads is, and whatever poses
 * were before.
 *
 * A preview that follows a dragged beam keeps one for each plan: create prepares the scene once (geometry, media, the
 * operator of diffusion); for each pose aim, a step of 100,000 and read; at rest further steps, each as large as all
 * before it, and read. A newer pose sets cancel, clears it when the step has returned, and aims. */
struct transport_run;

/* The whole input is checked before memory is taken. What the input points to is the caller's, and lives and does not
 * change as long as the run does.
 *
 *   errors   ERROR_RANGE, ERROR_LIMIT: what, where, expected; ERROR_MEMORY; ERROR_CANCELLED */
NODISCARD struct transport_run *transport_run_create(const struct transport_input *input, struct error *err);
void transport_run_destroy(struct transport_run *run); /* NULL: nothing */

/* The beam's x and y in the patient, for a direction of length 1: any two across it. */
void transport_beam_axes(struct vec3 direction_lps, struct vec3 axes_lps[2]);
/* Another pose, without histories. ERROR_RANGE: as before. */
NODISCARD bool transport_run_aim(struct transport_run *run, struct vec3 aperture_lps_mm, struct vec3 direction_lps,
                                 struct error *err);
/* Adds histories. ERROR_CANCELLED, within 256 histories of each thread: what the run had before stays, and as many
 * whole batches of TRANSPORT_BATCH as were done. ERROR_RANGE: none, or beyond TRANSPORT_MAX_HISTORIES in all */
NODISCARD bool transport_run_step(struct transport_run *run, uint64_t n_histories, struct error *err);
uint64_t transport_run_histories(const struct transport_run *run);
/* Doses of the histories so far. ERROR_STATE: fewer than 16; ERROR_MEMORY */
NODISCARD bool transport_run_read(const struct transport_run *run, struct transport_result *result, struct error *err);

/* One step of n_histories, from its input to its doses. */
NODISCARD bool transport_run(const struct transport_input *input, struct transport_result *result, struct error *err);
void transport_result_finish(struct transport_result *result);
