/* One DICOM file: parsed to each extent and asked for everything; and as the only file of a folder, scanned and read as
 * a series. */
#include <stdio.h>
#include <unistd.h>

#include "core/formats/dicom/dicom_series.h"
#include "tests/fuzz/fuzz.h"

enum { MOST_PIXELS = 1 << 20 }; /* larger frames are not decoded: they only take longer */

static void ask(const struct dicom_item *item, int depth)
{
    static const uint32_t tags[] = {
        DICOM_TAG(0x0008, 0x0005), DICOM_TAG(0x0008, 0x0016), DICOM_TAG(0x0008, 0x103E), DICOM_TAG(0x0008, 0x1140),
        DICOM_TAG(0x0020, 0x0032), DICOM_TAG(0x0028, 0x0009), DICOM_TAG(0x0028, 0x0010), DICOM_TAG(0x0028, 0x1053),
        DICOM_TAG(0x3006, 0x0020), DICOM_TAG(0x3006, 0x0026), DICOM_TAG(0x3006, 0x0039), DICOM_TAG(0x3006, 0x0040),
        DICOM_TAG(0x3006, 0x0050), DICOM_TAG(0x5200, 0x9229), DICOM_TAG(0x5200, 0x9230),
    };
    for (size_t i = 0; i < sizeof tags / sizeof tags[0]; i++) {
        char whole[48], part[48];
        double numbers[6];
        bool has_text = dicom_text(item, tags[i], whole, sizeof whole);
        REQUIRE(has_text == (whole[0] != 0));
        REQUIRE(!has_text || dicom_has(item, tags[i]));
        REQUIRE(memchr(whole, '\n', strlen(whole)) == NULL);
        (void)dicom_text_at(item, tags[i], 2, part, sizeof part);
        size_t n = dicom_numbers(item, tags[i], numbers, 6);
        REQUIRE(n == dicom_numbers(item, tags[i], NULL, 0));
        size_t n_items = dicom_n_items(item, tags[i]);
        REQUIRE(dicom_item_at(item, tags[i], n_items) == NULL);
        for (size_t k = 0; depth < 4 && k < n_items && k < 8; k++) {
            const struct dicom_item *inner = dicom_item_at(item, tags[i], k);
            REQUIRE(inner != NULL);
            ask(inner, depth + 1);
        }
    }
}

static void look_at_pixels(const struct dicom_file *file)
{
    struct error err = { 0 };
    struct dicom_pixels pixels;
    if (!dicom_pixels_look(file, &pixels, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0]);
        return;
    }
    REQUIRE(pixels.rows >= 1 && pixels.columns >= 1 && pixels.n_frames >= 1 &&
            pixels.bits_stored <= pixels.bits_allocated);
    size_t n = (size_t)pixels.rows * pixels.columns * (pixels.bits_allocated / 8);
    if (n > MOST_PIXELS)
        return;
    void *out = malloc(n); /* allocated exactly, so that one byte more is detected */
    for (uint32_t f = 0; out && f < pixels.n_frames && f < 3; f++)
        REQUIRE(dicom_pixels_read(file, f, out, &err) || err.text[0]);
    free(out);
}

static char path[256], name[300];

static void remove_folder(void)
{
    (void)unlink(name);
    (void)rmdir(path);
}

static void read_as_folder(const uint8_t *data, size_t n)
{
    static struct folder folder;
    if (!path[0]) {
        snprintf(path, sizeof path, "%s/beamroom-fuzz-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
        REQUIRE(mkdtemp(path) != NULL);
        REQUIRE(folder_open(&folder, path, NULL));
        snprintf(name, sizeof name, "%s/file", path);
        (void)atexit(remove_folder);
    }
    FILE *file = fopen(name, "wb");
    REQUIRE(file && fwrite(data, 1, n, file) == n && fclose(file) == 0);
    struct error err = { 0 };
    struct report report = { 0 };
    struct dicom_progress progress = { .n_threads = 1 };
    struct dicom_index *index = dicom_index_scan(&folder, NULL, 0, &progress, &report, &err);
    REQUIRE(index != NULL);
    REQUIRE(index->n_objects + index->n_foreign <= 1);
    for (size_t i = 0; i < index->n_stacks; i++) {
        if (index->stacks[i].n_bytes > 4 * MOST_PIXELS)
            continue;
        struct volume *volume = dicom_series_read(&folder, index, i, &progress, NULL, &report, &err);
        REQUIRE(volume ? volume->low <= volume->high : err.text[0] != 0);
        volume_unref(volume);
    }
    dicom_index_destroy(index);
    report_finish(&report);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    for (int extent = DICOM_START; extent <= DICOM_WHOLE; extent++) {
        struct error err = { 0 };
        struct dicom_file *file = dicom_file_parse(data, n, "fuzz.dcm", (enum dicom_extent)extent, &err);
        REQUIRE(file || (err.code != ERROR_NONE && strstr(err.text, "fuzz.dcm")));
        if (!file)
            continue;
        ask(dicom_root(file), 0);
        if (extent == DICOM_WHOLE)
            look_at_pixels(file);
        dicom_file_destroy(file);
    }
    read_as_folder(data, n);
    return 0;
}
