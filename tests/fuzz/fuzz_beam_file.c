/* Beam files. */
#include <math.h>

#include "core/formats/plan/beam_file.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static struct beam_file file;
    struct report report = { 0 };
    struct error err = { 0 };
    bool is_read = beam_file_parse(data, n, "fuzz.json", &file, &report, &err);
    report_finish(&report);
    if (!is_read) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        return 0;
    }
    const struct beam_source *source = &file.source;
    REQUIRE(file.n_materials <= BEAM_FILE_MAX_MATERIALS && source->n_cuts <= SOURCE_MAX_CUTS);
    REQUIRE(file.source_path[0] || file.particles.path[0] || (source->neutrons.n_groups >= 1 && source->radius_cm > 0));
    REQUIRE(!file.particles.path[0] ||
            (file.particles.neutrons_per_unit > 0) != (file.particles.histories_per_unit > 0));
    REQUIRE(source->neutrons.n_groups <= SOURCE_MAX_GROUPS && source->photons.n_groups <= SOURCE_MAX_GROUPS);
    for (size_t i = 0; i < file.n_materials; i++)
        REQUIRE(file.materials[i].n_elements <= BEAM_FILE_MAX_ELEMENTS && isfinite(file.materials[i].boron_ppm));
    return 0;
}
