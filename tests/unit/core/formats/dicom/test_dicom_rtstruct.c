/* RT Structure Sets: made-up ones for every trap. */
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

#define RTSTRUCT "1.2.840.10008.5.1.4.1.1.481.3"
#define TAG DICOM_TAG

static void put_roi(struct made_dicom *made, int number, const char *name, const char *frame)
{
    made_item(made);
    if (number >= 0)
        made_integer(made, TAG(0x3006, 0x0022), number);
    if (frame)
        made_text(made, TAG(0x3006, 0x0024), "UI", frame);
    if (name)
        made_text(made, TAG(0x3006, 0x0026), "LO", name);
    made_item_end(made);
}

static void begin_contours(struct made_dicom *made, const char *color)
{
    made_item(made);
    if (color)
        made_text(made, TAG(0x3006, 0x002a), "IS", color);
    made_sequence(made, TAG(0x3006, 0x0040));
}

static void put_contour(struct made_dicom *made, const char *type, long n_said, const double *xyz, size_t n_numbers)
{
    made_item(made);
    if (type)
        made_text(made, TAG(0x3006, 0x0042), "CS", type);
    if (n_said >= 0)
        made_integer(made, TAG(0x3006, 0x0046), n_said);
    made_numbers(made, TAG(0x3006, 0x0050), xyz, n_numbers);
    made_item_end(made);
}

static void end_contours(struct made_dicom *made, int number)
{
    made_sequence_end(made);
    if (number >= 0)
        made_integer(made, TAG(0x3006, 0x0084), number);
    made_item_end(made);
}

static const double triangle[] = { 0, 0, 5, 10, 0, 5, 0, 10, 5 };

static size_t n_lines(const struct report *report, const char *code)
{
    size_t n = 0;
    for (size_t i = 0; i < report->n_lines; i++)
        n += strcmp(report->lines[i].code, code) == 0;
    return n;
}

static struct rtstruct *read_made(struct made_dicom *made, struct report *report)
{
    struct rt_file file = rt_file_of(made);
    struct error err = { 0 };
    struct rtstruct *set = rtstruct_read(file.file, "made.dcm", report, &err);
    if (!set)
        fail_msg("%s", err.text);
    rt_file_close(&file);
    made_finish(made);
    return set;
}

static void regions_are_joined_by_number_whatever_their_order(void **state)
{
    (void)state;
    struct made_dicom made;
    made_rt_begin(&made, RTSTRUCT, "RTSTRUCT", "ISO_IR 192");
    made_text(&made, TAG(0x3006, 0x0002), "SH", "Set");
    made_sequence(&made, TAG(0x3006, 0x0020));
    put_roi(&made, 7, "first", "1.2.7");
    put_roi(&made, 3, "second", "1.2.3");
    put_roi(&made, 5, "Hypophyse größer", NULL);
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    begin_contours(&made, "1\\2\\3");
    put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
    put_contour(&made, "CLOSEDPLANAR_XOR", 3, triangle, 9);
    end_contours(&made, 3);
    begin_contours(&made, NULL);
    put_contour(&made, NULL, -1, triangle, 9);
    end_contours(&made, 5);
    begin_contours(&made, "300\\0\\0");
    put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
    end_contours(&made, 7);
    begin_contours(&made, "9\\9\\9"); /* more of the second */
    put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
    end_contours(&made, 3);
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0080));
    made_item(&made);
    made_integer(&made, TAG(0x3006, 0x0084), 3);
    made_text(&made, TAG(0x3006, 0x00a4), "CS", "GTV");
    made_item_end(&made);
    made_sequence_end(&made);
    struct report report = { 0 };
    struct rtstruct *set = read_made(&made, &report);
    assert_int_equal(report.n_lines, 1);
    assert_int_equal(n_lines(&report, "dicom.bad-number"), 1); /* the colour */
    assert_string_equal(set->label, "Set");
    assert_string_equal(set->uid, "1.2.3.4");
    assert_int_equal(set->n_rois, 3);
    assert_string_equal(set->rois[0].name, "first");
    assert_string_equal(set->rois[0].frame_uid, "1.2.7");
    assert_false(set->rois[0].has_color); /* 300 is no byte */
    assert_int_equal(set->rois[0].contours.n_contours, 1);
    assert_string_equal(set->rois[1].name, "second");
    assert_string_equal(set->rois[1].kind, "GTV");
    assert_int_equal(set->rois[1].contours.n_contours, 3);
    assert_true(set->rois[1].has_color);
    assert_memory_equal(set->rois[1].rgb, ((uint8_t[]){ 9, 9, 9 }), 3);
    assert_string_equal(set->rois[2].name, "Hypophyse größer");
    assert_string_equal(set->rois[2].kind, "");
    assert_int_equal(set->rois[2].contours.contours[0].n_points, 3);
    assert_memory_equal(set->rois[2].contours.contours[0].points_lps_mm, triangle, sizeof triangle);
    rtstruct_destroy(set);
    report_finish(&report);
}

