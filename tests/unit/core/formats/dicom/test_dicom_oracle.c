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

static void hex_of(const char *text, char *hex)
{
    for (; *text; text++, hex += 2)
        (void)snprintf(hex, 3, "%02x", (unsigned)(unsigned char)*text);
}

static void texts_of_all_character_sets_are_what_pydicom_makes_of_them(void **state)
{
    (void)state;
    /* PS3.5: annex H.3 (Japanese), I.2 and I.3 (Korean), J (Chinese), and beside them the sets of
     * single bytes of PS3.3 C.12.1.1.2 with several extensions in one element */
    static const struct {
        char *vr, *sets;
        const char *bytes;
    } cases[] = {
        { "PN", "\\ISO 2022 IR 87",
          "Yamada^Tarou=\x1B$B;3ED\x1B(B^\x1B$BB@O:\x1B(B=\x1B$B$d$^$@\x1B(B^\x1B$B$?$m$&\x1B(B" },
        { "PN", "ISO 2022 IR 13\\ISO 2022 IR 87",
          "\xD4\xCF\xC0\xDE^\xC0\xDB\xB3=\x1B$B;3ED\x1B(J^\x1B$BB@O:\x1B(J=\x1B$B$d$^$@\x1B(J^\x1B$B$?$m$&\x1B(J" },
        { "LO", "ISO 2022 IR 13\\ISO 2022 IR 87", "\xBC\xAD\xD6\xB3 \x1B$B<pag\x1B(J" },
        { "LO", "ISO 2022 IR 13\\ISO 2022 IR 87", "\x1B$B<pag\x1B(J GTV \x1B)I\xBC\xAD" },
        { "LO", "ISO 2022 IR 6\\ISO 2022 IR 87\\ISO 2022 IR 159", "\x1B$B<pag\x1B(B \x1B$(D\x30\x27\x1B(B PTV" },
        { "PN", "\\ISO 2022 IR 149",
          "Hong^Gildong=\x1B$)C\xFB\xF3^\x1B$)C\xD1\xCE\xD4\xD7=\x1B$)C\xC8\xAB^\x1B$)C\xB1\xE6\xB5\xBF" },
        { "LO", "\\ISO 2022 IR 149", "\x1B$)C\xB1\xE6\xB5\xBF GTV\xC8\xAB" },
        { "PN", "ISO_IR 192", "Wang^XiaoDong=\xE7\x8E\x8B^\xE5\xB0\x8F\xE6\x9D\xB1" },
        { "PN", "GB18030", "Wang^XiaoDong=\xCD\xF5^\xD0\xA1\xB6\xAB" },
        { "LO", "GB18030", "\x81\x39\xEF\x30 \xD6\xD7\xC1\xF6 \x83\x5C\x81\x5E" },
        { "LO", "GBK", "\xD6\xD7\xC1\xF6 \x83\x5C\x81\x5E" },
        { "LO", "ISO_IR 100",
          "B\xFC"
          "c^J\xE9r\xF4me" },
        { "LO", "ISO_IR 101",
          "W\xB1"
          "c\xB3"
          "aw" },
        { "LO", "ISO_IR 109", "\xA1o" },
        { "LO", "ISO_IR 110", "\xE3\xF3" },
        { "PN", "ISO_IR 126", "\xC4\xE9\xEF\xED\xF5\xF3\xE9\xEF\xF2" },
        { "PN", "ISO_IR 127", "\xE2\xC8\xC7\xE6\xEA^\xE4\xE6\xD2\xC7\xD1" },
        { "PN", "ISO_IR 138", "\xF9\xF8\xE5\xEF^\xE3\xE1\xE5\xF8\xE4" },
        { "PN", "ISO_IR 144", "\xBB\xEE\xDA\x63\xB5\xDC\xD1\xE3\xE0\xD3" },
        { "LO", "ISO_IR 148",
          "\xC7"
          "avu\xFEo\xF0lu" },
        { "LO", "ISO_IR 166", "\xB9\xD2\xC2" },
        { "LO", "ISO 2022 IR 100\\ISO 2022 IR 144", "Gef\xE4\xDF \x1B-L\xBE\xDF\xE3\xE5 \x1B-A\xE4" },
        { "LO", "ISO 2022 IR 100\\ISO 2022 IR 126\\ISO 2022 IR 87",
          "\xE9 \x1B-F\xC4\xE9\xEF \x1B$B<pag\x1B(B \x1B-A\xE9" },
    };
    enum { N = sizeof cases / sizeof cases[0] };
    static char hex[N][400];
    char *arguments[3 * N + 3] = { oracle_python(), "tests/oracle/dicom_texts.py" }, answer[8192];
    for (size_t i = 0; i < N; i++) {
        hex_of(cases[i].bytes, hex[i]);
        arguments[2 + 3 * i] = cases[i].vr;
        arguments[3 + 3 * i] = cases[i].sets;
        arguments[4 + 3 * i] = hex[i];
    }
    int status = oracle_run(arguments, answer, sizeof answer);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
    char *line = answer;
    for (size_t i = 0; i < N; i++) {
        char *end = strchr(line, '\n'), text[400];
        assert_non_null(end);
        *end = 0;
        struct made_dicom made;
        made_begin(&made, MADE_EXPLICIT);
        made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", cases[i].sets);
        made_text(&made, DICOM_TAG(0x0008, 0x103E), cases[i].vr, cases[i].bytes);
        struct error err = { 0 };
        struct dicom_file *file = dicom_file_parse(made.data, made.size, "made.dcm", DICOM_WHOLE, &err);
        assert_non_null(file);
        assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), text, sizeof text));
        assert_string_equal(text, line);
        assert_false(dicom_text_is_broken(file));
        dicom_file_destroy(file);
        made_finish(&made);
        line = end + 1;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts_of_all_character_sets_are_what_pydicom_makes_of_them),
        cmocka_unit_test(real_series_are_what_pydicom_and_numpy_make_of_them),
        cmocka_unit_test(an_inverted_series_has_the_values_that_pydicom_reads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
