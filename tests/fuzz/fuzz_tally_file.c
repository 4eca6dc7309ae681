/* Tally files. */
#include <math.h>

#include "core/formats/plan/tally_file.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct tally_file file;
    struct report report = { 0 };
    struct error err = { 0 };
    bool is_read = tally_file_parse(data, n, "fuzz.tally.json", &file, &report, &err);
    report_finish(&report);
    if (!is_read) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        return 0;
    }
    REQUIRE(file.path[0] && file.placing.factor > 0 && isfinite(file.placing.factor) && strlen(file.placing.axes) == 3);
    REQUIRE(file.choice.energy >= TALLY_ENERGY_TOTAL && file.choice.energy <= TALLY_MAX_ENERGIES);
    return 0;
}
