/* SERA's preference files; the first byte chooses the kind. */
#include <math.h>

#include "core/formats/sera/sera_rsc.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const char *const names[] = { "fuzz.rsc", "fuzz.cmap", "body_data.txt" };
    static struct rsc rsc;
    struct report report = { 0 };
    struct error err = { 0 };
    if (n < 1)
        return 0;
    bool is_read = rsc_parse(data + 1, n - 1, names[data[0] % 3], &rsc, &report, &err);
    REQUIRE(is_read || (err.code != ERROR_NONE && err.text[0] != '\0'));
    REQUIRE((rsc.n_bodies + rsc.n_levels + rsc.n_colors > 0) == is_read);
    for (size_t i = 0; i < rsc.n_bodies; i++) {
        REQUIRE(rsc.bodies[i].opacity >= 0 && rsc.bodies[i].opacity <= 1);
        REQUIRE(isnan(rsc.bodies[i].boron_ratio) || rsc.bodies[i].boron_ratio >= 0);
        REQUIRE(rsc_find(&rsc, rsc.bodies[i].name) != NULL);
    }
    for (size_t i = 0; i < rsc.n_levels; i++)
        REQUIRE(rsc.levels[i].percent > 0 && rsc.levels[i].percent <= 1000);
    report_finish(&report);
    return 0;
}
