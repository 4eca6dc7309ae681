/* NIfTI as a pair of header and voxels, .hdr and .img: as nibabel reads them, named either way, and found in a folder.
 */
#include "core/load/nifti_parts.h"
#include "core/load/summary.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/oracle.h"
#include "tests/unit/plan_help.h"

static const double rows[3][4] = { { -2, 0, 0, 10 },
                                   { 0, -3, 0, 20 },
                                   { 0, 0, 4, 30 } }; /* RAS: an index grows to left, to the back, up */

/* 3 x 2 x 2 voxels 0..11 as head and voxels of their own; packed when their names say so. */
static void put_pair(const char *folder, const char *head_name, const char *voxels_name, const char *magic, int highest)
{
    struct nifti_bytes file = nifti_bytes_make(3, 2, 2, 2, 8, 12, false);
    nifti_put_sform(&file, rows);
    nifti_put_f32(&file, 108, 0); /* voxels begin at byte 0 of their file */
    memcpy(file.data + 344, magic, 4);
    for (int i = 0; i < 12; i++)
        file.data[352 + i] = (uint8_t)(i % (highest + 1));
    struct bytes head = nifti_bytes_pack(file.data, 348), voxels = nifti_bytes_pack(file.data + 352, 12);
    if (head_name && strstr(head_name, ".gz"))
        folder_put(folder, head_name, head.data, head.size);
    else if (head_name)
        folder_put(folder, head_name, file.data, 348);
    if (voxels_name && strstr(voxels_name, ".gz"))
        folder_put(folder, voxels_name, voxels.data, voxels.size);
    else if (voxels_name)
        folder_put(folder, voxels_name, file.data + 352, 12);
    bytes_free(&head);
    bytes_free(&voxels);
    nifti_bytes_free(&file);
}

static void put_plan(const char *folder, const char *path)
{
    char text[300];
    snprintf(text, sizeof text, "{\"format\": \"beamroom-plan\", \"version\": 1, \"images\": [{\"path\": \"%s\"}]}",
             path);
    folder_put_text(folder, "plan.json", text);
}

static void a_pair_opens_by_either_name_packed_or_not(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        { "a.hdr", "a.img" }, { "a.hdr.gz", "a.img.gz" }, { "a.hdr", "a.img.gz" }, { "A.HDR", "A.IMG" }
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        for (int named = 0; named < 2; named++) {
            char folder[256];
            struct error err;
            folder_make(folder);
            put_pair(folder, pairs[i][0], pairs[i][1], "ni1", 11);
            put_plan(folder, pairs[i][named]);
            struct plan *plan = plan_of_folder(folder, &err);
            assert_string_equal(err.text, "");
            const struct volume *volume = plan->images[0].volume;
            assert_int_equal(volume->grid.size[0], 3);
            assert_int_equal(volume->grid.size[2], 2);
            /* index (2, 1, 1) by hand: RAS 10 - 2 * 2, 20 - 3, 30 + 4, so LPS -6, -17, 34; stored 2 + 3 * (1 + 2) = 11
             */
            struct vec3 point = affine_point(&volume->grid.lps_mm_from_ijk, vec3(2, 1, 1));
            assert_point(point, -6, -17, 34, 1e-6);
            assert_close(volume_value(volume, 2, 1, 1), 11, 0);
            assert_false(report_has(&plan->report, "image.bytes-behind"));
            plan_destroy(plan);
            struct plan_summary summary;
            plan_summarize(folder, &summary);
            assert_true(summary.is_readable);
            folder_remove(folder);
        }
}

static void pairs_of_a_folder_are_found_once_each(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_pair(folder, "mr.hdr", "mr.img", "ni1", 11);
    put_pair(folder, "mr.hdr.gz", NULL, "ni1", 11);
    put_pair(folder, "tumour_seg.hdr", "tumour_seg.img.gz", "ni1", 2);
    put_pair(folder, NULL, "lost.img", "ni1", 11);
    folder_put_text(folder, "tumour_seg.json", "{\"labels\": [{\"value\": 1, \"name\": \"tumour\"}]}");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_images, 1);
    assert_string_equal(plan->images[0].id, "mr");
    assert_int_equal(plan->regions.n_regions, 2);
    assert_int_equal(region_of(plan, "tumour")->n_voxels, 4);
    assert_non_null(strstr(report_said(&plan->report, "plan.ignored-file"), "lost.img: the header"));
    plan_destroy(plan);
    folder_remove(folder);
}

/* files: head, voxels; "" none */
static void expect_refusal(const char *head_name, const char *voxels_name, const char *magic, const char *path,
                           enum error_code code, const char *said)
{
    char folder[256];
    struct error err;
    struct plan_summary summary;
    folder_make(folder);
    put_pair(folder, head_name, voxels_name, magic, 11);
    put_plan(folder, path);
    assert_null(plan_of_folder(folder, &err));
    if (err.code != code || !strstr(err.text, said))
        fail_msg("%s: %s; expected %s with \"%s\"", error_word(err.code), err.text, error_word(code), said);
    plan_summarize(folder, &summary);
    assert_false(summary.is_readable);
    assert_non_null(strstr(summary.reason, said));
    folder_remove(folder);
}

/* Programs disagree on which side of an Analyze picture is left, so it is not guessed. */
static void analyze_7_5_is_refused_with_the_reason(void **state)
{
    (void)state;
    expect_refusal("a.hdr", "a.img", "\0\0\0", "a.hdr", ERROR_UNSUPPORTED, "Analyze 7.5");
    expect_refusal("a.hdr", "a.img", "\0\0\0", "a.img", ERROR_UNSUPPORTED, "does not say which side is left");
    char folder[256]; /* without a plan.json: the reason is the folder's */
    struct error err;
    folder_make(folder);
    put_pair(folder, "a.hdr", "a.img", "\0\0\0", 11);
    assert_null(plan_of_folder(folder, &err));
    assert_non_null(strstr(err.text, "a.hdr: byte 344: found 00 00 00 00, expected \"ni1\": an Analyze 7.5 header"));
    folder_remove(folder);
}

