/* RT Plans: the opening of a beam, by jaws, leaves, blocks and applicators. */
#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtplan_opening.h"
#include "tests/check.h"
#include "tests/unit/made_rtplan.h"
#include "tests/unit/plan_help.h"

#define TAG DICOM_TAG

static void jaws_and_leaves(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x00b6));
    made_rt_device(made, "X", NULL, NULL);
    made_rt_device(made, "ASYMY", NULL, NULL);
    made_rt_device(made, "MLCX", NULL, "-20\\-10\\0\\10\\20");
    made_sequence_end(made);
}

static void three_steps(struct made_dicom *made, int point)
{
    if (point == 2)
        return; /* as before */
    made_sequence(made, TAG(0x300a, 0x011a));
    if (point == 0) {
        made_rt_position(made, "X", "-30\\30");
        made_rt_position(made, "ASYMY", "-15\\40");
        made_rt_position(made, "MLCX", "-50\\-5\\-10\\2\\50\\5\\10\\2"); /* the last pair is closed */
    } else {
        made_rt_position(made, "ASYMY", "-5\\12");
        made_rt_position(made, "MLCX", "0\\0\\0\\20\\0\\0\\0\\25");
        made_rt_position(made, "MLCX", "1\\2\\3"); /* too few values: ignored */
    }
    made_sequence_end(made);
}

static void strange_devices(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x00b6));
    for (int i = 0; i < 9; i++)
        made_rt_device(made, "SHUTTER", NULL, NULL);
    made_sequence_end(made);
}

/* Number of report lines with the code. */
static size_t n_lines_of(const struct report *report, const char *code)
{
    size_t n = 0;
    for (size_t i = 0; i < report->n_lines; i++)
        n += strcmp(report->lines[i].code, code) == 0;
    return n;
}

/* A plan of one beam from gantry 0, with these devices and their positions, which may be NULL. */
static struct rtplan *read_opening(int n_points, void (*devices)(struct made_dicom *made),
                                   void (*positions)(struct made_dicom *made, int point), struct report *report)
{
    struct made_rtplan made = { .position = "HFS",
                                .sad = "1000",
                                .iso = "0\\0\\0",
                                .n_points = n_points,
                                .gantries = { "0" },
                                .devices = devices,
                                .positions = positions };
    return made_rtplan_read(&made, report);
}

static void doubts_about_where_a_beam_is_come_before_those_about_its_opening(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct made_rtplan made = { .position = "HFS",
                                .sad = "1000",
                                .iso = "0\\0\\0",
                                .n_points = 3,
                                .gantries = { "450", "460", "470" },
                                .collimator = "361",
                                .table = "362",
                                .devices = strange_devices };
    static const char *const first[] = { "(300A,011E) is 450", "(300A,0122) is 362", "(300A,0120) is 361",
                                         "\"SHUTTER\"",        "\"SHUTTER\"",        "\"SHUTTER\"" };
    enum { N = sizeof first / sizeof first[0] };
    struct rtplan *plan = made_rtplan_read(&made, &report);
    assert_int_equal(n_lines_of(&report, "beam.bad-value"), N + 1);
    size_t at = 0;
    for (size_t i = 0; i < report.n_lines; i++)
        if (strcmp(report.lines[i].code, "beam.bad-value") == 0 && at < N)
            assert_non_null(strstr(report.lines[i].sentence, first[at++]));
    /* six of nine devices, and two more gantry angles */
    assert_non_null(strstr(report.lines[report.n_lines - 1].sentence, "8 more such values"));
    rtplan_destroy(plan);
    report_finish(&report);
}

static void leaves_without_a_number_of_pairs(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x00b6));
    made_rt_device(made, "MLCX", NULL, "-20");
    made_sequence_end(made);
}

static void a_single_boundary_is_too_few_for_any_number_of_leaves(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct rtplan *plan = read_opening(1, leaves_without_a_number_of_pairs, NULL, &report);
    char expected[80];
    snprintf(expected, sizeof expected, "MLCX: leaf position boundaries (300A,00BE) are 1, expected 2 to %d.",
             OPENING_MAX_LEAVES + 1);
    assert_non_null(strstr(report_said(&report, "beam.bad-value"), expected));
    rtplan_destroy(plan);
    report_finish(&report);
}

