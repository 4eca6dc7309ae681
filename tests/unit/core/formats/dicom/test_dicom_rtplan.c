/* RT Plans: beam directions, by hand geometry for every patient position. */
#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtplan_opening.h"

#include "tests/check.h"
#include "tests/unit/made_rtplan.h"
#include "tests/unit/plan_help.h"

#define TAG DICOM_TAG

static void the_source_is_where_hand_geometry_puts_it(void **state)
{
    (void)state;
    const double l = 1, r = -1, p = 1, a = -1, s = 1, i = -1; /* left, right; posterior, anterior; superior, inferior */
    const struct {
        enum patient_position position;
        double gantry, couch, x, y, z;
    } cases[] = {
        /* gantry at 0 is above the table, at 90 to the right of a person at its foot who looks to the gantry */
        { PATIENT_HFS, 0, 0, 0, a, 0 },
        { PATIENT_HFS, 90, 0, l, 0, 0 },
        { PATIENT_HFS, 180, 0, 0, p, 0 },
        { PATIENT_HFS, 270, 0, r, 0, 0 },
        { PATIENT_HFP, 0, 0, 0, p, 0 },
        { PATIENT_HFP, 90, 0, r, 0, 0 },
        { PATIENT_HFP, 180, 0, 0, a, 0 },
        { PATIENT_HFP, 270, 0, l, 0, 0 },
        { PATIENT_FFS, 0, 0, 0, a, 0 },
        { PATIENT_FFS, 90, 0, r, 0, 0 },
        { PATIENT_FFS, 180, 0, 0, p, 0 },
        { PATIENT_FFS, 270, 0, l, 0, 0 },
        { PATIENT_FFP, 0, 0, 0, p, 0 },
        { PATIENT_FFP, 90, 0, l, 0, 0 },
        { PATIENT_FFP, 180, 0, 0, a, 0 },
        { PATIENT_FFP, 270, 0, r, 0, 0 },
        { PATIENT_HFDR, 0, 0, l, 0, 0 },
        { PATIENT_HFDR, 90, 0, 0, p, 0 },
        { PATIENT_HFDR, 180, 0, r, 0, 0 },
        { PATIENT_HFDR, 270, 0, 0, a, 0 },
        { PATIENT_HFDL, 0, 0, r, 0, 0 },
        { PATIENT_HFDL, 90, 0, 0, a, 0 },
        { PATIENT_HFDL, 180, 0, l, 0, 0 },
        { PATIENT_HFDL, 270, 0, 0, p, 0 },
        { PATIENT_FFDR, 0, 0, l, 0, 0 },
        { PATIENT_FFDR, 90, 0, 0, a, 0 },
        { PATIENT_FFDR, 180, 0, r, 0, 0 },
        { PATIENT_FFDR, 270, 0, 0, p, 0 },
        { PATIENT_FFDL, 0, 0, r, 0, 0 },
        { PATIENT_FFDL, 90, 0, 0, p, 0 },
        { PATIENT_FFDL, 180, 0, l, 0, 0 },
        { PATIENT_FFDL, 270, 0, 0, a, 0 },
        /* the table rotated by 90, counter-clockwise seen from above: its far end, with head or feet, points to that
         * person's left */
        { PATIENT_HFS, 0, 90, 0, a, 0 },
        { PATIENT_HFS, 90, 90, 0, 0, i },
        { PATIENT_HFS, 270, 90, 0, 0, s },
        { PATIENT_HFS, 90, 270, 0, 0, s },
        { PATIENT_FFS, 90, 90, 0, 0, s },
        { PATIENT_HFP, 90, 90, 0, 0, i },
        { PATIENT_FFP, 90, 90, 0, 0, s },
        { PATIENT_HFDR, 90, 90, 0, 0, i },
        { PATIENT_HFS, 90, 180, r, 0, 0 },
    };
    for (size_t at = 0; at < sizeof cases / sizeof cases[0]; at++) {
        struct beam_angles angles = { .gantry_deg = cases[at].gantry, .couch_deg = cases[at].couch };
        assert_point(beam_patient_from_gantry(vec3(0, 0, 1), &angles, cases[at].position), cases[at].x, cases[at].y,
                     cases[at].z, 1e-12);
        angles = (struct beam_angles){ .gantry_deg = cases[at].gantry, .eccentric_deg = cases[at].couch };
        assert_point(beam_patient_from_gantry(vec3(0, 0, 1), &angles, cases[at].position), cases[at].x, cases[at].y,
                     cases[at].z, 1e-12);
    }
}

