/* Our NIfTI reader against nibabel's: files that it wrote itself, and all real ones there are. */
#include <fcntl.h>
#include <unistd.h>

#include "core/formats/nifti.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

/* Returns the script's output, for the caller to free; NULL: no nibabel here. */
static char *ask(char *const *arguments)
{
    enum { MOST = 1 << 18 };
    char *out = malloc(MOST);
    assert_non_null(out);
    int status = oracle_run(arguments, out, MOST);
    if (status == ORACLE_MISSING) {
        free(out);
        print_message("no nibabel for Python here\n");
        return NULL;
    }
    assert_int_equal(status, 0);
    return out;
}

static double next_number(char **rest)
{
    char *word = strtok_r(NULL, " ", rest);
    assert_non_null(word);
    return strtod(word, NULL);
}

static void compare_file(char *line)
{
    char *rest = line;
    const char *path = strtok_r(line, " ", &rest);
    const char *slash = strrchr(path, '/');
    char folder_path[512];
    struct folder folder;
    struct bytes bytes;
    struct error err = { 0 };
    snprintf(folder_path, sizeof folder_path, "%.*s", (int)(slash - path), path);
    assert_true(folder_open(&folder, folder_path, &err));
    assert_true(folder_read(&folder, slash + 1, UINT32_MAX, UINT64_MAX, &bytes, &err));
    folder_close(&folder);
    struct volume *volume = nifti_read(&bytes, slash + 1, RAW_IMAGE, NULL, &err);
    bytes_free(&bytes);
    if (!volume)
        fail_msg("%s", err.text);
    for (int axis = 0; axis < 3; axis++)
        assert_int_equal(volume->grid.size[axis], (int)next_number(&rest));
    const struct affine *map = &volume->grid.lps_mm_from_ijk;
    for (int column = 0; column < 4; column++) {
        struct vec3 v = column < 3 ? map->columns[column] : map->origin;
        /* the quaternions of NIfTI-1 are 32-bit: 1e-6 of a turn at 200 mm */
        assert_close(v.x, next_number(&rest), 1e-4);
        assert_close(v.y, next_number(&rest), 1e-4);
        assert_close(v.z, next_number(&rest), 1e-4);
    }
    double low = next_number(&rest), high = next_number(&rest);
    double tolerance = 1e-6 * fmax(fabs(low), fabs(high));
    assert_close(volume->low, low, tolerance);
    assert_close(volume->high, high, tolerance);
    for (int probe = 0; probe < 5; probe++) {
        uint32_t i = (uint32_t)next_number(&rest), j = (uint32_t)next_number(&rest), k = (uint32_t)next_number(&rest);
        assert_close(volume_value(volume, i, j, k), next_number(&rest), tolerance);
    }
    volume_unref(volume);
}

static size_t compare_lines(char *out)
{
    size_t n = 0;
    for (char *line = out, *end; *line; line = end + 1, n++) {
        end = strchr(line, '\n');
        assert_non_null(end);
        *end = 0;
        compare_file(line);
    }
    return n;
}

static char *python(void)
{
    char *set = getenv("PYTHON");
    return set ? set : "/usr/bin/python3";
}

static void files_nibabel_wrote_read_as_it_reads_them(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    char *out = ask((char *[]){ python(), "tests/oracle/nifti_values.py", "make", folder, NULL });
    size_t n = out ? compare_lines(out) : 0;
    folder_remove(folder);
    free(out);
    if (!out)
        skip();
    assert_int_equal(n, 40); /* ten types, two byte orders, two versions */
}

static void real_files_read_as_nibabel_reads_them(void **state)
{
    (void)state;
    static const char *const files[] = { "sera-st/ST_mr.nii.gz",
                                         "openkbp-pt99/ct.nii.gz",
                                         "openkbp-pt99/dose.nii.gz",
                                         "gbm-brats2013/brainmask.nii.gz",
                                         "gbm-brats2013/T1c_subtrMeanDivStd.nii.gz",
                                         "glioma-tcga-du7294/flair_brain.nii.gz",
                                         "head-colin27/ch2.nii.gz",
                                         "ct-totalseg/example_ct_sm.nii.gz",
                                         "eclipse-ent-dose/struct/BRAIN.nii.gz" };
    enum { N = sizeof files / sizeof files[0] };
    char paths[N][512];
    char *arguments[N + 3] = { python(), "tests/oracle/nifti_values.py" };
    for (size_t i = 0; i < N; i++) {
        if (!data_path(files[i], paths[i], sizeof paths[i]))
            skip();
        arguments[2 + i] = paths[i];
    }
    char *out = ask(arguments);
    if (!out)
        skip();
    assert_int_equal(compare_lines(out), N);
    free(out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_nibabel_wrote_read_as_it_reads_them),
        cmocka_unit_test(real_files_read_as_nibabel_reads_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