static void names_come_in_the_file_s_character_set(void **state)
{
    (void)state;
    static const struct {
        const char *charset, *bytes, *utf8;
    } names[] = { { "ISO_IR 100", "Kiefergef\xe4\xdf", "Kiefergefäß" },
                  { "ISO_IR 144", "\xbe\xdf\xe3\xe5\xde\xdb\xec", "Опухоль" },
                  { "ISO_IR 192", "\xe8\x85\xab\xe7\x98\xa4", "腫瘤" },
                  { "GB18030", "\xd6\xd7\xc1\xf6", "肿瘤" },
                  { "\\ISO 2022 IR 87", "\x1b$B<pag\x1b(B", "腫瘍" },
                  { "ISO 2022 IR 13\\ISO 2022 IR 87", "\xbc\xad\xd6\xb3 \x1b$B<pag\x1b(J", "ｼｭﾖｳ 腫瘍" } };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct made_dicom made;
        made_rt_begin(&made, RTSTRUCT, "RTSTRUCT", names[i].charset);
        made_sequence(&made, TAG(0x3006, 0x0020));
        put_roi(&made, 1, names[i].bytes, NULL);
        made_sequence_end(&made);
        made_sequence(&made, TAG(0x3006, 0x0039));
        begin_contours(&made, NULL);
        put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
        end_contours(&made, 1);
        made_sequence_end(&made);
        struct rtstruct *set = read_made(&made, NULL);
        assert_string_equal(set->rois[0].name, names[i].utf8);
        rtstruct_destroy(set);
    }
}

static void what_cannot_be_filled_or_joined_is_said(void **state)
{
    (void)state;
    struct made_dicom made;
    made_rt_begin(&made, RTSTRUCT, "RTSTRUCT", NULL);
    made_sequence(&made, TAG(0x3006, 0x0020));
    put_roi(&made, 1, "points", NULL);
    put_roi(&made, 2, "empty", NULL);
    put_roi(&made, 2, "twice", NULL);
    put_roi(&made, -1, "no number", NULL);
    put_roi(&made, 4, NULL, NULL);
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    begin_contours(&made, NULL);
    put_contour(&made, "POINT", 1, triangle, 3);
    put_contour(&made, "OPEN_PLANAR", 3, triangle, 9);
    put_contour(&made, "OPEN_NONPLANAR", 3, triangle, 9);
    put_contour(&made, "SPLINE", 3, triangle, 9);
    end_contours(&made, 1);
    begin_contours(&made, NULL);
    put_contour(&made, "CLOSED_PLANAR", 99, triangle, 9); /* says 99 points, has 3 */
    put_contour(&made, "CLOSED_PLANAR", 2, triangle, 8);  /* 2 points and two thirds of another */
    put_contour(&made, "CLOSED_PLANAR", 0, triangle, 0);
    end_contours(&made, 4);
    begin_contours(&made, NULL);
    put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
    end_contours(&made, 77);
    begin_contours(&made, NULL);
    put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
    end_contours(&made, -1);
    made_sequence_end(&made);
    struct report report = { 0 };
    struct rtstruct *set = read_made(&made, &report);
    assert_int_equal(set->n_rois, 2);
    assert_string_equal(set->rois[0].name, "ROI 4");
    assert_int_equal(set->rois[0].contours.n_contours, 2);
    assert_int_equal(set->rois[0].contours.contours[0].n_points, 3);
    assert_int_equal(set->rois[0].contours.contours[1].n_points, 2);
    assert_string_equal(set->rois[1].name, "ROI 77");
    assert_int_equal(n_lines(&report, "region.roi-number"), 4);
    assert_int_equal(n_lines(&report, "region.unnamed"), 1);
    assert_string_equal(report_said(&report, "region.contours-open"),
                        "\"points\" has 1 points and 3 open contours; they enclose nothing and were left out.");
    assert_string_equal(report_said(&report, "region.no-contours"),
                        "2 of 4 regions have no closed contour and are not listed: points, empty.");
    assert_int_equal(n_lines(&report, "region.contours-count"), 2);
    rtstruct_destroy(set);
    report_finish(&report);
}