static void oblique_angles_pitch_and_roll_go_the_right_way(void **state)
{
    (void)state;
    /* gantry at 30 leans to the patient's left: sin 30 left, cos 30 anterior */
    struct beam_angles angles = { .gantry_deg = 30 };
    assert_point(beam_patient_from_gantry(vec3(0, 0, 1000), &angles, PATIENT_HFS), 500, -866.0254038, 0, 1e-6);
    /* the head lifted by 20 degrees comes nearer to the source above */
    angles = (struct beam_angles){ .pitch_deg = 20 };
    assert_point(beam_patient_from_gantry(vec3(0, 0, 1), &angles, PATIENT_HFS), 0, -0.9396926208, 0.3420201433, 1e-9);
    /* rolled by 20 about the axis towards the gantry, the right side goes down: the source sees more of the left
     * side */
    angles = (struct beam_angles){ .roll_deg = 20 };
    assert_point(beam_patient_from_gantry(vec3(0, 0, 1), &angles, PATIENT_HFS), -0.3420201433, -0.9396926208, 0, 1e-9);
    /* the gantry's x axis rotates with it: from the left at 0 to posterior at 90 */
    angles = (struct beam_angles){ .gantry_deg = 90 };
    assert_point(beam_patient_from_gantry(vec3(1, 0, 0), &angles, PATIENT_HFS), 0, 1, 0, 1e-12);
    assert_point(beam_patient_from_gantry(vec3(0, 1, 0), &angles, PATIENT_HFS), 0, 0, 1, 1e-12);
}

static void positions_have_words(void **state)
{
    (void)state;
    enum patient_position position = PATIENT_POSITION_UNKNOWN;
    assert_true(patient_position_from_word("FFDL", &position));
    assert_int_equal(position, PATIENT_FFDL);
    assert_string_equal(patient_position_word(position), "FFDL");
    assert_false(patient_position_from_word("SITTING", &position));
    assert_false(patient_position_from_word("", &position));
}

static void a_neutron_beam_lies_between_source_and_isocentre(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct made_rtplan made = { .position = "FFS",
                                .radiation = "NEUTRON",
                                .sad = "1800",
                                .iso = "10\\-20\\30",
                                .n_points = 1,
                                .gantries = { "270" } };
    struct rtplan *plan = made_rtplan_read(&made, &report);
    assert_int_equal(report.n_lines, 0);
    assert_string_equal(plan->label, "Label");
    assert_int_equal(plan->n_beams, 1);
    const struct beam *beam = &plan->beams[0];
    assert_true(beam->has_delivery);
    assert_string_equal(beam->name, "Front");
    assert_string_equal(beam->delivery.radiation, "NEUTRON");
    assert_int_equal(beam->delivery.patient_position, PATIENT_FFS);
    assert_point(beam->target_lps_mm, 10, -20, 30, 0);
    assert_point(beam->entry_lps_mm, 1810, -20, 30, 1e-9); /* feet first: 270 is the patient's left */
    assert_true(isnan(beam->aperture_mm) && isnan(beam->delivery.jaws_x_mm[0]) && isnan(beam->delivery.opening_cm2));
    assert_string_equal(rtplan_beam_name(plan, 5), "Front");
    assert_null(rtplan_beam_name(plan, 6));
    rtplan_destroy(plan);
}

static void what_a_plan_does_not_say_is_assumed_and_said(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct made_rtplan made = { .iso = "1\\2\\3", .n_points = 1 };
    struct rtplan *plan = made_rtplan_read(&made, &report);
    assert_true(report_has(&report, "beam.position-assumed"));
    assert_true(report_has(&report, "beam.angle-assumed"));
    assert_true(report_has(&report, "beam.distance-assumed"));
    assert_int_equal(report.n_lines, 3);
    assert_point(plan->beams[0].entry_lps_mm, 1, 2 - 1000, 3, 1e-9);
    rtplan_destroy(plan);
    report_finish(&report);
    made = (struct made_rtplan){
        .position = "UPRIGHT", .sad = "-5", .iso = "1\\2\\3", .n_points = 1, .gantries = { "0" }
    };
    plan = made_rtplan_read(&made, &report);
    assert_true(report_has(&report, "beam.position-assumed"));
    assert_true(report_has(&report, "beam.distance-assumed"));
    assert_true(report_has(&report, "beam.bad-value"));
    assert_int_equal(report.n_lines, 3);
    rtplan_destroy(plan);
    report_finish(&report);
}

