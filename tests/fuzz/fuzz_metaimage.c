/* MetaImage. The first byte says what the file is read as; a header that names a data file gets the same bytes as that
 * file. */
#include "core/formats/metaimage.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    static const enum raw_use uses[] = { RAW_IMAGE, RAW_LABELS, RAW_MASK };
    struct bytes file = { (uint8_t *)(uintptr_t)data + 1, n - 1 };
    struct report report = { 0 };
    struct error err = { 0 };
    struct metaimage_header header;
    struct volume *volume = NULL;
    if (metaimage_parse_header(file.data, file.size, "a/fuzz.mha", &header, &report, &err)) {
        REQUIRE(header.data_bytes <= VOLUME_MAX_BYTES && header.head_bytes <= file.size);
        REQUIRE(!header.data_file[0] ||
                (folder_check_name(header.data_file, NULL) && strncmp(header.data_file, "a/", 2) == 0));
        volume = metaimage_read(&header, &file, "fuzz.mha", uses[data[0] % 3], &report, &err);
    }
    REQUIRE(volume || (err.code != ERROR_NONE && err.text[0] != '\0'));
    REQUIRE(!volume || volume->low <= volume->high);
    volume_unref(volume);
    report_finish(&report);
    return 0;
}
