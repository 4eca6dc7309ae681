/* Folders without a plan.json: which map a list of label names belongs to, and what could be a mask. */
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

#define NAMES "\"labels\": [{\"value\": 1, \"name\": \"necrosis\"}, {\"value\": 2, \"name\": \"edema\"}]"

/* 6 x 6 x 6 voxels whose values go from 0 to highest in turn; of floats when asked. */
static void put_map(const char *folder, const char *name, int highest, bool is_float)
{
    struct grid grid = made_cube_grid(6);
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, is_float ? VOXEL_F32 : VOXEL_U8, &err);
    assert_non_null(volume);
    for (int i = 0; i < 216; i++) {
        int value = i % (highest + 1);
        if (is_float)
            ((float *)volume->voxels)[i] = (float)value;
        else
            ((uint8_t *)volume->voxels)[i] = (uint8_t)value;
    }
    volume_measure(volume);
    folder_put_volume(folder, name, volume);
}

static struct plan *open_and_remove(const char *folder)
{
    struct error err;
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    folder_remove(folder);
    return plan;
}

static size_t n_named(const struct plan *plan, const char *name)
{
    size_t n = 0;
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        n += strcmp(plan->regions.regions[r].name, name) == 0;
    return n;
}

/* The line about a file; fails where there is none. */
static const struct report_line *line_about(const struct plan *plan, const char *code, const char *where)
{
    for (size_t i = 0; i < plan->report.n_lines; i++)
        if (strcmp(plan->report.lines[i].code, code) == 0 && strcmp(plan->report.lines[i].where, where) == 0)
            return &plan->report.lines[i];
    fail_msg("no %s about %s", code, where);
    return NULL;
}

static void a_list_that_names_its_map_names_no_other(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    folder_put_text(folder, "labels.json", "{\"file\": \"tumour_seg.nii.gz\", " NAMES "}");
    put_map(folder, "brain_mask.nii.gz", 1, false);
    put_map(folder, "tumour_seg.nii.gz", 2, false);
    put_map(folder, "other_seg.nii.gz", 2, false);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(plan->regions.n_regions, 5);
    assert_int_equal(n_named(plan, "necrosis"), 1);
    assert_int_equal(n_named(plan, "edema"), 1);
    assert_int_equal(n_named(plan, "brain_mask"), 1); /* its only label goes by the file's name */
    assert_int_equal(n_named(plan, "label 1"), 1);
    assert_int_equal(n_named(plan, "label 2"), 1);
    assert_int_equal(line_about(plan, "region.names-elsewhere", "brain_mask.nii.gz")->severity, REPORT_WARNING);
    const struct report_line *line = line_about(plan, "region.names-elsewhere", "other_seg.nii.gz");
    assert_non_null(strstr(line->sentence, "labels.json"));
    assert_non_null(strstr(line->sentence, "tumour_seg.nii.gz"));
    assert_non_null(strstr(line->sentence, "\"names\""));
    plan_destroy(plan);
}

/* The list says so itself: neither the file's name nor the kind of its numbers has to. */
static void a_map_that_a_list_names_is_one_whatever_it_is_called(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    folder_put_text(folder, "study/labels.json", "{\"file\": \"OTMultiClass.nii.gz\", " NAMES "}");
    put_map(folder, "study/OTMultiClass.nii.gz", 2, true);
    put_map(folder, "study/t1.nii.gz", 100, false);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(plan->n_images, 1);
    assert_string_equal(plan->images[0].id, "t1");
    assert_int_equal(plan->regions.n_regions, 2);
    assert_int_equal(n_named(plan, "necrosis"), 1);
    assert_false(report_has(&plan->report, "region.names-elsewhere"));
    plan_destroy(plan);
}

static void a_list_without_a_map_goes_to_the_one_it_is_called_after_or_to_the_only_one(void **state)
{
    (void)state;
    static const struct {
        const char *with_names, *without[2];
    } cases[] = { { "labels.nii.gz", { "possible_mask.nii.gz", "b_seg.nii.gz" } }, /* called after it */
                  { "tumour_seg.nii.gz", { "brain_mask.nii.gz", NULL } }, /* a list of labels is not one of a mask */
                  { "only_mask.nii.gz", { NULL, NULL } },
                  { NULL, { "a_seg.nii.gz", "b_seg.nii.gz" } } }; /* nothing says whose it is */
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[256];
        folder_make(folder);
        folder_put_text(folder, "labels.json", "{" NAMES "}");
        if (cases[i].with_names)
            put_map(folder, cases[i].with_names, 2, false);
        for (int w = 0; w < 2; w++)
            if (cases[i].without[w])
                put_map(folder, cases[i].without[w], 2, false);
        struct plan *plan = open_and_remove(folder);
        assert_int_equal(n_named(plan, "necrosis"), cases[i].with_names != NULL);
        for (int w = 0; w < 2; w++)
            if (cases[i].without[w])
                (void)line_about(plan, "region.names-elsewhere", cases[i].without[w]);
        if (!cases[i].without[0])
            assert_false(report_has(&plan->report, "region.names-elsewhere"));
        plan_destroy(plan);
    }
}

