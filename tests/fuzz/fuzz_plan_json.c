/* plan.json; with an odd first byte, the lists of label names. */
#include "core/formats/plan/plan_json.h"
#include "tests/fuzz/fuzz.h"

static void plan_file(const uint8_t *data, size_t n)
{
    struct report report = { 0 };
    struct error err = { 0 };
    struct plan_file *file = plan_file_parse(data, n, &report, &err);
    if (file) {
        REQUIRE(file->n_images <= PLAN_FILE_MAX_IMAGES && file->n_doses <= PLAN_FILE_MAX_DOSES &&
                file->n_beams <= PLAN_FILE_MAX_BEAMS);
        REQUIRE(file->n_regions <= PLAN_FILE_MAX_PARTS && file->n_tracks <= PLAN_FILE_MAX_TRACKS);
        /* no accepted path leads out of the folder */
        for (size_t i = 0; i < file->n_images; i++)
            REQUIRE(folder_check_name(file->images[i].path, &err));
        for (size_t i = 0; i < file->n_regions; i++)
            REQUIRE(folder_check_name(file->regions[i].path, &err));
        for (size_t i = 0; i < file->n_tracks; i++)
            REQUIRE(folder_check_name(file->tracks[i].path, &err));
        plan_file_destroy(file);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    report_finish(&report);
}

static void names(const uint8_t *data, size_t n)
{
    struct label_names names = { 0 };
    struct error err = { 0 };
    if (label_names_parse(data, n, "labels.json", &names, &err)) {
        REQUIRE(names.n <= PLAN_FILE_MAX_LABELS);
        label_names_finish(&names);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n >= 1)
        (data[0] % 2 == 0 ? plan_file : names)(data + 1, n - 1);
    return 0;
}
