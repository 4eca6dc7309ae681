/* Tables of particle tracks. */
#include <math.h>

#include "core/formats/track_csv.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct track_set set = { 0 };
    struct report report = { 0 };
    struct error err = { 0 };
    bool looks = track_csv_looks_like(data, n);
    if (track_csv_parse(data, n, "fuzz.csv", &set, &report, &err)) {
        REQUIRE(looks);
        REQUIRE(set.n_segments <= TRACK_MAX_SEGMENTS);
        size_t n_of_class[TRACK_N_CLASSES] = { 0 };
        for (size_t i = 0; i < set.n_segments; i++) {
            const struct track_segment *segment = &set.segments[i];
            REQUIRE(segment->class < TRACK_N_CLASSES);
            n_of_class[segment->class]++;
            REQUIRE(isnan(segment->energy_mev) || (segment->energy_mev >= 0 && segment->energy_mev <= 1.1e9F));
            REQUIRE(!track_segment_is_point(segment));
            for (int axis = 0; axis < 3; axis++)
                REQUIRE(fabsf(segment->from_lps_mm[axis]) <= 1.1e6F && fabsf(segment->to_lps_mm[axis]) <= 1.1e6F);
        }
        for (int class = 0; class < TRACK_N_CLASSES; class ++)
            REQUIRE(n_of_class[class] == set.n_of_class[class]);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    track_set_finish(&set);
    report_finish(&report);
    return 0;
}