static void the_opening_is_what_jaws_and_leaves_leave(void **state)
{
    (void)state;
    struct rtplan *plan = read_opening(3, jaws_and_leaves, three_steps, NULL);
    const struct beam_delivery *d = &plan->beams[0].delivery;
    assert_memory_equal(d->jaws_x_mm, ((double[]){ -30, 30 }), sizeof d->jaws_x_mm);
    assert_memory_equal(d->jaws_y_mm, ((double[]){ -15, 40 }), sizeof d->jaws_y_mm);
    /* first: leaves at y -20..-10 open -50..50, limited to x -30..30 and y -15..-10; y -10..0 open 10 wide, y 0..10
     * open 20 wide */
    assert_close(d->opening_cm2, (60 * 5 + 10 * 10 + 20 * 10) / 100.0, 1e-12);
    /* second: only the pair at y 10..20, limited to y 10..12, x 20..25; the hull of both is -30..30 by -15..12 */
    assert_memory_equal(d->opening_x_mm, ((double[]){ -30, 30 }), sizeof d->opening_x_mm);
    assert_memory_equal(d->opening_y_mm, ((double[]){ -15, 12 }), sizeof d->opening_y_mm);
    assert_true(isnan(plan->beams[0].aperture_mm));
    rtplan_destroy(plan);
}

/* Compares one polygon, whatever point it begins with and whichever way it turns. */
static void assert_polygon(const struct beam_outline *outline, size_t polygon, const double (*expected)[2], size_t n)
{
    size_t from = beam_outline_begin(outline, polygon);
    assert_int_equal(outline->ends[polygon] - from, n);
    const float(*found)[2] = outline->points_mm + from;
    for (size_t shift = 0; shift < 2 * n; shift++) {
        bool is_same = true;
        for (size_t i = 0; i < n; i++) {
            const float *at = found[(shift < n ? i + shift : 2 * n - i + shift) % n];
            is_same =
                is_same && fabs((double)at[0] - expected[i][0]) < 1e-4 && fabs((double)at[1] - expected[i][1]) < 1e-4;
        }
        if (is_same)
            return;
    }
    fail_msg("polygon %zu is another, from %g, %g on", polygon, (double)found[0][0], (double)found[0][1]);
}

static void the_outline_follows_jaws_and_leaves_of_the_first_control_point(void **state)
{
    (void)state;
    static const double expected[][2] = {
        { 30, -15 }, { 30, -10 }, { 5, -10 }, { 5, 0 },    { 10, 0 },    { 10, 10 },
        { -10, 10 }, { -10, 0 },  { -5, 0 },  { -5, -10 }, { -30, -10 }, { -30, -15 }
    };
    struct rtplan *plan = read_opening(3, jaws_and_leaves, three_steps, NULL);
    const struct beam_outline *outline = &plan->beams[0].delivery.outline;
    assert_int_equal(outline->kind, BEAM_OUTLINE_LEAVES);
    assert_int_equal(outline->n_polygons, 1);
    assert_polygon(outline, 0, expected, 12);
    rtplan_destroy(plan);
}

static void leaves_along_y(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x00b6));
    made_rt_device(made, "MLCY", NULL, "-30\\-20\\-10\\0\\10\\20\\30");
    made_sequence_end(made);
}

static void apart_and_together(struct made_dicom *made, int point)
{
    (void)point;
    made_sequence(made, TAG(0x300a, 0x011a));
    /* two pairs of the same opening, one that only touches them at its end, a closed one, and two that overlap */
    made_rt_position(made, "MLCY", "-7\\-7\\4\\9\\0\\1\\4\\4\\8\\9\\5\\6");
    made_sequence_end(made);
}

static void openings_that_only_touch_are_polygons_of_their_own(void **state)
{
    (void)state;
    static const double one[][2] = { { -30, -7 }, { -10, -7 }, { -10, 4 }, { -30, 4 } },
                        two[][2] = { { -10, 4 }, { 0, 4 }, { 0, 8 }, { -10, 8 } },
                        three[][2] = { { 10, 0 }, { 20, 0 }, { 20, 1 }, { 30, 1 },
                                       { 30, 6 }, { 20, 6 }, { 20, 5 }, { 10, 5 } };
    struct rtplan *plan = read_opening(1, leaves_along_y, apart_and_together, NULL);
    const struct beam_outline *outline = &plan->beams[0].delivery.outline;
    assert_int_equal(outline->n_polygons, 3);
    assert_polygon(outline, 0, one, 4);
    assert_polygon(outline, 1, two, 4);
    assert_polygon(outline, 2, three, 8);
    rtplan_destroy(plan);
}

static void put_block(struct made_dicom *made, size_t n, double rx, double ry)
{
    double *xy = malloc(2 * n * sizeof *xy);
    assert_non_null(xy);
    for (size_t i = 0; i < n; i++) {
        xy[2 * i] = 3 + rx * cos(2 * MATH_PI * (double)i / (double)n);
        xy[2 * i + 1] = -4 + ry * sin(2 * MATH_PI * (double)i / (double)n);
    }
    made_sequence(made, TAG(0x300a, 0x00f4));
    made_item(made);
    made_text(made, TAG(0x300a, 0x00f8), "CS", "APERTURE");
    made_numbers(made, TAG(0x300a, 0x0106), xy, 2 * n);
    made_item_end(made);
    made_sequence_end(made);
    free(xy);
}

