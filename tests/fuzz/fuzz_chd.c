/* SERA's dose contours: header, table and pictures in one input, separated by form feeds. */
#include <math.h>

#include "core/formats/sera/sera_chd.h"
#include "tests/fuzz/fuzz.h"

static struct bytes cut(const uint8_t **at, const uint8_t *end)
{
    const uint8_t *stop = *at < end ? memchr(*at, '\f', (size_t)(end - *at)) : NULL;
    struct bytes part = { (uint8_t *)(uintptr_t)*at, (size_t)((stop ? stop : end) - *at) };
    *at = stop ? stop + 1 : end;
    return part;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    const uint8_t *at = data, *end = data + n;
    struct bytes header = cut(&at, end);
    struct chd_files files = {
        .table = cut(&at, end), .name = "fuzz.chd", .table_name = "fuzz.cdf", .mask_name = "fuzz.cmf"
    };
    if (at < end)
        files.mask = (struct bytes){ (uint8_t *)(uintptr_t)at, (size_t)(end - at) };
    struct chd chd;
    struct sera_doses doses;
    struct report report = { 0 };
    struct error err = { 0 };
    if (!chd_parse(header.data, header.size, "fuzz.chd", &chd, &report, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0' && !chd.planes);
        report_finish(&report);
        return 0;
    }
    REQUIRE((uint64_t)chd.n_columns * chd.n_rows * chd.n_planes <= CHD_MAX_POINTS);
    bool is_read = chd_read(&chd, &files, &doses, &report, &err);
    REQUIRE(is_read ? doses.n_components > 0 : err.code != ERROR_NONE && err.text[0] != '\0');
    REQUIRE(is_read || (doses.n_components == 0 && !doses.mask));
    for (size_t i = 0; i < doses.n_components; i++) {
        const struct volume *values = doses.components[i].values;
        REQUIRE(values->grid.size[0] == chd.n_columns && values->grid.size[2] >= chd.n_planes);
        REQUIRE(isfinite(values->low) && values->low <= values->high);
        REQUIRE(isfinite(doses.reference[doses.components[i].quantity]));
        for (size_t other = 0; other < i; other++)
            REQUIRE(doses.components[other].quantity != doses.components[i].quantity);
    }
    sera_doses_finish(&doses);
    chd_finish(&chd);
    report_finish(&report);
    return 0;
}