static void a_beam_that_cannot_be_placed_is_left_out(void **state)
{
    (void)state;
    const struct made_rtplan plans[] = {
        { .position = "HFS", .sad = "1000", .n_points = 1, .gantries = { "0" } },                /* no isocentre */
        { .position = "HFS", .sad = "1000", .iso = "1\\2", .n_points = 1, .gantries = { "0" } }, /* two coordinates */
        { .position = "HFS", .sad = "1000", .iso = "1\\2\\x", .n_points = 1, .gantries = { "0" } },   /* malformed */
        { .position = "HFS", .sad = "1000", .iso = "1\\2\\1e9", .n_points = 1, .gantries = { "0" } }, /* too far */
        { .position = "HFS", .sad = "1000", .iso = "1\\2\\3", .n_points = 0 }, /* no control point */
        { .position = "HFS", .sad = "1000", .iso = "1\\2\\3", .n_points = 1, .gantries = { "0" }, .is_setup = true },
    };
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        struct report report = { 0 };
        struct rtplan *plan = made_rtplan_read(&plans[i], &report);
        assert_int_equal(plan->n_beams, 0);
        assert_int_equal(plan->n_treating, plans[i].is_setup ? 0 : 1); /* it treats all the same */
        assert_true(report_has(&report, "beam.left-out"));
        rtplan_destroy(plan);
        report_finish(&report);
    }
}

static void arcs_travel_in_their_direction(void **state)
{
    (void)state;
    const struct {
        struct made_rtplan plan;
        double stop, travel;
    } cases[] = {
        { { .n_points = 3, .gantries = { "300", "0", "60" }, .directions = { "CW", NULL, "NONE" } }, 60, 120 },
        { { .n_points = 3, .gantries = { "60", "0", "300" }, .directions = { "CC", "CC", "NONE" } }, 300, -120 },
        { { .n_points = 4, .gantries = { "181", "300", "60", "179" }, .directions = { "CW" } }, 179, 358 },
        { { .n_points = 2, .gantries = { "10", "350" } }, 350, -20 },
        { { .n_points = 3, .gantries = { "10", NULL, NULL }, .directions = { "CW" } }, 10, 0 }
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_rtplan made = cases[i].plan;
        made.position = "HFS";
        made.sad = "1000";
        made.iso = "0\\0\\0";
        struct report report = { 0 };
        struct rtplan *plan = made_rtplan_read(&made, &report);
        const struct beam_delivery *d = &plan->beams[0].delivery;
        assert_close(d->gantry_deg, strtod(made.gantries[0], NULL), 0);
        assert_close(d->gantry_stop_deg, cases[i].stop, 0);
        assert_close(d->gantry_travel_deg, cases[i].travel, 1e-9);
        assert_int_equal(d->n_control_points, made.n_points);
        assert_int_equal(report_has(&report, "beam.arc"), cases[i].travel != 0);
        rtplan_destroy(plan);
        report_finish(&report);
    }
}

