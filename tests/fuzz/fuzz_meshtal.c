/* Fields of Monte Carlo codes: mesh tallies of MCNP. The first byte chooses the energy. */
#include <math.h>

#include "core/formats/tally/meshtal.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct tally tally;
    struct error err = { 0 };
    struct tally_choice choice = { 0, n > 0 ? data[0] % 5 - 1 : 0 };
    size_t skipped = n > 0;
    meshtal_is(data, n);
    if (!meshtal_read(data + skipped, n - skipped, "fuzz", &choice, &tally, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0' && !tally.values);
        return 0;
    }
    size_t n_boxes = (size_t)tally.size[0] * tally.size[1] * tally.size[2];
    REQUIRE(n_boxes > 0 && tally.words[0] != '\0');
    for (size_t i = 0; i < n_boxes; i++)
        REQUIRE(isfinite(tally.values[i]) && (!tally.errors || tally.errors[i] >= 0));
    tally_finish(&tally);
    return 0;
}