static void another_object_is_refused(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct made_dicom made;
    made_rt_begin(&made, "1.2.840.10008.5.1.4.1.1.481.2", "RTDOSE", NULL);
    struct rt_file file = rt_file_of(&made);
    assert_null(rtstruct_read(file.file, "a/b.dcm", NULL, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_string_equal(err.text, "a/b.dcm: a DICOM object of modality \"RTDOSE\", expected RTSTRUCT");
    rt_file_close(&file);
    made_finish(&made);
    made_rt_begin(&made, RTSTRUCT, "RTSTRUCT", NULL);
    file = rt_file_of(&made);
    assert_null(rtstruct_read(file.file, "a/b.dcm", NULL, &err));
    assert_string_equal(err.text, "a/b.dcm: no Structure Set ROI Sequence (3006,0020)");
    rt_file_close(&file);
    made_finish(&made);
}

static void regions_beyond_the_limit_are_left_out_and_named(void **state)
{
    (void)state;
    struct made_dicom made;
    char name[20];
    made_rt_begin(&made, RTSTRUCT, "RTSTRUCT", NULL);
    made_sequence(&made, TAG(0x3006, 0x0020));
    for (int i = 0; i < 1100; i++) {
        snprintf(name, sizeof name, "roi %d", i);
        put_roi(&made, i, name, NULL);
    }
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    for (int i = 0; i < 1100; i++) {
        begin_contours(&made, NULL);
        if (i != 3) /* an empty one takes no room */
            put_contour(&made, "CLOSED_PLANAR", 3, triangle, 9);
        end_contours(&made, i);
    }
    made_sequence_end(&made);
    struct report report = { 0 };
    struct rtstruct *set = read_made(&made, &report);
    assert_int_equal(set->n_rois, 1024);
    assert_string_equal(set->rois[1023].name, "roi 1024");
    assert_int_equal(n_lines(&report, "region.too-many"), 1);
    for (size_t i = 0; i < report.n_lines; i++)
        if (strcmp(report.lines[i].code, "region.too-many") == 0) {
            assert_int_equal(report.lines[i].severity, REPORT_ERROR);
            assert_non_null(strstr(report.lines[i].sentence, "75 were left out: roi 1025, roi 1026"));
        }
    rtstruct_destroy(set);
    report_finish(&report);
}

static void a_contour_that_goes_round_twice_is_taken_once(void **state)
{
    (void)state;
    static const double twice[] = { 0, 0, 5, 10, 0, 5, 0, 10, 5, 0, 0, 5, 10, 0, 5, 0, 10.01, 5 };
    struct made_dicom made;
    made_rt_begin(&made, RTSTRUCT, "RTSTRUCT", NULL);
    made_sequence(&made, TAG(0x3006, 0x0020));
    put_roi(&made, 1, "x", NULL);
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    begin_contours(&made, NULL);
    put_contour(&made, "CLOSED_PLANAR", 6, twice, 18);
    end_contours(&made, 1);
    made_sequence_end(&made);
    struct report report = { 0 };
    struct rtstruct *set = read_made(&made, &report);
    assert_int_equal(set->rois[0].contours.contours[0].n_points, 3);
    assert_int_equal(n_lines(&report, "region.contours-left-out"), 1);
    rtstruct_destroy(set);
    report_finish(&report);
}

static void a_frame_of_reference_that_is_missing_or_another_is_said(void **state)
{
    (void)state;
    struct rtstruct_roi rois[] = { { .name = "a", .frame_uid = "1.2" },
                                   { .name = "b", .frame_uid = "1.3" },
                                   { .name = "c" } };
    struct rtstruct set = { .rois = rois, .n_rois = 3 };
    struct report report = { 0 };
    rtstruct_check_frame(&set, "1.2", "rs.dcm", &report);
    assert_int_equal(report.n_lines, 2);
    assert_string_equal(report_said(&report, "region.no-frame"),
                        "The regions name no frame of reference, so nothing says that 1 regions fit "
                        "the image: c. They are shown where their coordinates are.");
    assert_string_equal(
        report_said(&report, "region.frame-differs"),
        "1 regions were drawn in another frame of reference than the image's and may be shifted against it: b.");
    report_finish(&report);
    rtstruct_check_frame(&set, "", "rs.dcm", &report);
    assert_int_equal(report.n_lines, 1);
    report_finish(&report);
    set.n_rois = 1;
    rtstruct_check_frame(&set, "1.2", "rs.dcm", &report);
    assert_int_equal(report.n_lines, 0);
    report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regions_are_joined_by_number_whatever_their_order),
        cmocka_unit_test(names_come_in_the_file_s_character_set),
        cmocka_unit_test(what_cannot_be_filled_or_joined_is_said),
        cmocka_unit_test(another_object_is_refused),
        cmocka_unit_test(regions_beyond_the_limit_are_left_out_and_named),
        cmocka_unit_test(a_contour_that_goes_round_twice_is_taken_once),
        cmocka_unit_test(a_frame_of_reference_that_is_missing_or_another_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
