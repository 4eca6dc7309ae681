/* Room for particles of a beam, and what one of them may be. */
#include "core/beam/beam_particles.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"

bool beam_particles_init(struct beam_particles *particles, uint64_t n_neutrons, uint64_t n_photons, const char *name,
                         struct error *err)
{
    *particles = (struct beam_particles){ 0 };
    if (n_neutrons > BEAM_PARTICLES_MAX || n_photons > BEAM_PARTICLES_MAX - n_neutrons)
        return error_set(err, ERROR_LIMIT, "%s: more than %d neutrons and photons", name, BEAM_PARTICLES_MAX);
    particles->neutrons = mem_array((size_t)n_neutrons, sizeof *particles->neutrons, UINT64_MAX, err);
    particles->photons =
        particles->neutrons ? mem_array((size_t)n_photons, sizeof *particles->photons, UINT64_MAX, err) : NULL;
    if (!particles->photons)
        beam_particles_finish(particles);
    return particles->neutrons != NULL;
}

void beam_particles_finish(struct beam_particles *particles)
{
    free(particles->neutrons);
    free(particles->photons);
    *particles = (struct beam_particles){ 0 };
}

const char *beam_particle_check(struct beam_particle *particle)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        if (!(fabs((double)particle->position_cm[i]) <= BEAM_PARTICLE_MAX_CM))
            return "its place";
        square += (double)particle->direction[i] * (double)particle->direction[i];
    }
    if (!(fabs(square - 1) < 2e-3))
        return "its direction";
    for (int i = 0; i < 3; i++)
        particle->direction[i] = (float)((double)particle->direction[i] / sqrt(square));
    if (!((double)particle->energy_mev >= 0 && (double)particle->energy_mev <= BEAM_PARTICLE_MAX_MEV))
        return "its energy";
    return (double)particle->weight >= 0 && (double)particle->weight <= BEAM_PARTICLE_MAX_WEIGHT ? NULL : "its weight";
}