static void a_list_of_a_map_that_is_not_there_names_nothing_and_is_said(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    folder_put_text(folder, "labels.json", "{\"file\": \"gone.nii.gz\", " NAMES "}");
    put_map(folder, "a_seg.nii.gz", 2, false);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(n_named(plan, "necrosis"), 0);
    assert_non_null(strstr(line_about(plan, "region.names-elsewhere", "labels.json")->sentence, "gone.nii.gz"));
    (void)line_about(plan, "region.names-elsewhere", "a_seg.nii.gz");
    plan_destroy(plan);
}

/* plan.json is a person's word and is followed; that the list says otherwise is worth a look. */
static void a_plan_that_gives_a_map_the_list_of_another_is_followed_with_a_warning(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    folder_put_text(folder, "names.json", "{\"file\": \"right.nii.gz\", " NAMES "}");
    put_map(folder, "right.nii.gz", 2, false);
    put_map(folder, "wrong.nii.gz", 1, false);
    folder_put_text(
        folder, "plan.json",
        "{\"format\": \"beamroom-plan\", \"version\": 1, \"regions\": [{\"path\": \"right.nii.gz\", \"names\": \"names.json\"}, "
        "{\"path\": \"wrong.nii.gz\", \"names\": \"names.json\"}]}");
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(n_named(plan, "necrosis"), 2);
    assert_non_null(strstr(line_about(plan, "region.names-elsewhere", "wrong.nii.gz")->sentence, "right.nii.gz"));
    size_t n = 0;
    for (size_t i = 0; i < plan->report.n_lines; i++)
        n += strcmp(plan->report.lines[i].code, "region.names-elsewhere") == 0;
    assert_int_equal(n, 1);
    plan_destroy(plan);
}

/* Lists of 15 MiB each, of which the first four fit into 64 MiB. */
static void lists_of_names_are_read_up_to_a_sum_of_bytes(void **state)
{
    (void)state;
    enum { N = 6, SIZE = 15 << 20 };
    static const char names[] = "{" NAMES "}";
    char folder[256], *list = malloc(SIZE);
    assert_non_null(list);
    memset(list, ' ', SIZE);
    memcpy(list, names, sizeof names - 1);
    folder_make(folder);
    for (int i = 0; i < N; i++) {
        char name[32];
        snprintf(name, sizeof name, "%c_seg.nii.gz", 'a' + i);
        put_map(folder, name, 2, false);
        snprintf(name, sizeof name, "%c_seg.json", 'a' + i);
        folder_put(folder, name, list, SIZE);
    }
    free(list);
    struct plan *plan = open_and_remove(folder);
    assert_int_equal(n_named(plan, "necrosis"), 4);
    const struct report_line *line = line_about(plan, "region.names-limit", "e_seg.json");
    assert_int_equal(line->severity, REPORT_WARNING);
    assert_non_null(strstr(line->sentence, "more than 64 MiB together; this and 1 more were not read"));
    plan_destroy(plan);
}

static void an_image_of_zeros_and_ones_is_said_to_be_what_may_be_a_region(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int highest;
        bool is_float, is_said;
    } cases[] = { { "PTV70.nii.gz", 1, false, true },
                  { "ptv.nii.gz", 1, true, true },
                  { "ct.nii.gz", 2, false, false } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[256];
        folder_make(folder);
        put_map(folder, cases[i].name, cases[i].highest, cases[i].is_float);
        struct plan *plan = open_and_remove(folder);
        assert_int_equal(plan->n_images, 1);
        assert_int_equal(report_has(&plan->report, "image.may-be-region"), cases[i].is_said);
        if (i == 0) {
            const struct report_line *line = line_about(plan, "image.may-be-region", "PTV70.nii.gz");
            assert_int_equal(line->severity, REPORT_WARNING);
            assert_non_null(strstr(line->sentence, "call the file PTV70_mask.nii.gz, or write a plan.json"));
        } else if (i == 1) { /* whole numbers are labels also when they are stored as floats */
            const struct report_line *line = line_about(plan, "image.may-be-region", "ptv.nii.gz");
            assert_non_null(strstr(line->sentence, "call the file ptv_mask.nii.gz, or"));
            assert_non_null(strstr(line->sentence, "the folder's other files as well"));
        }
        plan_destroy(plan);
    }
    char folder[256]; /* a person who calls it an image knows */
    folder_make(folder);
    put_map(folder, "PTV70.nii.gz", 1, false);
    folder_put_text(folder, "plan.json",
                    "{\"format\": \"beamroom-plan\", \"version\": 1, \"images\": [{\"path\": \"PTV70.nii.gz\"}]}");
    struct plan *plan = open_and_remove(folder);
    assert_false(report_has(&plan->report, "image.may-be-region"));
    plan_destroy(plan);
}