static void angles_beyond_a_turn_are_taken_without_whole_turns_and_said(void **state)
{
    (void)state;
    static const struct {
        const char *gantry, *collimator, *table, *sentence;
        struct vec3 entry, collimator_x;
    } cases[] = { { "450",
                    "0",
                    "0",
                    "gantry angle (300A,011E) is 450, expected -360 to 360; 90 was taken",
                    { 1000, 0, 0 },
                    { 0, 1, 0 } },
                  { "-450",
                    "0",
                    "0",
                    "gantry angle (300A,011E) is -450, expected -360 to 360; -90 was taken",
                    { -1000, 0, 0 },
                    { 0, -1, 0 } },
                  { "0",
                    "450",
                    "0",
                    "beam limiting device angle (300A,0120) is 450, expected -360 to 360; 90 was taken",
                    { 0, -1000, 0 },
                    { 0, 0, 1 } },
                  { "90",
                    "0",
                    "-630",
                    "patient support angle (300A,0122) is -630, expected -360 to 360; -270 was taken",
                    { 0, 0, -1000 },
                    { 0, 1, 0 } },
                  { "90", "0", "-270", "", { 0, 0, -1000 }, { 0, 1, 0 } } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_rtplan made = { .position = "HFS",
                                    .sad = "1000",
                                    .iso = "0\\0\\0",
                                    .n_points = 1,
                                    .gantries = { cases[i].gantry },
                                    .collimator = cases[i].collimator,
                                    .table = cases[i].table };
        struct report report = { 0 };
        struct rtplan *plan = made_rtplan_read(&made, &report);
        const struct beam *beam = &plan->beams[0];
        const struct vec3 *x = &cases[i].collimator_x;
        assert_point(beam->entry_lps_mm, cases[i].entry.x, cases[i].entry.y, cases[i].entry.z, 1e-9);
        assert_point(beam->delivery.collimator_x_lps, x->x, x->y, x->z, 1e-12);
        assert_int_equal(report.n_lines, cases[i].sentence[0] != 0);
        assert_non_null(strstr(report_said(&report, "beam.bad-value"), cases[i].sentence));
        rtplan_destroy(plan);
        report_finish(&report);
    }
}

static void an_angle_that_is_no_number_is_said_to_be_assumed(void **state)
{
    (void)state;
    static const char *const words[] = { "ninety", "inf", "nan", "1e999" };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        struct made_rtplan made = {
            .position = "HFS", .sad = "1000", .iso = "0\\0\\0", .n_points = 1, .gantries = { words[i] }
        };
        struct report report = { 0 };
        struct rtplan *plan = made_rtplan_read(&made, &report);
        assert_true(report_has(&report, "beam.angle-assumed"));
        assert_point(plan->beams[0].entry_lps_mm, 0, -1000, 0, 1e-9);
        rtplan_destroy(plan);
        report_finish(&report);
    }
}

static void an_ion_plan_has_its_lines_and_says_what_is_not_read(void **state)
{
    (void)state;
    struct made_dicom made;
    struct report report = { 0 };
    struct error err = { 0 };
    made_rt_begin(&made, "1.2.840.10008.5.1.4.1.1.481.8", "RTPLAN", NULL);
    made_sequence(&made, TAG(0x300a, 0x03a2));
    made_item(&made);
    made_text(&made, TAG(0x300a, 0x00c2), "LO", "Protons");
    made_element(&made, TAG(0x300a, 0x030a), "FL", (float[]){ 2000, 2500 }, 8);
    made_sequence(&made, TAG(0x300a, 0x03a4));
    made_rt_device(&made, "X", NULL, NULL);
    made_rt_device(&made, "Y", NULL, NULL);
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x300a, 0x03a8));
    made_item(&made);
    made_sequence(&made, TAG(0x300a, 0x011a));
    made_rt_position(&made, "X", "-30\\40");
    made_rt_position(&made, "Y", "-20\\25");
    made_sequence_end(&made);
    made_text(&made, TAG(0x300a, 0x011e), "DS", "90");
    made_text(&made, TAG(0x300a, 0x012c), "DS", "1\\2\\3");
    made_item_end(&made);
    made_sequence_end(&made);
    made_item_end(&made);
    made_sequence_end(&made);
    struct rt_file file = rt_file_of(&made);
    struct rtplan *plan = rtplan_read(file.file, "ion.dcm", &report, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_beams, 1);
    assert_point(plan->beams[0].target_lps_mm, 1, 2, 3, 0);
    assert_point(plan->beams[0].entry_lps_mm, 2001, 2, 3, 1e-9); /* the patient's left, for the position assumed */
    assert_close(plan->beams[0].delivery.opening_cm2, 7 * 4.5, 1e-9);
    assert_non_null(strstr(report_said(&report, "beam.ion"), "An RT Ion Plan of 1 beams"));
    rtplan_destroy(plan);
    rt_file_close(&file);
    made_finish(&made);
    report_finish(&report);
}

