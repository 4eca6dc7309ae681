/* Files made to break readers: each is read, or refused with a sentence, within the written limits of time and memory,
 * in a process of its own. */
#define _GNU_SOURCE
#include <ftw.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/formats/dicom/dicom_series.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifdef SANITIZED
enum { MOST_MS = 10000, MOST_MIB = 1024 }; /* the sanitizer's own memory and pace */
#else
enum { MOST_MS = 1000, MOST_MIB = 256 };
#endif

/* Reads every element that plan readers use, in every way. */
static void ask_everything(const struct dicom_item *item, int depth)
{
    static const uint32_t tags[] = {
        DICOM_TAG(0x0008, 0x0005), DICOM_TAG(0x0008, 0x0008), DICOM_TAG(0x0008, 0x0016), DICOM_TAG(0x0008, 0x0018),
        DICOM_TAG(0x0008, 0x103E), DICOM_TAG(0x0008, 0x1140), DICOM_TAG(0x0010, 0x0010), DICOM_TAG(0x0020, 0x0032),
        DICOM_TAG(0x0020, 0x0037), DICOM_TAG(0x0028, 0x0010), DICOM_TAG(0x0028, 0x0030), DICOM_TAG(0x0028, 0x1050),
        DICOM_TAG(0x0028, 0x1053), DICOM_TAG(0x3004, 0x000C), DICOM_TAG(0x3006, 0x0010), DICOM_TAG(0x3006, 0x0020),
        DICOM_TAG(0x3006, 0x0039), DICOM_TAG(0x3006, 0x0040), DICOM_TAG(0x3006, 0x0050), DICOM_TAG(0x300A, 0x00B0),
        DICOM_TAG(0x300A, 0x0111), DICOM_TAG(0x300C, 0x0002), DICOM_TAG(0x5200, 0x9229), DICOM_TAG(0x5200, 0x9230),
    };
    char text[64];
    double numbers[8];
    for (size_t i = 0; i < sizeof tags / sizeof tags[0]; i++) {
        (void)dicom_text(item, tags[i], text, sizeof text);
        (void)dicom_text_at(item, tags[i], 1, text, sizeof text);
        (void)dicom_numbers(item, tags[i], numbers, 8);
        size_t n = dicom_n_items(item, tags[i]);
        for (size_t k = 0; depth < 4 && k < n && k < 50; k++)
            ask_everything(dicom_item_at(item, tags[i], k), depth + 1);
    }
}

static int parse_one(const struct folder *folder, const char *name)
{
    struct bytes bytes;
    struct error err = { 0 };
    if (!folder_read(folder, name, UINT32_MAX, UINT64_MAX, &bytes, &err))
        return 1;
    for (int extent = DICOM_START; extent <= DICOM_WHOLE; extent++) {
        err = (struct error){ 0 };
        struct dicom_file *file = dicom_file_parse(bytes.data, bytes.size, name, (enum dicom_extent)extent, &err);
        if (!file && (err.code == ERROR_NONE || !strstr(err.text, name)))
            return 2; /* refused without a sentence that names the file */
        if (!file)
            continue;
        ask_everything(dicom_root(file), 0);
        struct dicom_pixels pixels;
        if (dicom_pixels_look(file, &pixels, &err)) {
            size_t n = (size_t)pixels.rows * pixels.columns * pixels.bits_allocated / 8;
            void *out = malloc(n); /* allocated exactly: a sanitizer detects one byte too many */
            for (uint32_t f = 0; out && f < pixels.n_frames && f < 4; f++)
                if (!dicom_pixels_read(file, f, out, &err) && !err.text[0])
                    return 2;
            free(out);
        } else if (err.text[0] == 0) {
            return 2;
        }
        dicom_file_destroy(file);
    }
    bytes_free(&bytes);
    return 0;
}

static int read_one(const char *path)
{
    char folder_path[1024];
    const char *slash = strrchr(path, '/');
    snprintf(folder_path, sizeof folder_path, "%.*s", (int)(slash - path), path);
    struct folder folder;
    struct report report = { 0 };
    struct error err = { 0 };
    if (!folder_open(&folder, folder_path, &err))
        return 1;
    int failed = parse_one(&folder, slash + 1);
    char name[512];
    snprintf(name, sizeof name, "%s", slash + 1);
    char *names[] = { name };
    struct dicom_index *index = dicom_index_scan(&folder, names, 1, NULL, &report, &err);
    if (!index)
        return 3;
    for (size_t i = 0; i < index->n_stacks; i++) {
        struct volume *volume = dicom_series_read(&folder, index, i, NULL, NULL, &report, &err);
        if (!volume && !err.text[0])
            return 2;
        volume_unref(volume);
    }
    dicom_index_destroy(index);
    report_finish(&report);
    folder_close(&folder);
    return failed;
}

