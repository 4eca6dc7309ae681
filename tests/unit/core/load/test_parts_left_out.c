/* One good image beside one bad or unknown file: the image opens, and the report names the file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/plan_help.h"

enum { SIDE = 12 };

static struct volume *make_volume(enum voxel_type type)
{
    struct grid grid = made_cube_grid(SIDE);
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, type, &err);
    assert_non_null(volume);
    return volume;
}

static void put_image(const char *folder)
{
    struct volume *volume = make_volume(VOXEL_I16);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        ((int16_t *)volume->voxels)[i] = (int16_t)(i % 1000 - 500);
    volume_measure(volume);
    folder_put_volume(folder, "image.nii.gz", volume);
}

/* A mask of one block, cut by 9 bytes. */
static void put_cut(const char *folder, const char *name)
{
    char path[600];
    size_t n;
    struct volume *volume = make_volume(VOXEL_U8);
    memset((uint8_t *)volume->voxels + 500, 1, 400);
    volume_measure(volume);
    folder_put_volume(folder, name, volume);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    uint8_t *bytes = file_bytes(path, &n);
    assert_true(n > 9);
    folder_put(folder, name, bytes, n - 9);
    free(bytes);
}

static void put_many_labels(const char *folder, const char *name)
{
    struct grid grid = made_cube_grid(20); /* 20^3 voxels, 4 a label */
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, VOXEL_U16, &err);
    assert_non_null(volume);
    for (int i = 0; i < 6000; i++)
        ((uint16_t *)volume->voxels)[i] = (uint16_t)(i / 4 + 1);
    volume_measure(volume);
    folder_put_volume(folder, name, volume);
}

static void put_huge(const char *folder, const char *name)
{
    struct nifti_bytes file = nifti_bytes_make(4096, 4096, 4096, 2, 8, 100, false);
    folder_put(folder, name, file.data, file.size);
    nifti_bytes_free(&file);
}

static void put_complex(const char *folder, const char *name)
{
    struct nifti_bytes file = nifti_bytes_make(4, 4, 4, 32, 64, 512, false);
    folder_put(folder, name, file.data, file.size);
    nifti_bytes_free(&file);
}

#define NRRD_HEAD(encoding) \
    "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n" \
    "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nkinds: domain domain domain\nencoding: " encoding \
    "\n\n"

static const struct bad {
    const char *name;
    void (*put)(const char *folder, const char *name);
    const char *text; /* instead of put */
    const char *said; /* in the line about it */
} bad[] = {
    { "gtv_mask.nii.gz", put_cut, NULL, "cut short" },
    { "dose_total.nii.gz", put_cut, NULL, "cut short" },
    { "other.nii.gz", put_cut, NULL, "cut short" },
    { "many_seg.nii.gz", put_many_labels, NULL, "1500 labels" },
    { "huge_mask.nii", put_huge, NULL, "at most" },
    { "complex.nii", put_complex, NULL, "complex" },
    { "empty.nii", NULL, "", "empty.nii" },
    { "packed.nrrd", NULL, NRRD_HEAD("bzip2") "BZh9", "bzip2" },
    { "text.nrrd", NULL, NRRD_HEAD("ascii") "1 2 3 4 5 6 7 8", "ascii" },
    { "short_seg.nrrd", NULL, NRRD_HEAD("raw") "1234", "cut short" },
    { "apart.nhdr", NULL, "NRRD0004\ntype: uchar\n", "apart.nhdr" },
    { "a.uvh", NULL, "Version: uvh2.0\n", "no file of univels" },
    { "a.qhd", NULL, "x", "no file of pixels" },
    { "a.rst", NULL, "no dose at all\n", "header" },
    { "a.chd", NULL, "x", "table of points" },
    { "a.pp", NULL, "", "a.pp" },
    { "a.dose", NULL, "no table\n", "a.dose" },
    { "a.hdr", NULL, "x", "a.hdr" },
    { "slice.dcm", NULL, "not one", "DICOM" },
    { "meshtal", NULL, "mcnp version 6\n", "mesh tally of MCNP" },
    { "deposit.out", NULL, "[ T - Deposit ]\n", "output of a program" },
    { "dose.vti", NULL, "<?xml?>", "grid of VTK" },
    { "brain.stl", NULL, "solid a\n", "surface mesh" },
    { "case.mat", NULL, "MATLAB 5.0 MAT-file", "MATLAB" },
    { "DoseAtPhantom.csv", NULL, "x,y,z,dose\n", "table without the columns of tracks" },
    { "notes", NULL, "what was done\n", "text of an unknown kind" },
    { "blob", NULL, "\x01\x02", "binary data" },
    { "nothing", NULL, "", "empty" },
};