static void round_block(struct made_dicom *made)
{
    put_block(made, 36, 60, 60);
}

static void oval_block(struct made_dicom *made)
{
    put_block(made, 36, 60, 50);
}

static void square_block(struct made_dicom *made)
{
    put_block(made, 4, 60, 60);
}

static void round_applicator(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x0107));
    made_item(made);
    made_sequence(made, TAG(0x300a, 0x0431));
    made_item(made);
    made_text(made, TAG(0x300a, 0x0432), "CS", "SYM_CIRCULAR");
    made_element(made, TAG(0x300a, 0x0433), "FL", &(float){ 120 }, sizeof(float));
    made_item_end(made);
    made_sequence_end(made);
    made_item_end(made);
    made_sequence_end(made);
}

static void jaws_over_a_diamond(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x00b6));
    made_rt_device(made, "X", NULL, NULL);
    made_rt_device(made, "Y", NULL, NULL);
    made_sequence_end(made);
    square_block(made);
}

static void nearer_on_the_right(struct made_dicom *made, int point)
{
    (void)point;
    made_sequence(made, TAG(0x300a, 0x011a));
    made_rt_position(made, "X", "-100\\33");
    made_rt_position(made, "Y", "-100\\100");
    made_sequence_end(made);
}

static void jaws_cut_the_outline_of_a_block(void **state)
{
    (void)state;
    /* the block's corners are 60 mm from (3, -4) along the axes; the right one is cut off 30 mm from the middle */
    static const double expected[][2] = { { 33, -34 }, { 33, 26 }, { 3, 56 }, { -57, -4 }, { 3, -64 } };
    struct rtplan *plan = read_opening(1, jaws_over_a_diamond, nearer_on_the_right, NULL);
    const struct beam_outline *outline = &plan->beams[0].delivery.outline;
    assert_int_equal(outline->kind, BEAM_OUTLINE_BLOCKS);
    assert_int_equal(outline->n_polygons, 1);
    assert_polygon(outline, 0, expected, 5);
    rtplan_destroy(plan);
}

static void block_of_many_points(struct made_dicom *made)
{
    put_block(made, BEAM_OUTLINE_MAX_POINTS, 60, 60);
}

static void a_block_of_too_many_points_has_no_outline_and_says_so(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct rtplan *plan = read_opening(1, block_of_many_points, NULL, &report);
    assert_int_equal(plan->beams[0].delivery.outline.n_polygons, 0);
    assert_int_equal(plan->beams[0].delivery.outline.kind, BEAM_OUTLINE_NONE);
    assert_near(plan->beams[0].aperture_mm, 120, 1e-9);
    assert_non_null(strstr(report_said(&report, "beam.bad-value"), "outline is not shown"));
    rtplan_destroy(plan);
    report_finish(&report);
}

static void only_a_round_opening_has_a_diameter(void **state)
{
    (void)state;
    const struct {
        void (*devices)(struct made_dicom *made);
        double diameter_mm, cm2;
    } cases[] = { { round_block, 120, 36.0 / 2 * 36 * sin(2 * MATH_PI / 36) },
                  { oval_block, NAN, 36.0 / 2 * 30 * sin(2 * MATH_PI / 36) },
                  { square_block, NAN, 72 },
                  { round_applicator, 120, NAN } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct rtplan *plan = read_opening(1, cases[i].devices, NULL, NULL);
        const struct beam *beam = &plan->beams[0];
        if (isnan(cases[i].diameter_mm))
            assert_true(isnan(beam->aperture_mm));
        else
            assert_near(beam->aperture_mm, cases[i].diameter_mm, 1e-9);
        if (!isnan(cases[i].cm2))
            assert_near(beam->delivery.opening_cm2, cases[i].cm2, 1e-6);
        rtplan_destroy(plan);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doubts_about_where_a_beam_is_come_before_those_about_its_opening),
        cmocka_unit_test(a_single_boundary_is_too_few_for_any_number_of_leaves),
        cmocka_unit_test(the_opening_is_what_jaws_and_leaves_leave),
        cmocka_unit_test(the_outline_follows_jaws_and_leaves_of_the_first_control_point),
        cmocka_unit_test(openings_that_only_touch_are_polygons_of_their_own),
        cmocka_unit_test(jaws_cut_the_outline_of_a_block),
        cmocka_unit_test(a_block_of_too_many_points_has_no_outline_and_says_so),
        cmocka_unit_test(only_a_round_opening_has_a_diameter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
