/* Particle tracks of seraMC. */
#include <math.h>

#include "core/formats/sera/sera_pp.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct track_set set = { 0 };
    struct report report = { 0 };
    struct error err = { 0 };
    if (pp_parse(data, n, "fuzz.pp", &set, &report, &err)) {
        REQUIRE(set.n_segments <= TRACK_MAX_SEGMENTS); /* 0 if all segments have zero length, which the report says */
        struct box3 patient = { { -80, -100, -60 }, { 80, 100, 120 } };
        double mm = pp_unit_mm(&set, 0, 0, &patient, "fuzz.pp", &report);
        REQUIRE(isfinite(mm) && mm > 0);
        pp_scale(&set, 0, mm, "t.pp", NULL);
        for (size_t i = 0; i < set.n_segments; i++) {
            REQUIRE(set.segments[i].class < TRACK_N_CLASSES);
            for (int axis = 0; axis < 3; axis++)
                REQUIRE(isfinite(set.segments[i].from_lps_mm[axis]) && isfinite(set.segments[i].to_lps_mm[axis]));
        }
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    track_set_finish(&set);
    report_finish(&report);
    return 0;
}
