/* SERA's tables of doses over depth and radius. */
#include <math.h>

#include "core/formats/sera/sera_table.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct dose_curve curve;
    struct report report = { 0 };
    struct error err = { 0 };
    if (!sera_table_parse(data, n, "fuzz.dose", &curve, &report, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0' && !curve.depths_mm && curve.n_columns == 0);
        report_finish(&report);
        return 0;
    }
    REQUIRE(curve.n_depths >= 2 && curve.n_depths <= CURVE_MAX_POINTS && curve.n_columns > 0);
    for (size_t i = 1; i < curve.n_depths; i++)
        REQUIRE(curve.depths_mm[i] > curve.depths_mm[i - 1] && curve.radii_mm[i] > curve.radii_mm[i - 1]);
    for (size_t c = 0; c < curve.n_columns; c++) {
        double depth, value, same;
        if (!dose_curve_peak(&curve, c, &depth, &value))
            continue;
        REQUIRE(isfinite(value) && dose_curve_value(&curve, c, depth, curve.radii_mm[0], &same) && same == value);
    }
    dose_curve_finish(&curve);
    report_finish(&report);
    return 0;
}
