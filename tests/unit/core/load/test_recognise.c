/* Folders without a plan.json: which files are looked at, and what they are taken for. */
#define _GNU_SOURCE
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/formats/folder.h"
#include "core/formats/nifti_write.h"
#include "core/load/load.h"
#include "core/load/parts.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"

static void put_grid(const char *folder, const char *name, enum voxel_type type)
{
    struct error err = { 0 };
    const uint32_t size[3] = { 4, 4, 4 };
    struct grid grid =
        made_grid(4, 4, 4, made_affine(vec3(10, 0, 0), vec3(0, 10, 0), vec3(0, 0, 10), size, vec3(0, 0, 0)));
    struct volume *volume = volume_create(&grid, type, &err);
    assert_non_null(volume);
    for (size_t i = 0; type == VOXEL_U8 && i < 64; i++)
        ((uint8_t *)volume->voxels)[i] = i % 4 == 1 ? 1 : i % 4 == 2 ? 2 : 0;
    for (size_t i = 0; type == VOXEL_F32 && i < 64; i++)
        ((float *)volume->voxels)[i] = (float)i;
    char path[600];
    folder_put(folder, name, "", 0); /* makes its folder */
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_true(nifti_write(path, volume, NULL, &err));
    volume_unref(volume);
}

static void files_of_all_folders_are_listed_in_order_with_what_tells_a_change(void **state)
{
    (void)state;
    char folder[256], link[300], outside[256], target[300];
    folder_make(folder);
    folder_make(outside);
    folder_put_text(outside, "secret", "x");
    folder_put_text(folder, "b", "12345");
    folder_put_text(folder, "a/z", "1");
    folder_put_text(folder, "a/.hidden", "1");
    folder_put_text(folder, ".git/config", "1");
    snprintf(link, sizeof link, "%s/round", folder);
    assert_int_equal(symlink(".", link), 0);
    snprintf(link, sizeof link, "%s/out", folder);
    snprintf(target, sizeof target, "%s/secret", outside);
    assert_int_equal(symlink(target, link), 0);
    snprintf(link, sizeof link, "%s/in", folder);
    assert_int_equal(symlink("b", link), 0);

    struct folder opened;
    struct folder_tree tree;
    struct error err = { 0 };
    assert_true(folder_open(&opened, folder, &err));
    assert_true(folder_walk(&opened, "", NULL, &tree, &err));
    assert_int_equal(tree.n_files, 3);
    assert_string_equal(tree.files[0].name, "a/z");
    assert_string_equal(tree.files[1].name, "b");
    assert_string_equal(tree.files[2].name, "in");
    assert_int_equal(tree.files[1].bytes, 5);
    assert_int_equal(tree.files[2].bytes, 5);
    struct stat about;
    snprintf(link, sizeof link, "%s/b", folder);
    assert_int_equal(stat(link, &about), 0);
    assert_int_equal(tree.files[1].inode, about.st_ino);
    assert_true(tree.files[1].modified_ns == (int64_t)about.st_mtim.tv_sec * 1000000000 + about.st_mtim.tv_nsec);
    assert_false(tree.is_cut);
    assert_int_equal(tree.n_passed, 2); /* out, round */
    assert_true(strcmp(tree.passed, "out") == 0 || strcmp(tree.passed, "round") == 0);
    folder_tree_finish(&tree);
    assert_true(folder_walk(&opened, "a", NULL, &tree, &err));
    assert_int_equal(tree.n_passed, 0);
    assert_int_equal(tree.n_files, 1);
    assert_string_equal(tree.files[0].name, "a/z");
    folder_tree_finish(&tree);
    assert_false(folder_walk(&opened, "..", NULL, &tree, &err));
    assert_false(folder_walk(&opened, "round/absent", NULL, &tree, &err));
    folder_close(&opened);
    folder_remove(folder);
    folder_remove(outside);
}

static void folders_are_entered_so_deep_and_no_deeper(void **state)
{
    (void)state;
    char folder[256], path[600];
    folder_make(folder);
    size_t n = (size_t)snprintf(path, sizeof path, "%s", folder);
    for (int depth = 1; depth <= FOLDER_MAX_DEPTH + 1; depth++) {
        n += (size_t)snprintf(path + n, sizeof path - n, "/d");
        assert_int_equal(mkdir(path, 0700), 0);
        folder_put_text(path, "f", "1");
    }
    struct folder opened;
    struct folder_tree tree;
    struct error err = { 0 };
    assert_true(folder_open(&opened, folder, &err));
    assert_true(folder_walk(&opened, "", NULL, &tree, &err));
    assert_int_equal(tree.n_files, FOLDER_MAX_DEPTH);
    assert_true(tree.is_cut);
    folder_tree_finish(&tree);
    folder_close(&opened);
    folder_remove(folder);
}

static void parts_are_found_in_folders_below_and_plans_of_their_own_are_left_out(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put_grid(folder, "t1.nii.gz", VOXEL_F32);
    put_grid(folder, "segmentation/parts.nii.gz", VOXEL_U8);
    folder_put_text(folder, "segmentation/parts.json",
                    "{\"labels\": [{\"value\": 1, \"name\": \"brain\"}, {\"value\": 2, \"name\": \"tumour\"}]}");
    put_grid(folder, "plan/dose_total.nii.gz", VOXEL_F32);
    put_grid(folder, "other/ct.nii.gz", VOXEL_F32);
    folder_put_text(folder, "other/plan.json", "{}");
    struct error err = { 0 };
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_images, 1);
    assert_string_equal(plan->images[0].id, "t1");
    assert_int_equal(plan->regions.n_regions, 2);
    assert_string_equal(plan->regions.regions[0].name, "brain");
    assert_string_equal(plan->regions.regions[1].name, "tumour");
    assert_int_equal(plan->n_doses, 1);
    assert_string_equal(plan->doses[0].id, "dose-total");
    assert_close(plan->doses[0].components[0].values->high, 63, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

/* A data set whose first byte is that of something else is none: no reader finds its elements (pydicom with force and
 * dcmdump do not). */
static void a_folder_of_what_only_is_named_dicom_is_refused_with_what_was_found(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    folder_make(folder);
    folder_put(folder, "cut/shifted.dcm",
               "\x20\x08\x00\x05\x00"
               "CS\x0a\x00ISO_IR 100",
               19);
    assert_null(plan_load(folder, "p", NULL, &err));
    assert_non_null(strstr(err.text, "cut/shifted.dcm: "));
    assert_non_null(
        strstr(err.text,
               "byte 0: expected \"DICM\" at byte 128, or an element of group 0002 or 0008 here; found 20 08 00 05"));
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_of_all_folders_are_listed_in_order_with_what_tells_a_change),
        cmocka_unit_test(folders_are_entered_so_deep_and_no_deeper),
        cmocka_unit_test(parts_are_found_in_folders_below_and_plans_of_their_own_are_left_out),
        cmocka_unit_test(a_folder_of_what_only_is_named_dicom_is_refused_with_what_was_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
