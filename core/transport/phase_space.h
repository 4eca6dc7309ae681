#pragma once
/* Particles at the aperture plane of a beam, as a list that histories take theirs from. Owned: create, destroy. */
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/beam/beam_source.h"

enum { PHASE_SPACE_MAX_PARTICLES = 4000000, PHASE_SPACE_LANES = 16 };
#define PHASE_SPACE_STREAM (UINT64_C(1) << 61) /* random numbers of lists, beyond those of histories */

/* In the beam's own axes: it goes to +z, z = 0 is the aperture plane, the axis goes through x = y = 0. */
struct particle {
    float x_cm, y_cm;
    float direction[3];
    float energy; /* neutrons: eV; photons: MeV */
    float weight;
};
struct particle_list {
    struct particle *particles;
    size_t n;        /* a multiple of PHASE_SPACE_LANES, or 0 */
    double per_unit; /* real particles for each unit of the source that one entry of weight 1 stands for, times n */
};
struct phase_space {
    struct particle_list neutrons, photons;
};

/* Draws particles from a source through its delimiter, collision by collision. Fast neutrons are drawn more often, with
 * less weight.
 *
 *   n_neutrons, n_photons  rounded up to a multiple of PHASE_SPACE_LANES; photons only if the source has any
 *   cancel                 NULL: not wanted
 *   errors                 ERROR_RANGE a source that lets nothing through, or less than one of 2000 particles,
 *                          a disk of more than 30 cm in radius or within the delimiter; ERROR_LIMIT;
 *                          ERROR_MEMORY; ERROR_CANCELLED within one particle of each thread
 *   thread                 any; equal for a seed and any number of threads */
NODISCARD bool phase_space_of_source(struct phase_space *space, const struct beam_source *source, size_t n_neutrons,
                                     size_t n_photons, uint64_t seed, int n_threads, const atomic_bool *cancel,
                                     struct error *err);
/* How much more often than its share a neutron of an energy is drawn. */
double phase_space_importance(double energy_ev);
void phase_space_finish(struct phase_space *space);
