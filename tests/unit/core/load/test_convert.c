/* A plan written as a folder of ours and opened again is the same plan. */
#include <stdio.h>
#include <unistd.h>

#include "core/formats/folder.h"
#include "core/formats/nifti.h"
#include "core/formats/nifti_write.h"
#include "core/load/load.h"
#include "core/load/write_plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/same_plan.h"

#define EXACT_MM 1e-6

static struct plan *load(const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    return plan;
}

static void assert_comes_back(const char *path)
{
    char folder[256], out[300];
    struct error err = { 0 };
    struct plan *plan = load(path);
    folder_make(folder);
    snprintf(out, sizeof out, "%s/out", folder);
    assert_true(plan_write(plan, out, NULL, &err));
    struct plan *again = load(out);
    assert_same_plan(again, plan, EXACT_MM);
    plan_destroy(plan);
    plan_destroy(again);
    folder_remove(folder);
}

static struct volume *sheared_volume(enum voxel_type type, double spacing_mm)
{
    struct error err = { 0 };
    const uint32_t size[3] = { 9, 8, 7 };
    struct grid grid = made_grid(9, 8, 7,
                                 made_affine(vec3(spacing_mm, 0.1, 0), vec3(-0.1, spacing_mm, 0.2),
                                             vec3(0, -0.2, 3.3333333333), size, vec3(-101.01562, 77.7, 1234.56789)));
    struct volume *volume = volume_create(&grid, type, &err);
    assert_string_equal(err.text, "");
    return volume;
}

static struct volume *made_mask(uint32_t from, uint32_t to)
{
    struct volume *mask = sheared_volume(VOXEL_U8, 1.01562);
    for (uint32_t k = from; k < to; k++)
        for (uint32_t j = 1; j < 7; j++)
            for (uint32_t i = 1; i < 8; i++)
                ((uint8_t *)mask->voxels)[(k * 8 + j) * 9 + i] = 1;
    return mask;
}

/* Oblique grids whose numbers 32 bits cannot hold, overlapping and empty regions, two of one name, a tree, a scaled
 * image, a masked dose. */
static void put_plan(const char *folder)
{
    static const char text[] =
        "{\"format\": \"beamroom-plan\", \"version\": 1, \"name\": \"K\xc3\xb6rper \\\"7\\\"\", \"note\": \"two\\nlines\", \"phantom\": true,\n"
        "\"images\": [{\"id\": \"ct\", \"name\": \"CT thorax\", \"path\": \"a.nii.gz\", \"modality\": \"CT\"}, {\"path\": \"b.nii\"}],\n"
        "\"regions\": [{\"path\": \"m1.nii\", \"name\": \"Outer\", \"color\": \"#102030\"}, {\"path\": \"m2.nii\", \"name\": \"Inner\"},\n"
        "  {\"path\": \"m3.nii\", \"name\": \"inner\"}, {\"path\": \"m0.nii\", \"name\": \"Nothing\"}],\n"
        "\"hierarchy\": {\"Outer\": [\"inner-2\"]},\n"
        "\"doses\": [{\"id\": \"d\", \"unit\": \"Gy\", \"per\": \"fraction\", \"mask\": \"m1.nii\", \"components\": [\n"
        "  {\"quantity\": \"boron\", \"per_ppm\": true, \"path\": \"a.nii.gz\"}, {\"quantity\": \"gamma\", \"path\": \"b.nii\", \"error\": \"a.nii.gz\"}]},\n"
        "  {\"id\": \"e\", \"unit\": \"cGy\", \"frame_of_reference\": \"differs\", \"path\": \"b.nii\", \"boron_ppm\": 12.7},\n"
        "  {\"id\": \"f\", \"frame_of_reference\": \"same\", \"path\": \"b.nii\", \"quantity\": \"weighted-total\", \"boron_ppm\": 0},\n"
        "  {\"id\": \"g\", \"frame_of_reference\": \"unknown\", \"path\": \"b.nii\"}],\n"
        "\"beams\": [{\"id\": \"AP\", \"entry_mm\": [0.1, -200.3, 7], \"target_mm\": [1e-3, 2, 3], \"aperture_mm\": 100.5},\n"
        "  {\"entry_mm\": [1, 2, 3], \"target_mm\": [4, 5, 6]}],\n"
        "\"tracks\": [{\"path\": \"t.pp\", \"unit\": \"mm\"}]}";
    static const char tracks[] =
        "0.1234 2 3 4 5 6 0 1\n1 2 3 4 5 7.0001 0 2\n1 2 3 4 5 8 0 3\n1 2 3 4 5 9 1 1\n1 2 3 4 5 9 1 2\n"
        "1 2 3 4 5 9 1 3\n1 2 3 4 5 9 2 0\n1 2 3 4 5 9 3 0\n";
    struct volume *a = sheared_volume(VOXEL_I16, 1.01562), *b = sheared_volume(VOXEL_F32, 0.7);
    a->slope = 0.1; /* not a 32-bit number */
    a->offset = -1024.3;
    for (size_t i = 0; i < grid_n_voxels(&a->grid); i++) {
        ((int16_t *)a->voxels)[i] = (int16_t)(i * 97 - 9000);
        ((float *)b->voxels)[i] = i == 5 ? NAN : (float)i / 7;
    }
    folder_put(folder, "plan.json", text, sizeof text - 1);
    folder_put(folder, "t.pp", tracks, sizeof tracks - 1);
    folder_put_volume(folder, "a.nii.gz", a);
    folder_put_volume(folder, "b.nii", b);
    folder_put_volume(folder, "m0.nii", made_mask(3, 3));
    folder_put_volume(folder, "m1.nii", made_mask(0, 6));
    folder_put_volume(folder, "m2.nii", made_mask(2, 4));
    folder_put_volume(folder, "m3.nii", made_mask(3, 5));
}