static size_t n_read;

/* In a process of its own, so that a crash, time and memory belong to this file. */
static void measure_one(const char *path)
{
    int64_t began = clock_now_us();
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(read_one(path));
    int status = 0;
    struct rusage usage = { 0 };
    assert_int_equal(wait4(child, &status, 0, &usage), child);
    double ms = (double)(clock_now_us() - began) / 1e3;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        fail_msg("%s: %s %d", path, WIFEXITED(status) ? "exit" : "signal",
                 WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
    double cpu_ms = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1e3 +
                    (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) / 1e3;
    /* the CPU time must be too long as well: a busy machine is not the file's fault */
    if (ms > MOST_MS && cpu_ms > MOST_MS)
        fail_msg("%s: %.0f ms; at most %d", path, ms, MOST_MS);
    if (usage.ru_maxrss / 1024 > MOST_MIB)
        fail_msg("%s: %ld MiB; at most %d", path, usage.ru_maxrss / 1024, MOST_MIB);
    n_read++;
}

static int visit(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about;
    (void)where;
    if (kind == FTW_F)
        measure_one(path);
    return 0;
}

static void each_file_of_the_hostile_collections_is_read_or_refused_in_time(void **state)
{
    (void)state;
    char path[1024], made[256];
    if (!data_path("hostile-dicom/corpus.tar.xz", path, sizeof path))
        skip();
    dicom_prepare(); /* once, for all children */
    folder_make(made);
    if (!oracle_unpack(path, made)) {
        folder_remove(made);
        skip();
    }
    assert_int_equal(nftw(made, visit, 16, FTW_PHYS), 0);
    folder_remove(made);
    assert_true(n_read >= 595);
    assert_true(data_path("hostile", path, sizeof path));
    assert_int_equal(nftw(path, visit, 16, FTW_PHYS), 0);
}

static uint64_t random_state;
static uint32_t next_random(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(random_state >> 33);
}

/* Copies of a real file, truncated or with flipped bits. */
static void damage(const char *path, int n_copies)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    static uint8_t data[1 << 20], copy[1 << 20];
    size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    char made[256], name[300];
    folder_make(made);
    snprintf(name, sizeof name, "%s/damaged", made);
    for (int i = 0; i < n_copies; i++) {
        size_t n = i % 2 ? size : next_random() % (size + 1);
        memcpy(copy, data, n);
        /* lengths and kinds are in the head */
        for (int flip = 0; i % 2 && flip < 1 + i % 16; flip++)
            copy[next_random() % (flip % 4 ? (size < 4096 ? size : 4096) : size)] ^= (uint8_t)(1u << next_random() % 8);
        folder_put(made, "damaged", copy, n);
        measure_one(name);
    }
    folder_remove(made);
}

static void damaged_copies_of_real_files_are_read_or_refused_in_time(void **state)
{
    (void)state;
    static const char *const files[] = {
        "dicom-transfer-syntaxes/CTImage.dcm_BigEndianExplicitTransferSyntax_1.2.840.10008.1.2.2.dcm",
        "dicom-transfer-syntaxes/CTImage.dcm_DeflatedExplicitVRLittleEndianTransferSyntax_1.2.840.10008.1.2.1.99.dcm",
        "dicom-transfer-syntaxes/CTImage.dcm_JPEGLSLosslessTransferSyntax_1.2.840.10008.1.2.4.80.dcm",
        "dicom-transfer-syntaxes/CTImage.dcm_JPEGProcess14SV1TransferSyntax_1.2.840.10008.1.2.4.70.dcm",
        "dicom-transfer-syntaxes/CTImage.dcm_JPEGProcess2_4TransferSyntax_1.2.840.10008.1.2.4.51.dcm",
        "dicom-transfer-syntaxes/CTImage.dcm_LittleEndianImplicitTransferSyntax_1.2.840.10008.1.2.dcm",
        "dicom-transfer-syntaxes/CTImage.dcm_RLELosslessTransferSyntax_1.2.840.10008.1.2.5.dcm",
        "dicomrt-oncentra-phantom/RD1.3.6.1.4.1.2452.6.2111780937.1099271091.4199586950.4014688818.dcm",
        "dicomrt-oncentra-phantom/RS1.3.6.1.4.1.2452.6.727319383.1116259385.3336283576.3074434425.dcm",
        "dicomrt-plans/vmat_example.dcm",
    };
    char path[1024];
    if (!data_path(files[0], path, sizeof path))
        skip();
    dicom_prepare();
    random_state = 11;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        assert_true(data_path(files[i], path, sizeof path));
        damage(path, 60);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_file_of_the_hostile_collections_is_read_or_refused_in_time),
        cmocka_unit_test(damaged_copies_of_real_files_are_read_or_refused_in_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
