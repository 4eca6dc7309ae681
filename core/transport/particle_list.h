#pragma once
/* A phase space of particles that another program wrote down: to the aperture plane, and as many as a list takes. */
#include "core/beam/beam_particles.h"
#include "core/transport/phase_space.h"

/* Where the beam's own axes lie in those of the file. */
struct particle_frame {
    double origin_cm[3]; /* centre of the aperture plane */
    double axes[3][3];   /* rows x, y, z of the beam, of length 1 and right-handed; it goes to +z */
    double turn_rad;     /* the beam's x and y are turned by it about z, from x to y */
};
/* Sums of the file's weights, by kind of particles. */
struct particle_weights {
    double all;
    /* Left out: against the beam or along its plane; beyond PARTICLE_FARTHEST_CM; photons that simulations do not
     * follow, below PHOTON_LOWEST_MEV. */
    double backward, beside, soft;
    size_t n_used;
};
#define PARTICLE_FARTHEST_CM 30.

/* An axis along the beam, and one across it whose part along the beam is taken away. ERROR_RANGE: one has no length, or
 * they are parallel. */
NODISCARD bool particle_frame_init(struct particle_frame *frame, const double origin_cm[3], const double along[3],
                                   const double across[3], struct error *err);

/* Particles fly straight to the aperture plane, those beyond it straight back. Entries of the list are drawn in
 * proportion to weight, fast neutrons more often; each lane from its own sixteenth of the file, so that the spread of
 * lanes tells how few particles the file has, and particles of one history mostly stay together.
 *
 *   per_weight             real particles for each unit of the source that a weight of 1 in the file stands for
 *   n_neutrons, n_photons  rounded up to a multiple of PHASE_SPACE_LANES
 *   neutrons, photons      receive what was used and left out
 *   errors                 ERROR_RANGE too few neutrons; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD bool phase_space_of_particles(struct phase_space *space, const struct beam_particles *particles,
                                        const struct particle_frame *frame, double per_weight, size_t n_neutrons,
                                        size_t n_photons, uint64_t seed, struct particle_weights *neutrons,
                                        struct particle_weights *photons, struct error *err);