static void a_mask_with_the_name_that_was_advised_is_a_region_beside_the_images(void **state)
{
    (void)state;
    static const char nrrd[] =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 6 6 6\nencoding: raw\nspace: left-posterior-superior\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n";
    char folder[256], bytes[sizeof nrrd - 1 + 216];
    memcpy(bytes, nrrd, sizeof nrrd - 1);
    for (size_t i = 0; i < 216; i++)
        bytes[sizeof nrrd - 1 + i] = (char)(i % 2);
    for (int is_renamed = 0; is_renamed < 2; is_renamed++) {
        folder_make(folder);
        put_map(folder, "ct.nii.gz", 100, false);
        put_map(folder, is_renamed ? "PTV70_mask.nii.gz" : "PTV70.nii.gz", 1, false);
        folder_put(folder, is_renamed ? "GTV_mask.nrrd" : "GTV.nrrd", bytes, sizeof bytes);
        struct plan *plan = open_and_remove(folder);
        assert_int_equal(plan->n_images, is_renamed ? 1 : 3);
        assert_int_equal(plan->regions.n_regions, is_renamed ? 2 : 0);
        if (!is_renamed) {
            assert_non_null(strstr(line_about(plan, "image.may-be-region", "GTV.nrrd")->sentence,
                                   "call the file GTV_mask.nrrd, or"));
            assert_non_null(strstr(line_about(plan, "image.may-be-region", "PTV70.nii.gz")->sentence,
                                   "call the file PTV70_mask.nii.gz, or"));
        }
        plan_destroy(plan);
    }
}

/* ---- real folders, without the plan.json they were given here --------------------------------------------------- */

static struct plan *plan_of_files(const char *set, const char *const *files)
{
    char folder[256], from[256], path[512];
    snprintf(from, sizeof from, "%s/%s", set, files[0]);
    if (!data_path(from, path, sizeof path))
        return NULL;
    folder_make(folder);
    for (size_t i = 0; files[i]; i++) {
        snprintf(from, sizeof from, "%s/%s", set, files[i]);
        folder_put_data(folder, files[i], from);
    }
    return open_and_remove(folder);
}

/* brainmask holds one label, 1, and the list of the other map says that 1 is necrosis: 1524 cm3 of it. */
static void the_brain_of_a_real_glioblastoma_is_no_necrosis(void **state)
{
    (void)state;
    static const char *const files[] = { "labels.json", "OTMultiClass.nii.gz", "brainmask.nii.gz", NULL };
    struct plan *plan = plan_of_files("gbm-brats2013", files);
    if (!plan)
        skip();
    assert_int_equal(plan->n_images, 0);
    assert_int_equal(plan->regions.n_regions, 5);
    const struct region *necrosis = region_of(plan, "necrosis"), *brain = region_of(plan, "brainmask");
    assert_true(necrosis->n_voxels < 100000);
    assert_int_equal(brain->n_voxels, 1523743);
    (void)line_about(plan, "region.names-elsewhere", "brainmask.nii.gz");
    plan_destroy(plan);
}

static void a_real_head_and_neck_plan_has_each_target_once_and_its_masks_are_offered(void **state)
{
    (void)state;
    static const char *const files[] = { "labels.json", "labels.nii.gz", "possible_dose_mask.nii.gz",
                                         "struct/PTV70.nii.gz", NULL };
    struct plan *plan = plan_of_files("openkbp-pt99", files);
    if (!plan)
        skip();
    assert_int_equal(n_named(plan, "PTV56"), 1);
    assert_int_equal(n_named(plan, "possible_dose_mask"), 1);
    assert_int_equal(plan->regions.n_regions, 11);
    (void)line_about(plan, "image.may-be-region", "struct/PTV70.nii.gz");
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_that_names_its_map_names_no_other),
        cmocka_unit_test(a_map_that_a_list_names_is_one_whatever_it_is_called),
        cmocka_unit_test(a_list_without_a_map_goes_to_the_one_it_is_called_after_or_to_the_only_one),
        cmocka_unit_test(a_list_of_a_map_that_is_not_there_names_nothing_and_is_said),
        cmocka_unit_test(a_plan_that_gives_a_map_the_list_of_another_is_followed_with_a_warning),
        cmocka_unit_test(lists_of_names_are_read_up_to_a_sum_of_bytes),
        cmocka_unit_test(an_image_of_zeros_and_ones_is_said_to_be_what_may_be_a_region),
        cmocka_unit_test(a_mask_with_the_name_that_was_advised_is_a_region_beside_the_images),
        cmocka_unit_test(the_brain_of_a_real_glioblastoma_is_no_necrosis),
        cmocka_unit_test(a_real_head_and_neck_plan_has_each_target_once_and_its_masks_are_offered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
