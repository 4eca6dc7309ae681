/* SERA's beam sources. */
#include "core/formats/sera/sera_source.h"
#include "tests/fuzz/fuzz.h"

static void check_spectrum(const struct beam_spectrum *spectrum, size_t n_cuts)
{
    REQUIRE(spectrum->n_groups <= SOURCE_MAX_GROUPS);
    for (size_t i = 0; i < spectrum->n_groups; i++) {
        REQUIRE(spectrum->bounds_ev[i] > spectrum->bounds_ev[i + 1] && spectrum->share[i] >= 0);
        for (size_t j = 0; j < n_cuts; j++)
            REQUIRE(spectrum->cuts[i][j] >= 0 && spectrum->cuts[i][j] <= 1);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static struct beam_source source;
    struct error err = { 0 };
    if (!sera_source_parse(data, n, "fuzz.source", &source, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        return 0;
    }
    REQUIRE(source.neutrons.n_groups >= 1 && source.n_cuts >= 1 && source.n_cuts <= SOURCE_MAX_CUTS);
    REQUIRE(source.radius_cm > 0 && source.neutrons.per_cm2 > 0);
    check_spectrum(&source.neutrons, source.n_cuts);
    check_spectrum(&source.photons, source.n_cuts);
    return 0;
}