static void a_made_plan_comes_back_with_all_its_peculiarities(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    put_plan(folder);
    struct plan *plan = load(folder);
    assert_int_equal(plan->regions.n_layers, 3);
    assert_string_equal(plan->regions.regions[2].id, "inner-2");
    assert_int_equal(plan->regions.regions[2].parent, 0);
    assert_int_equal(plan->regions.regions[3].n_voxels, 0);
    assert_int_equal(plan->n_doses, 4);
    assert_false(plan->doses[0].has_frame);
    assert_true(plan->doses[1].has_frame && plan->doses[1].frame == DOSE_FRAME_DIFFERS);
    assert_true(plan->doses[1].components[0].has_boron_ppm);
    assert_close(plan->doses[1].components[0].boron_ppm, 12.7, 0);
    assert_non_null(strstr(report_said(&plan->report, "dose.frame-differs"), "\"e\""));
    assert_true(plan->doses[2].frame == DOSE_FRAME_SAME &&
                plan->doses[2].components[0].has_boron_ppm); /* 0 ppm is said too */
    assert_true(plan->doses[3].frame == DOSE_FRAME_UNKNOWN && !plan->doses[3].components[0].has_boron_ppm);
    assert_null(plan->doses[0].components[0].error);
    const struct volume *error = plan->doses[0].components[1].error; /* raw 97 - 9000 at the second voxel of a.nii.gz */
    assert_non_null(error);
    assert_close(volume_value(error, 1, 0, 0), 0.1 * (97 - 9000) - 1024.3, 1e-3);
    plan_destroy(plan);
    assert_comes_back(folder);
    folder_remove(folder);
}

static void real_plans_come_back(void **state)
{
    (void)state;
    static const char *const names[] = { "sera-head",
                                         "sera-head/generated",
                                         "sera-head/original", /* without a plan.json: curves, levels, colours */
                                         "sera-st",
                                         "openkbp-pt99",
                                         "mr-tumour-nrrd",
                                         "matrad-phantoms/BOXPHANTOM",
                                         "eclipse-ent-dose",
                                         "eclipse-ent-dose/struct",
                                         "glioma-tcga-du7294",
                                         "dicomrt-oncentra-phantom" };
    char path[512];
    size_t n = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (data_path(names[i], path, sizeof path)) {
            assert_comes_back(path);
            n++;
        }
    if (n == 0)
        skip();
}

static void a_folder_that_holds_something_is_left_alone_and_a_failure_leaves_nothing(void **state)
{
    (void)state;
    char folder[256], out[300], path[400];
    struct error err = { 0 };
    folder_make(folder);
    put_plan(folder);
    struct plan *plan = load(folder);
    assert_false(plan_write(plan, folder, NULL, &err));
    assert_int_equal(err.code, ERROR_STATE);
    snprintf(out, sizeof out, "%s/plan.json", folder);
    assert_false(plan_write(plan, out, NULL, &err));
    snprintf(out, sizeof out, "%s/absent/out", folder);
    assert_false(plan_write(plan, out, NULL, &err));
    assert_int_equal(err.code, ERROR_IO);
    snprintf(path, sizeof path, "%s/absent", folder);
    assert_int_not_equal(access(path, F_OK), 0);
    plan_destroy(plan);
    folder_remove(folder);
}

/* Oracle: nibabel reads both versions; the matrix within 1e-9 mm of what was asked for, values exactly. */
static void exact_files_are_what_nibabel_reads_too(void **state)
{
    (void)state;
    char folder[256], path[300], answer[4096];
    struct error err = { 0 };
    folder_make(folder);
    snprintf(path, sizeof path, "%s/a.nii.gz", folder);
    struct volume *volume = sheared_volume(VOXEL_I16, 1.01562);
    volume->slope = 0.1;
    for (size_t i = 0; i < grid_n_voxels(&volume->grid); i++)
        ((int16_t *)volume->voxels)[i] = (int16_t)i;
    assert_true(nifti_write_exact(path, volume, NULL, &err));
    char script[] = "tests/oracle/nifti_values.py";
    char *arguments[] = { oracle_python(), script, path, NULL };
    int status = oracle_run(arguments, answer, sizeof answer);
    char *at = strchr(answer, ' ');
    double numbers[17];
    for (int i = 0; status == 0 && i < 17; i++)
        numbers[i] = strtod(at, &at);
    const struct affine *map = &volume->grid.lps_mm_from_ijk;
    const struct vec3 columns[4] = { map->columns[0], map->columns[1], map->columns[2], map->origin };
    for (int i = 0; status == 0 && i < 4; i++) {
        assert_close(numbers[3 + 3 * i], columns[i].x, 1e-9);
        assert_close(numbers[4 + 3 * i], columns[i].y, 1e-9);
        assert_close(numbers[5 + 3 * i], columns[i].z, 1e-9);
    }
    if (status == 0)
        assert_close(numbers[16], 503 * 0.1, 1e-12);
    volume_unref(volume);
    folder_remove(folder);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_made_plan_comes_back_with_all_its_peculiarities),
        cmocka_unit_test(real_plans_come_back),
        cmocka_unit_test(a_folder_that_holds_something_is_left_alone_and_a_failure_leaves_nothing),
        cmocka_unit_test(exact_files_are_what_nibabel_reads_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
