/* SERA's image header. The first two bytes (little-endian) give the number of pixel bytes that come with it. */
#include "core/formats/sera/sera_qhd.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 2)
        return 0;
    struct bytes pixels = { NULL, (size_t)data[0] | (size_t)data[1] << 8 };
    struct qhd qhd = { 0 };
    struct report report = { 0 };
    struct error err = { 0 };
    if (!qhd_parse(data + 2, n - 2, "fuzz.qhd", &qhd, &report, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        report_finish(&report);
        return 0;
    }
    REQUIRE(qhd.pixel_bytes == 1 || qhd.pixel_bytes == 2);
    REQUIRE(qhd.n_locations <= QHD_MAX_LOCATIONS);

    pixels.data = malloc(pixels.size + 1); /* malloc(0) may be NULL */
    REQUIRE(pixels.data);
    memset(pixels.data, 7, pixels.size);
    bool is_doubtful = false;
    struct volume *volume = qhd_read_pixels(&qhd, &pixels, "fuzz.qhd", "fuzz.qim", &is_doubtful, &report, &err);
    if (volume) {
        /* the number of bytes must match the header */
        REQUIRE(grid_n_voxels(&volume->grid) * qhd.pixel_bytes == pixels.size);
        volume_unref(volume);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    free(pixels.data);
    qhd_finish(&qhd);
    report_finish(&report);
    return 0;
}
