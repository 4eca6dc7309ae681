/* Real RT Structure Sets, compared with pydicom, reference masks and plastimatch. */
#include "core/formats/dicom/dicom_rtstruct.h"

#include <unistd.h>

#include "core/formats/nifti.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_contours.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

static struct rtstruct *read_real(const char *path, struct report *report)
{
    struct rt_file file = rt_file_open(path);
    struct error err = { 0 };
    struct rtstruct *set = rtstruct_read(file.file, "rs.dcm", report, &err);
    if (!set)
        fail_msg("%s", err.text);
    rt_file_close(&file);
    return set;
}

/* The next tab-separated field of a line. */
static char *field(char **rest)
{
    char *from = *rest, *tab = strchr(from, '\t');
    assert_non_null(tab);
    *tab = 0;
    *rest = tab + 1;
    return from;
}

static void compare_region(const struct rtstruct_roi *roi, char *rest)
{
    assert_int_equal(roi->number, strtol(field(&rest), NULL, 10));
    assert_string_equal(roi->name, field(&rest));
    assert_string_equal(roi->kind[0] ? roi->kind : "-", field(&rest));
    for (int i = 0; i < 3; i++)
        assert_int_equal(roi->has_color ? roi->rgb[i] : -1, strtol(field(&rest), NULL, 10));
    assert_int_equal(roi->contours.n_contours, strtoul(field(&rest), NULL, 10));
    size_t n_points = 0;
    double sum[3] = { 0 }, area_mm2 = 0;
    for (size_t c = 0; c < roi->contours.n_contours; c++) {
        const struct contour *contour = &roi->contours.contours[c];
        struct vec3 area = vec3(0, 0, 0);
        for (size_t i = 0; i < contour->n_points; i++) {
            const double *a = contour->points_lps_mm + 3 * i,
                         *b = contour->points_lps_mm + 3 * ((i + 1) % contour->n_points);
            const double *o = contour->points_lps_mm;
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += a[axis];
            area = vec3_add(area, vec3_cross(vec3(a[0] - o[0], a[1] - o[1], a[2] - o[2]),
                                             vec3(b[0] - o[0], b[1] - o[1], b[2] - o[2])));
        }
        area_mm2 += vec3_length(area) / 2;
        n_points += contour->n_points;
    }
    assert_int_equal(n_points, strtoul(field(&rest), NULL, 10));
    for (int axis = 0; axis < 3; axis++) {
        double expected = strtod(field(&rest), NULL);
        assert_close(sum[axis], expected, 1e-6 * (double)n_points); /* summed in another sequence */
    }
    double expected_mm2 = strtod(field(&rest), NULL);
    assert_near(area_mm2, expected_mm2, 1e-9);
    assert_string_equal(roi->frame_uid[0] ? roi->frame_uid : "-", field(&rest));
}

/* Compares every region of a file with pydicom. Returns how many; SIZE_MAX without pydicom. */
static size_t compare_with_pydicom(const char *path, const struct rtstruct *set)
{
    static char out[1 << 16];
    int status =
        oracle_run((char *[]){ oracle_python(), "tests/oracle/dicom_rtstruct.py", (char *)(uintptr_t)path, NULL }, out,
                   sizeof out);
    if (status == ORACLE_MISSING)
        return SIZE_MAX;
    assert_int_equal(status, 0);
    size_t n = 0;
    for (char *line = out, *end; *line; line = end + 1, n++) {
        end = strchr(line, '\n');
        assert_non_null(end);
        *end = '\t';
        assert_true(n < set->n_rois);
        compare_region(&set->rois[n], line);
    }
    assert_int_equal(n, set->n_rois);
    return n;
}

static struct volume *read_mask(const char *path)
{
    struct bytes bytes;
    struct error err = { 0 };
    bytes.data = file_bytes(path, &bytes.size);
    struct volume *volume = nifti_read(&bytes, "mask.nii.gz", RAW_MASK, NULL, &err);
    if (!volume)
        fail_msg("%s", err.text);
    bytes_free(&bytes);
    return volume;
}

