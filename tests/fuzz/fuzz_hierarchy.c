/* SERA's hierarchy file: which body lies inside which. */
#include "core/formats/hierarchy.h"
#include "tests/fuzz/fuzz.h"

enum { MOST = 64 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct plan_file_pair pairs[MOST];
    struct report report = { 0 };
    size_t n_pairs = hierarchy_parse(data, n, "body_containment.info", pairs, MOST, &report);
    REQUIRE(n_pairs <= MOST);
    for (size_t i = 0; i < n_pairs; i++) {
        REQUIRE(pairs[i].outer[0] != '\0' && memchr(pairs[i].outer, '\0', sizeof pairs[i].outer));
        REQUIRE(pairs[i].inner[0] != '\0' && memchr(pairs[i].inner, '\0', sizeof pairs[i].inner));
    }
    report_finish(&report);
    return 0;
}
