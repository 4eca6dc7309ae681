/* SERA's univel header, both versions; the univels are as many bytes as the header requires. */
#include "core/formats/sera/sera_uvh.h"
#include "tests/fuzz/fuzz.h"

enum { MAX_UNIVELS = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct uvh uvh = { 0 };
    struct report report = { 0 };
    struct error err = { 0 };
    if (!uvh_parse(data, n, "fuzz.uvh", &uvh, &report, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        report_finish(&report);
        return 0;
    }
    REQUIRE(uvh.n_bodies <= UVH_MAX_BODIES);
    for (size_t i = 0; i < uvh.n_bodies; i++) {
        REQUIRE(uvh.bodies[i].uvval >= 0 && uvh.bodies[i].uvval <= 255);
        REQUIRE(memchr(uvh.bodies[i].name, '\0', sizeof uvh.bodies[i].name));
    }
    size_t n_univels = grid_n_voxels(&uvh.grid);
    if (n_univels <= MAX_UNIVELS) {
        struct bytes univels = { calloc(n_univels, 1), n_univels };
        struct volume *volume = uvh_read_univels(&uvh, &univels, "fuzz.uv", &err);
        REQUIRE(volume);
        volume_unref(volume);
        univels.size--;
        REQUIRE(!uvh_read_univels(&uvh, &univels, "fuzz.uv", &err) && err.text[0] != '\0');
        free(univels.data);
    }
    uvh_finish(&uvh);
    report_finish(&report);
    return 0;
}
