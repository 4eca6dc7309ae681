/* NIfTI-1 and NIfTI-2, compressed or not. The first byte says what the file is read as; from 8 on, header and voxels
 * are two files. */
#include "core/formats/nifti.h"
#include "tests/fuzz/fuzz.h"

static void read_pair(const uint8_t *data, size_t n, enum raw_use use)
{
    size_t n_head = n < 348 ? n : 348;
    struct bytes head = { (uint8_t *)(uintptr_t)data, n_head },
                 voxels = { (uint8_t *)(uintptr_t)data + n_head, n - n_head };
    struct error err = { 0 };
    struct volume *volume =
        nifti_read_pair(&head, "fuzz.hdr", &voxels, n % 2 ? "fuzz.img" : "fuzz.img.gz", use, NULL, &err);
    REQUIRE(volume ? volume->low <= volume->high : err.code != ERROR_NONE && err.text[0] != '\0');
    volume_unref(volume);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    static const enum raw_use uses[] = { RAW_IMAGE, RAW_LABELS, RAW_MASK };
    enum raw_use use = uses[data[0] % 3];
    if (data[0] & 8) {
        read_pair(data + 1, n - 1, use);
        return 0;
    }
    struct bytes file = { (uint8_t *)(uintptr_t)data + 1, n - 1 };
    struct report report = { 0 };
    struct error err = { 0 };
    struct nifti_header header;
    bool has_header = nifti_peek(&file, "fuzz.nii", &header, NULL, &err);
    REQUIRE(has_header || (err.code != ERROR_NONE && err.text[0] != '\0'));

    err = (struct error){ 0 };
    struct volume *volume = nifti_read(&file, "fuzz.nii", use, &report, &err);
    if (volume) {
        REQUIRE(has_header);
        REQUIRE(memcmp(volume->grid.size, header.grid.size, sizeof header.grid.size) == 0);
        REQUIRE(volume->low <= volume->high);
        REQUIRE(use != RAW_MASK || (volume->low >= 0 && volume->high <= 1));
        REQUIRE(use != RAW_LABELS || (volume->low >= 0 && volume->high <= 65535));
        volume_unref(volume);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    report_finish(&report);
    return 0;
}