static size_t n_different(const struct mask *mask, const struct volume *reference, size_t *n_both, size_t *n_reference)
{
    size_t n = 0;
    *n_both = *n_reference = 0;
    for (uint32_t k = 0; k < mask->size[2]; k++)
        for (uint32_t j = 0; j < mask->size[1]; j++)
            for (uint32_t i = 0; i < mask->size[0]; i++) {
                bool ours = mask_has(mask, i, j, k), theirs = volume_label(reference, i, j, k) != 0;
                n += ours != theirs;
                *n_both += ours && theirs;
                *n_reference += theirs;
            }
    return n;
}

static void the_sarcoma_masks_come_out_voxel_for_voxel(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t n_voxels;
    } sets[] = { { "CT", 117145 }, { "MR_T1", 117145 }, { "PET", 5095 } };
    bool is_compared = true;
    for (int i = 0; i < 3; i++) {
        char archive[64], reference_name[64], reference_path[512], folder[256], path[512];
        snprintf(archive, sizeof archive, "dicomrt-sts001/%s.tar.xz", sets[i].name);
        snprintf(reference_name, sizeof reference_name, "dicomrt-sts001/%s_reference_mask.nii.gz", sets[i].name);
        if (!data_path(reference_name, reference_path, sizeof reference_path) || !rt_unpack(archive, folder))
            skip();
        snprintf(path, sizeof path, "%s/%s/mask/RS.dcm", folder, sets[i].name);
        struct rtstruct *set = read_real(path, NULL);
        size_t n_compared = compare_with_pydicom(path, set);
        assert_true(n_compared == 1 || n_compared == SIZE_MAX);
        is_compared = n_compared == 1;
        struct volume *reference = read_mask(reference_path);
        struct contour_facts facts;
        struct mask *mask = contours_fill(&set->rois[0].contours, &reference->grid, &facts);
        size_t n_both, n_reference;
        assert_int_equal(n_different(mask, reference, &n_both, &n_reference), 0);
        assert_int_equal(mask_count(mask), sets[i].n_voxels);
        assert_near(facts.filled_cm3, facts.polygon_cm3, 0.01);
        assert_int_equal(facts.n_planes, 31);
        struct contour_choice choice; /* chosen as the image's own grid */
        struct error err = { 0 };
        assert_true(
            contour_choose_grids(&set->rois[0].contours, 1, &reference->grid, &contour_defaults, &choice, &err));
        assert_int_equal(choice.group, 0);
        mask_destroy(mask);
        volume_unref(reference);
        rtstruct_destroy(set);
        folder_remove(folder);
    }
    if (!is_compared)
        skip(); /* no pydicom: everything else passed */
}

static void the_lung_phantom_has_3_regions_and_29_empty_ones(void **state)
{
    (void)state;
    char folder[256], path[512];
    if (!rt_unpack("dicomrt-lung-phantom/lung-2.tar.xz", folder))
        skip();
    snprintf(path, sizeof path, "%s/lung-2/rtss.dcm", folder);
    struct report report = { 0 };
    struct rtstruct *set = read_real(path, &report);
    assert_int_equal(set->n_rois, 3);
    assert_string_equal(set->rois[0].name, "Body");
    assert_string_equal(set->rois[1].name, "Tumor");
    assert_string_equal(set->rois[2].name, "Lung");
    assert_non_null(strstr(report_said(&report, "region.no-contours"), "29 of 32 regions have no closed contour"));
    size_t n_compared = compare_with_pydicom(path, set);
    assert_true(n_compared == 3 || n_compared == SIZE_MAX);
    report_finish(&report);
    rtstruct_destroy(set);
    folder_remove(folder);
    if (n_compared == SIZE_MAX)
        skip(); /* no pydicom: everything else passed */
}

static void the_oncentra_phantom_has_7_regions(void **state)
{
    (void)state;
    char folder[512], path[1024];
    if (!data_path("dicomrt-oncentra-phantom", folder, sizeof folder) || !rt_find(folder, "RS", 0, path, sizeof path))
        skip();
    struct rtstruct *set = read_real(path, NULL);
    assert_int_equal(set->n_rois, 7);
    assert_string_equal(set->rois[0].name, "External");
    assert_string_equal(set->rois[0].kind, "EXTERNAL");
    assert_string_equal(set->rois[6].name, "Star");
    assert_string_equal(set->series_uid, "1.3.6.1.4.1.2452.6.1713778621.1221921499.3028853175.878828869");
    size_t n_compared = compare_with_pydicom(path, set);
    assert_true(n_compared == 7 || n_compared == SIZE_MAX);
    rtstruct_destroy(set);
    if (n_compared == SIZE_MAX)
        skip(); /* no pydicom: everything else passed */
}

