/* Files of particles: MCPL. */
#include "core/formats/mcpl.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct beam_particles particles;
    struct error err = { 0 };
    mcpl_is(data, n);
    if (!mcpl_read(data, n, "fuzz", &particles, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0' && !particles.neutrons);
        return 0;
    }
    for (size_t i = 0; i < particles.n_neutrons; i++)
        REQUIRE(!beam_particle_check(&particles.neutrons[i]));
    for (size_t i = 0; i < particles.n_photons; i++)
        REQUIRE(!beam_particle_check(&particles.photons[i]));
    REQUIRE(particles.n_neutrons + particles.n_photons + particles.n_others > 0);
    beam_particles_finish(&particles);
    return 0;
}