static void a_bad_part_hides_no_other_and_is_named(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char folder[256];
        struct error err;
        folder_make(folder);
        put_image(folder);
        if (bad[i].put)
            bad[i].put(folder, bad[i].name);
        else
            folder_put_text(folder, bad[i].name, bad[i].text);
        struct plan *plan = plan_of_folder(folder, &err);
        if (!plan)
            fail_msg("%s: the plan is refused: %s", bad[i].name, err.text);
        assert_int_equal(plan->n_images, 1);
        assert_string_equal(plan->images[0].id, "image");
        assert_close(plan->images[0].volume->low, -500, 0);
        bool is_said = false;
        for (size_t l = 0; l < plan->report.n_lines; l++) {
            const struct report_line *line = &plan->report.lines[l];
            is_said |= strcmp(line->where, bad[i].name) == 0 && strstr(line->sentence, bad[i].said);
        }
        if (!is_said)
            fail_msg("%s: no line about it says \"%s\"", bad[i].name, bad[i].said);
        plan_destroy(plan);
        folder_remove(folder);
    }
}

static void every_file_has_a_line_and_their_number_is_bounded(void **state)
{
    (void)state;
    char folder[256], name[32];
    struct error err;
    folder_make(folder);
    put_image(folder);
    folder_put_text(folder, "labels.json", "{\"labels\": [{\"value\": 1, \"name\": \"brain\"}]}");
    struct volume *mask = make_volume(VOXEL_U8);
    memset((uint8_t *)mask->voxels + 300, 1, 300);
    volume_measure(mask);
    folder_put_volume(folder, "parts_seg.nii.gz", mask);
    for (int i = 0; i < 100; i++) {
        snprintf(name, sizeof name, "unknown-%03d.stl", i);
        folder_put_text(folder, name, "x");
    }
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    size_t n_read = 0, n_not_read = 0;
    bool has_rest = false;
    for (size_t i = 0; i < plan->report.n_lines; i++) {
        const struct report_line *line = &plan->report.lines[i];
        n_read += strcmp(line->code, "file.read") == 0;
        n_not_read += strcmp(line->code, "file.not-read") == 0 && line->where[0];
        has_rest |= strcmp(line->sentence, "40 more files were not read.") == 0;
        if (strcmp(line->code, "file.read") == 0 && strcmp(line->where, "labels.json") == 0)
            assert_string_equal(line->sentence, "Read as names of labels.");
    }
    assert_int_equal(n_read, 3);
    assert_int_equal(n_not_read, 60);
    assert_true(has_rest);
    plan_destroy(plan);
    folder_remove(folder);
}

static void names_that_are_not_followed_are_counted(void **state)
{
    (void)state;
    char folder[256], path[600];
    struct error err;
    folder_make(folder);
    put_image(folder);
    snprintf(path, sizeof path, "%s/gone_mask.nii.gz", folder);
    assert_int_equal(symlink("nothing", path), 0);
    snprintf(path, sizeof path, "%s/pipe_mask.nii.gz", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    put_cut(folder, "two\nlines_mask.nii.gz");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_images, 1);
    assert_non_null(strstr(report_said(&plan->report, "file.not-read"), "3 names of the folder were not followed"));
    plan_destroy(plan);
    folder_remove(folder);
}

/* Archives of Windows keep names in Latin-1 or Shift-JIS. */
static void names_that_are_not_utf_8_open(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_image(folder);
    struct volume *mask = make_volume(VOXEL_U8);
    memset((uint8_t *)mask->voxels + 300, 1, 300);
    volume_measure(mask);
    folder_put_volume(folder, "h\xfclle_mask.nii.gz", mask);
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->regions.n_regions, 1);
    assert_string_equal(plan->regions.regions[0].name, "h?lle_mask");
    assert_int_equal(plan->regions.regions[0].n_voxels, 300);
    assert_false(report_has(&plan->report, "part.unreadable"));
    plan_destroy(plan);
    folder_remove(folder);
}

static void an_image_without_a_number_is_not_said_to_be_0(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_image(folder);
    struct volume *volume = make_volume(VOXEL_F32);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        ((float *)volume->voxels)[i] = NAN;
    volume_measure(volume);
    folder_put_volume(folder, "t1.nii.gz", volume);
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_string_equal(report_said(&plan->report, "image.constant"), "No voxel holds a number.");
    plan_destroy(plan);
    folder_remove(folder);
}

static void names_keep_everything_but_the_endings_of_their_format(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    for (int i = 0; i < 2; i++) {
        struct volume *mask = make_volume(VOXEL_U8);
        memset((uint8_t *)mask->voxels + 300, 1, 300);
        volume_measure(mask);
        folder_put_volume(folder, i ? "case7.liver_mask.nii.gz" : "case7.spleen_mask.nii", mask);
    }
    put_image(folder);
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_string_equal(plan->regions.regions[0].name, "case7.liver_mask");
    assert_string_equal(plan->regions.regions[1].name, "case7.spleen_mask");
    assert_false(report_has(&plan->report, "region.renamed"));
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bad_part_hides_no_other_and_is_named),
        cmocka_unit_test(every_file_has_a_line_and_their_number_is_bounded),
        cmocka_unit_test(names_that_are_not_followed_are_counted),
        cmocka_unit_test(names_that_are_not_utf_8_open),
        cmocka_unit_test(an_image_without_a_number_is_not_said_to_be_0),
        cmocka_unit_test(names_keep_everything_but_the_endings_of_their_format),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