/* plastimatch fills a structure set on its images: one NIfTI mask per region. */
static bool run_plastimatch(const char *folder, const char *structures, const char *out_folder)
{
    static char out[1 << 18];
    int status =
        oracle_run((char *[]){ "plastimatch", "convert", "--input", (char *)(uintptr_t)structures, "--referenced-ct",
                               (char *)(uintptr_t)folder, "--output-prefix", (char *)(uintptr_t)out_folder,
                               "--prefix-format", "nii.gz", "--xor-contours", NULL },
                   out, sizeof out);
    return status == 0;
}

static void compare_with_plastimatch(const struct rtstruct *set, const char *out_folder, size_t n_regions,
                                     double least_dice)
{
    size_t n = 0;
    for (size_t i = 0; i < set->n_rois; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s.nii.gz", out_folder, set->rois[i].name);
        if (access(path, R_OK) != 0)
            continue;
        struct volume *reference = read_mask(path);
        struct mask *mask = contours_fill(&set->rois[i].contours, &reference->grid, NULL);
        size_t n_both, n_reference, n_ours = mask_count(mask);
        n_different(mask, reference, &n_both, &n_reference);
        double dice = 2 * (double)n_both / (double)(n_ours + n_reference);
        if (!(dice >= least_dice))
            fail_msg("%s: Dice %.5f, %zu and %zu voxels", set->rois[i].name, dice, n_ours, n_reference);
        mask_destroy(mask);
        volume_unref(reference);
        n++;
    }
    assert_int_equal(n, n_regions);
}

static void plastimatch_fills_the_lung_phantom_voxel_for_voxel(void **state)
{
    (void)state;
    char folder[256], out_folder[256], images[512], structures[512];
    if (!rt_unpack("dicomrt-lung-phantom/lung-2.tar.xz", folder))
        skip();
    folder_make(out_folder);
    snprintf(images, sizeof images, "%s/lung-2", folder);
    snprintf(structures, sizeof structures, "%s/lung-2/rtss.dcm", folder);
    bool is_run = run_plastimatch(images, structures, out_folder);
    if (is_run) {
        struct rtstruct *set = read_real(structures, NULL);
        compare_with_plastimatch(set, out_folder, 3, 1);
        rtstruct_destroy(set);
    }
    folder_remove(folder);
    folder_remove(out_folder);
    if (!is_run)
        skip();
}

/* Its images only: plastimatch refuses the portal images beside them. */
static void plastimatch_fills_the_oncentra_phantom_alike(void **state)
{
    (void)state;
    char folder[512], images[256], out_folder[512], structures[1024], path[1024], out[256];
    if (!data_path("dicomrt-oncentra-phantom", folder, sizeof folder) ||
        !rt_find(folder, "RS", 0, structures, sizeof structures))
        skip();
    folder_make(images);
    for (size_t i = 0; rt_find(folder, "CT", i, path, sizeof path); i++)
        assert_int_equal(oracle_run((char *[]){ "cp", path, images, NULL }, out, sizeof out), 0);
    snprintf(out_folder, sizeof out_folder, "%s/masks", images);
    bool is_run = run_plastimatch(images, structures, out_folder);
    if (is_run) {
        struct rtstruct *set = read_real(structures, NULL);
        /* edges at whole mm on voxels of 0.586 mm: one row more or less */
        compare_with_plastimatch(set, out_folder, 7, 0.99);
        rtstruct_destroy(set);
    }
    folder_remove(images);
    if (!is_run)
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sarcoma_masks_come_out_voxel_for_voxel),
        cmocka_unit_test(the_lung_phantom_has_3_regions_and_29_empty_ones),
        cmocka_unit_test(the_oncentra_phantom_has_7_regions),
        cmocka_unit_test(plastimatch_fills_the_lung_phantom_voxel_for_voxel),
        cmocka_unit_test(plastimatch_fills_the_oncentra_phantom_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