static void half_a_pair_and_a_magic_that_does_not_fit_the_name_are_refused(void **state)
{
    (void)state;
    expect_refusal("a.hdr", NULL, "ni1", "a.hdr", ERROR_NOT_FOUND,
                   "a.hdr: the voxels, the file of the same name with .img or .img.gz, is not there");
    expect_refusal(NULL, "a.img", "ni1", "a.img", ERROR_NOT_FOUND,
                   "a.img: the header, the file of the same name with .hdr or .hdr.gz, is not there");
    expect_refusal("a.hdr", "a.img", "n+1", "a.hdr", ERROR_FORMAT, "follow in the same file");
}

static void voxels_that_do_not_fit_the_header_are_refused_or_said(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t n;
        const char *said; /* of the refusal; NULL: opens, and the report has a line */
    } cases[] = { { "a.img", 11, "a.img: cut short: 11 bytes" },
                  { "a.img.gz", 12, "a.img.gz: byte 0: expected a gzip stream" },
                  { "a.img", 13, NULL } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char folder[256];
        struct error err;
        folder_make(folder);
        put_pair(folder, "a.hdr", NULL, "ni1", 11);
        folder_put(folder, cases[i].name, "abcdefghijklm", cases[i].n);
        put_plan(folder, "a.hdr");
        struct plan *plan = plan_of_folder(folder, &err);
        if (cases[i].said && (plan || !strstr(err.text, cases[i].said)))
            fail_msg("\"%s\" does not say \"%s\"", err.text, cases[i].said);
        if (!cases[i].said)
            assert_non_null(strstr(report_said(&plan->report, "image.bytes-behind"), "1 bytes follow the 12 bytes"));
        plan_destroy(plan);
        folder_remove(folder);
    }
}

/* Slices of DICOM are called .img by some archives. */
static void dicom_that_is_called_img_stays_dicom(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    char bytes[200] = { 0 };
    memcpy(bytes + 128, "DICM", 4);
    folder_make(folder);
    folder_put(folder, "a.img", bytes, sizeof bytes);
    put_plan(folder, "a.img");
    assert_null(plan_of_folder(folder, &err));
    assert_non_null(strstr(err.text, "DICOM"));
    folder_remove(folder);
}

static double next_number(char **rest)
{
    char *word = strtok_r(NULL, " ", rest);
    assert_non_null(word);
    return strtod(word, NULL);
}

static void compare_pair(const char *folder_path, char *line)
{
    char *rest = line;
    const char *name = strtok_r(line, " ", &rest) + strlen(folder_path) + 1;
    struct folder folder;
    struct error err = { 0 };
    assert_true(folder_open(&folder, folder_path, &err));
    struct volume *volume = plan_nifti_read(&folder, name, RAW_IMAGE, NULL, &err);
    folder_close(&folder);
    if (!volume)
        fail_msg("%s", err.text);
    for (int axis = 0; axis < 3; axis++)
        assert_int_equal(volume->grid.size[axis], (int)next_number(&rest));
    for (int column = 0; column < 4; column++) {
        struct vec3 v = column < 3 ? volume->grid.lps_mm_from_ijk.columns[column] : volume->grid.lps_mm_from_ijk.origin;
        assert_close(v.x, next_number(&rest), 1e-4); /* quaternions are 32-bit: 1e-6 of a turn at 200 mm */
        assert_close(v.y, next_number(&rest), 1e-4);
        assert_close(v.z, next_number(&rest), 1e-4);
    }
    double low = next_number(&rest), high = next_number(&rest), tolerance = 1e-6 * fmax(fabs(low), fabs(high));
    assert_close(volume->low, low, tolerance);
    assert_close(volume->high, high, tolerance);
    for (int probe = 0; probe < 5; probe++) {
        uint32_t i = (uint32_t)next_number(&rest), j = (uint32_t)next_number(&rest), k = (uint32_t)next_number(&rest);
        assert_close(volume_value(volume, i, j, k), next_number(&rest), tolerance);
    }
    volume_unref(volume);
}

static void pairs_that_nibabel_wrote_read_as_it_reads_them(void **state)
{
    (void)state;
    enum { MOST = 1 << 18 };
    char folder[256], *out = malloc(MOST);
    assert_non_null(out);
    folder_make(folder);
    int status =
        oracle_run((char *[]){ oracle_python(), "tests/oracle/nifti_values.py", "pairs", folder, NULL }, out, MOST);
    size_t n = 0;
    if (status != ORACLE_MISSING) {
        assert_int_equal(status, 0);
        for (char *line = out, *end; *line; line = end + 1, n++) {
            end = strchr(line, '\n');
            *end = 0;
            compare_pair(folder, line);
        }
    }
    folder_remove(folder);
    free(out);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(n, 40); /* ten types, two byte orders, two versions */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pair_opens_by_either_name_packed_or_not),
        cmocka_unit_test(pairs_of_a_folder_are_found_once_each),
        cmocka_unit_test(analyze_7_5_is_refused_with_the_reason),
        cmocka_unit_test(half_a_pair_and_a_magic_that_does_not_fit_the_name_are_refused),
        cmocka_unit_test(voxels_that_do_not_fit_the_header_are_refused_or_said),
        cmocka_unit_test(dicom_that_is_called_img_stays_dicom),
        cmocka_unit_test(pairs_that_nibabel_wrote_read_as_it_reads_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