static void another_object_is_refused(void **state)
{
    (void)state;
    struct made_dicom made;
    made_rt_begin(&made, "1.2.840.10008.5.1.4.1.1.481.3", "RTSTRUCT", NULL);
    struct rt_file file = rt_file_of(&made);
    struct error err = { 0 };
    assert_null(rtplan_read(file.file, "x.dcm", NULL, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_string_equal(err.text, "x.dcm: a DICOM object of modality \"RTSTRUCT\", expected RTPLAN");
    rt_file_close(&file);
    made_finish(&made);
}

static void many_leaves(struct made_dicom *made)
{
    made_sequence(made, TAG(0x300a, 0x00b6));
    made_item(made);
    made_text(made, TAG(0x300a, 0x00b8), "CS", "MLCX");
    made_integer(made, TAG(0x300a, 0x00bc), OPENING_MAX_LEAVES + 1);
    made_item_end(made);
    made_sequence_end(made);
}

static void more_than_the_written_limits_is_refused_or_left_out(void **state)
{
    (void)state;
    struct made_rtplan leaves = {
        .position = "HFS", .sad = "1000", .iso = "0\\0\\0", .n_points = 1, .devices = many_leaves
    };
    struct made_dicom made;
    made_rtplan_put(&made, &leaves);
    struct rt_file file = rt_file_of(&made);
    struct error err = { 0 };
    assert_null(rtplan_read(file.file, "x.dcm", NULL, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_string_equal(err.text, "x.dcm: beam \"Front\": a collimator of 401 pairs of leaves; the limit is 400");
    rt_file_close(&file);
    made_finish(&made);

    made_rt_begin(&made, MADE_RTPLAN, "RTPLAN", NULL);
    made_sequence(&made, TAG(0x300a, 0x00b0));
    made_item(&made);
    made_sequence(&made, TAG(0x300a, 0x0111));
    for (int i = 0; i < RTPLAN_MAX_CONTROL_POINTS + 1; i++) {
        made_item(&made);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    made_item_end(&made);
    made_sequence_end(&made);
    file = rt_file_of(&made);
    assert_null(rtplan_read(file.file, "x.dcm", NULL, &err));
    assert_string_equal(err.text, "x.dcm: beam \"Beam 1\" has 5001 control points; the limit is 5000");
    rt_file_close(&file);
    made_finish(&made);

    made_rt_begin(&made, MADE_RTPLAN, "RTPLAN", NULL);
    made_sequence(&made, TAG(0x300a, 0x00b0));
    for (int i = 0; i < RTPLAN_MAX_BEAMS + 3; i++) {
        made_item(&made);
        made_sequence(&made, TAG(0x300a, 0x0111));
        made_item(&made);
        made_text(&made, TAG(0x300a, 0x012c), "DS", "0\\0\\0");
        made_item_end(&made);
        made_sequence_end(&made);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    file = rt_file_of(&made);
    struct report report = { 0 };
    struct rtplan *plan = rtplan_read(file.file, "x.dcm", &report, &err);
    assert_non_null(plan);
    assert_int_equal(plan->n_beams, RTPLAN_MAX_BEAMS);
    assert_int_equal(plan->n_treating, 0); /* not known */
    assert_true(report_has(&report, "beam.left-out"));
    rtplan_destroy(plan);
    report_finish(&report);
    rt_file_close(&file);
    made_finish(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_source_is_where_hand_geometry_puts_it),
        cmocka_unit_test(oblique_angles_pitch_and_roll_go_the_right_way),
        cmocka_unit_test(positions_have_words),
        cmocka_unit_test(a_neutron_beam_lies_between_source_and_isocentre),
        cmocka_unit_test(what_a_plan_does_not_say_is_assumed_and_said),
        cmocka_unit_test(a_beam_that_cannot_be_placed_is_left_out),
        cmocka_unit_test(arcs_travel_in_their_direction),
        cmocka_unit_test(angles_beyond_a_turn_are_taken_without_whole_turns_and_said),
        cmocka_unit_test(an_angle_that_is_no_number_is_said_to_be_assumed),
        cmocka_unit_test(an_ion_plan_has_its_lines_and_says_what_is_not_read),
        cmocka_unit_test(another_object_is_refused),
        cmocka_unit_test(more_than_the_written_limits_is_refused_or_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
