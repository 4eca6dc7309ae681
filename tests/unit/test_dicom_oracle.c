/* All real image series, compared with pydicom and numpy: position and value of every voxel. */
#include "core/load/load.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_series.h"
#include "tests/unit/oracle.h"

static const struct dicom_stack *stack_of(const struct dicom_index *index, const char *series, size_t *at)
{
    for (*at = 0; *at < index->n_stacks; ++*at)
        if (strcmp(index->stacks[*at].series, series) == 0)
            return &index->stacks[*at];
    fail_msg("no stack of the series %s", series);
    return NULL;
}

/* Compares one line of the oracle with our volume of the same series. */
static void compare_series(struct scanned *s, char *line, const char *values_path, double tolerance)
{
    char *rest = line;
    size_t at;
    (void)stack_of(s->index, strtok_r(line, " ", &rest), &at);
    struct volume *volume = scanned_read(s, at);
    const uint32_t *size = volume->grid.size;
    for (int axis = 0; axis < 3; axis++)
        assert_int_equal(size[axis], strtol(strtok_r(NULL, " ", &rest), NULL, 10));
    const struct affine *map = &volume->grid.lps_mm_from_ijk;
    for (int column = 0; column < 4; column++) {
        struct vec3 v = column < 3 ? map->columns[column] : map->origin;
        assert_close(v.x, strtod(strtok_r(NULL, " ", &rest), NULL), 1e-6);
        assert_close(v.y, strtod(strtok_r(NULL, " ", &rest), NULL), 1e-6);
        assert_close(v.z, strtod(strtok_r(NULL, " ", &rest), NULL), 1e-6);
    }
    FILE *values = fopen(values_path, "rb");
    assert_non_null(values);
    double *row = malloc(size[0] * sizeof *row), worst = 0;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++) {
            assert_int_equal(fread(row, sizeof *row, size[0], values), size[0]);
            for (uint32_t i = 0; i < size[0]; i++)
                worst = fmax(worst, fabs(volume_value(volume, i, j, k) - row[i]) / fmax(1, fabs(row[i])));
        }
    assert_close(worst, 0, tolerance);
    free(row);
    fclose(values);
    volume_unref(volume);
}

static void real_series_are_what_pydicom_and_numpy_make_of_them(void **state)
{
    (void)state;
    static const struct {
        const char *archive;
        int n_series;
        double tolerance; /* of a value: 0, or that of 32-bit numbers where slices have different rescales */
    } sets[] = {
        { "dicom-head-phantom/S2010.tar.xz", 1, 0 }, { "dicom-mr-head/VS-SEG-001.tar.xz", 1, 0 },
        { "dicomrt-sts001/CT.tar.xz", 1, 0 },        { "dicomrt-sts001/MR_T1.tar.xz", 1, 0 },
        { "dicomrt-sts001/PET.tar.xz", 1, 1e-7 },    { "dicomrt-lung-phantom/lung-2.tar.xz", 1, 0 },
        { "dicomrt-oncentra-phantom", 1, 0 },
    };
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        char path[1024], out[300], script[] = "tests/oracle/dicom_series.py";
        if (!data_path(sets[i].archive, path, sizeof path))
            skip();
        struct scanned s = { 0 };
        folder_make(s.path);
        bool is_archive = strstr(path, ".tar.xz") != NULL;
        char answer[4096];
        if (is_archive && !oracle_unpack(path, s.path)) {
            folder_remove(s.path);
            skip();
        }
        char own[256];
        folder_make(own);
        snprintf(out, sizeof out, "%s/values", own);
        int status = oracle_run((char *[]){ oracle_python(), script, is_archive ? s.path : path, out, NULL }, answer,
                                sizeof answer);
        if (status == ORACLE_MISSING) {
            folder_remove(own);
            folder_remove(s.path);
            print_message("no pydicom for Python here\n");
            skip();
        }
        assert_int_equal(status, 0);
        if (!is_archive) {
            folder_remove(s.path);
            memcpy(s.path, path, sizeof path);
            s.is_kept = true;
        }
        scanned_open(&s);
        int n = 0;
        for (char *line = answer, *end; (end = strchr(line, '\n')); line = end + 1, n++) {
            char values[320];
            *end = 0;
            snprintf(values, sizeof values, "%s.%d", out, n);
            compare_series(&s, line, values, sets[i].tolerance);
        }
        assert_int_equal(n, sets[i].n_series);
        scanned_finish(&s);
        folder_remove(own);
    }
}

/* pydicom's pixel_array leaves MONOCHROME1 values as stored, and so do we; the plan says that low values are to be
 * white. */
static void an_inverted_series_has_the_values_that_pydicom_reads(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    char own[256], out[300], values[320], answer[4096], script[] = "tests/oracle/dicom_series.py";
    folder_make(s.path);
    folder_make(own);
    snprintf(out, sizeof out, "%s/values", own);
    snprintf(values, sizeof values, "%s.0", out);
    for (int k = 0; k < 3; k++) {
        struct made_slice slice = made_slice_defaults;
        char name[8];
        slice.color = "MONOCHROME1";
        slice.modality = "MR";
        slice.position[2] = 2 * k;
        slice.base = 300 - 100 * k;
        slice.has_rescale = true;
        slice.slope = -0.5; /* the values after it count */
        slice.offset = 7;
        snprintf(name, sizeof name, "%d", k);
        made_slice_put(s.path, name, &slice);
    }
    int status = oracle_run((char *[]){ oracle_python(), script, s.path, out, NULL }, answer, sizeof answer);
    if (status == 0) {
        struct error err = { 0 };
        scanned_open(&s);
        answer[strcspn(answer, "\n")] = 0;
        compare_series(&s, answer, values, 0);
        struct plan *plan = plan_load(s.path, "p", NULL, &err);
        assert_string_equal(err.text, "");
        assert_true(plan->images[0].is_inverted);
        plan_destroy(plan);
        scanned_finish(&s);
    } else {
        folder_remove(s.path);
    }
    folder_remove(own);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(real_series_are_what_pydicom_and_numpy_make_of_them),
        cmocka_unit_test(an_inverted_series_has_the_values_that_pydicom_reads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
