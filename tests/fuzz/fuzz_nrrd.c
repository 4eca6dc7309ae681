/* NRRD. The first byte says what the file is read as; a header that names a data file gets the same bytes as that
 * file. */
#include "core/formats/nrrd.h"
#include "tests/fuzz/fuzz.h"

static void check_volume(const struct nrrd_header *header, struct volume *volume, enum raw_use use)
{
    REQUIRE(memcmp(volume->grid.size, header->grid.size, sizeof header->grid.size) == 0);
    REQUIRE(volume->low <= volume->high);
    REQUIRE(use != RAW_MASK || (volume->low >= 0 && volume->high <= 1));
    REQUIRE(use != RAW_LABELS || (volume->low >= 0 && volume->high <= 65535));
}

static void check_layers(const struct nrrd_header *header, const struct bytes *file)
{
    struct error err = { 0 };
    struct nrrd_layers *layers = calloc(1, sizeof *layers);
    REQUIRE(layers);
    bool is_read = nrrd_read_layers(header, file, "fuzz.nrrd", layers, NULL, &err);
    REQUIRE(is_read ? layers->n == header->n_layers : layers->n == 0 && err.code != ERROR_NONE && err.text[0] != '\0');
    for (size_t i = 0; i < layers->n; i++) {
        check_volume(header, layers->volumes[i], RAW_LABELS);
        for (size_t n = 0; n < layers->names[i].n; n++)
            REQUIRE(layers->names[i].labels[n].value != 0 && layers->names[i].labels[n].name[0] != '\0');
    }
    nrrd_layers_finish(layers);
    free(layers);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    static const enum raw_use uses[] = { RAW_IMAGE, RAW_LABELS, RAW_MASK };
    enum raw_use use = uses[data[0] % 3];
    struct bytes file = { (uint8_t *)(uintptr_t)data + 1, n - 1 };
    struct report report = { 0 };
    struct error err = { 0 };
    struct nrrd_header header;
    if (nrrd_parse_header(file.data, file.size, "a/fuzz.nrrd", &header, &report, &err)) {
        REQUIRE(header.data_bytes <= VOLUME_MAX_BYTES && header.n_layers >= 1 && header.head_bytes <= file.size);
        REQUIRE(!header.data_file[0] ||
                (folder_check_name(header.data_file, NULL) && strncmp(header.data_file, "a/", 2) == 0));
        struct volume *volume = nrrd_read(&header, &file, "fuzz.nrrd", use, &report, &err);
        REQUIRE(volume || (err.code != ERROR_NONE && err.text[0] != '\0'));
        if (volume)
            check_volume(&header, volume, use);
        volume_unref(volume);
        check_layers(&header, &file);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    nrrd_header_finish(&header);
    report_finish(&report);
    return 0;
}
