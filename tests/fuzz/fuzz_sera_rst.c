/* SERA's dose files (.rst), as uncompressed text. */
#include <math.h>

#include "core/formats/sera/sera_rst.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    struct bytes text = { (uint8_t *)(uintptr_t)data, n };
    struct report report = { 0 };
    struct error err = { 0 };
    struct rst_header header;
    struct sera_doses doses;
    bool has_header = rst_parse_header(text.data, text.size, "fuzz.rst", &header, &err);
    REQUIRE(has_header || (err.code != ERROR_NONE && err.text[0] != '\0'));
    if (has_header)
        REQUIRE(header.n_cells >= 1 && header.n_cells <= RST_MAX_CELLS && header.n_sets >= 1 && header.data_at <= n);
    err = (struct error){ 0 };
    bool is_read = rst_read(&text, "fuzz.rst", &doses, &report, &err);
    REQUIRE(is_read ? has_header : err.code != ERROR_NONE && err.text[0] != '\0');
    REQUIRE(doses.n_components == (is_read ? RST_N_DOSES : 0));
    for (size_t i = 0; i < doses.n_components; i++) {
        const struct volume *values = doses.components[i].values;
        REQUIRE(values->grid.size[0] == header.n_cells && isfinite(values->low) && values->low <= values->high);
    }
    sera_doses_finish(&doses);
    report_finish(&report);
    return 0;
}
