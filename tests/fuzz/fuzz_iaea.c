/* Phase spaces of the IAEA: the header, a byte 0, the records. */
#include "core/formats/iaea_phase_space.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct beam_particles particles;
    struct iaea_header header;
    struct error err = { 0 };
    const uint8_t *end = n > 0 ? memchr(data, 0, n) : NULL;
    size_t n_header = end ? (size_t)(end - data) : n, at = end ? n_header + 1 : n;
    if (!iaea_header_parse(data, n_header, "fuzz", &header, &err) ||
        !iaea_phase_space_read(&header, data + at, n - at, "fuzz", &particles, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        return 0;
    }
    REQUIRE(header.record_bytes >= 5 &&
            particles.n_neutrons + particles.n_photons + particles.n_others == header.n_particles);
    for (size_t i = 0; i < particles.n_neutrons; i++)
        REQUIRE(!beam_particle_check(&particles.neutrons[i]));
    for (size_t i = 0; i < particles.n_photons; i++)
        REQUIRE(!beam_particle_check(&particles.photons[i]));
    beam_particles_finish(&particles);
    return 0;
}
