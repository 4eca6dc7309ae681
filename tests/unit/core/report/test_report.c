/* The report of loading, and the list of its codes. */
#include "core/report/report.h"
#include "core/report/report_codes.h"
#include "tests/check.h"

static void lines_keep_their_order_and_further_ones_are_counted(void **state)
{
    (void)state;
    struct report first = { 0 }, second = { 0 };
    report_add(&first, REPORT_WARNING, "region.empty", "a.nii", "The region \"%s\" has no voxel.", "x");
    for (int i = 0; i < REPORT_MAX + 5; i++)
        report_add(&second, REPORT_NOTE, "region.unnamed", "", "%d", i);
    assert_int_equal(second.n_lines, REPORT_MAX);
    assert_int_equal(second.n_dropped, 5);
    report_move(&first, &second);
    assert_int_equal(first.n_lines, REPORT_MAX);
    assert_int_equal(first.n_dropped, 6);
    assert_int_equal(second.n_lines, 0);
    assert_string_equal(first.lines[0].sentence, "The region \"x\" has no voxel.");
    assert_string_equal(first.lines[0].where, "a.nii");
    assert_string_equal(first.lines[1].sentence, "0");
    assert_string_equal(report_severity_word(first.lines[0].severity), "warning");
    report_finish(&first);
    report_add(NULL, REPORT_NOTE, "region.empty", "", "nobody listens");
}

static void an_error_is_never_lost_among_notes(void **state)
{
    (void)state;
    struct report report = { 0 };
    for (int i = 0; i < REPORT_MAX; i++)
        report_add(&report, i % 2 ? REPORT_NOTE : REPORT_WARNING, "region.unnamed", "", "%d", i);
    report_add(&report, REPORT_ERROR, "region.too-many", "a.dcm", "left out");
    report_add(&report, REPORT_NOTE, "region.unnamed", "", "one more");
    assert_int_equal(report.n_lines, REPORT_MAX);
    assert_int_equal(report.n_dropped, 2);
    assert_string_equal(report.lines[REPORT_MAX - 1].sentence, "left out");
    assert_string_equal(report.lines[REPORT_MAX - 2].sentence, "498"); /* 499, the last note, gave way */
    for (int i = 0; i < REPORT_MAX; i++)
        report_add(&report, REPORT_ERROR, "region.too-many", "a.dcm", "left out %d", i);
    for (int i = 0; i < REPORT_MAX; i++)
        assert_int_equal(report.lines[i].severity, REPORT_ERROR);
    assert_string_equal(report.lines[0].sentence, "left out");
    report_finish(&report);
}

static void a_code_is_there_once_fits_and_says_what_to_do(void **state)
{
    (void)state;
    const struct {
        const char *code, *meaning, *remedy;
    } codes[] = {
#define ROW(code, meaning, remedy) { code, meaning, remedy },
        REPORT_CODES(ROW)
#undef ROW
    };
    size_t n = sizeof codes / sizeof codes[0];
    for (size_t i = 0; i < n; i++) {
        assert_true(strlen(codes[i].code) < sizeof((struct report_line *)0)->code);
        assert_true(strchr(codes[i].code, '.') != NULL);
        assert_true(codes[i].meaning[strlen(codes[i].meaning) - 1] == '.');
        assert_true(codes[i].remedy[strlen(codes[i].remedy) - 1] == '.');
        for (size_t j = 0; j < i; j++)
            assert_string_not_equal(codes[i].code, codes[j].code);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_keep_their_order_and_further_ones_are_counted),
        cmocka_unit_test(an_error_is_never_lost_among_notes),
        cmocka_unit_test(a_code_is_there_once_fits_and_says_what_to_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
