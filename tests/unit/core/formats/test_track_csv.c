/* Tables of particle tracks: what a column means, what is refused and with which words, and that plans keep them. */
#include <stdio.h>

#include "core/formats/track_csv.h"
#include "core/load/load.h"
#include "core/load/write_plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/same_plan.h"

#define HEADER "x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm,class,energy_mev\n"

struct parsed {
    struct track_set set;
    struct report report;
    struct error err;
    bool is_read;
};

static struct parsed parse(const char *text)
{
    struct parsed parsed = { 0 };
    parsed.is_read =
        track_csv_parse((const uint8_t *)text, strlen(text), "t.csv", &parsed.set, &parsed.report, &parsed.err);
    return parsed;
}

static void finish(struct parsed *parsed)
{
    track_set_finish(&parsed->set);
    report_finish(&parsed->report);
}

static void each_column_goes_where_its_name_says_in_lps(void **state)
{
    (void)state;
    struct parsed parsed = parse(HEADER "1,2,3,4,5,6,neutron-low,2.5e-8\n-1,-2,-3,-4,-5,-6,lost,\n"
                                        "0,0,150,0,0,10,beam-line,14.1 # a comment\n");
    assert_string_equal(parsed.err.text, "");
    assert_int_equal(parsed.set.n_segments, 3);
    assert_int_equal(parsed.report.n_lines, 0);
    const struct track_segment *s = parsed.set.segments;
    for (int axis = 0; axis < 3; axis++) {
        assert_close((double)s[0].from_lps_mm[axis], axis + 1, 0);
        assert_close((double)s[0].to_lps_mm[axis], axis + 4, 0);
        assert_close((double)s[1].from_lps_mm[axis], -(axis + 1), 0);
    }
    assert_int_equal(s[0].class, TRACK_NEUTRON_LOW);
    assert_int_equal(s[1].class, TRACK_LOST);
    assert_int_equal(s[2].class, TRACK_BEAM_LINE);
    assert_true(s[0].energy_mev == 2.5e-8F && isnan(s[1].energy_mev) && s[2].energy_mev == 14.1F);
    assert_int_equal(parsed.set.n_of_class[TRACK_LOST], 1);
    finish(&parsed);
}

static void columns_may_stand_in_any_order_quoted_with_others_between_and_with_windows_line_ends(void **state)
{
    (void)state;
    struct parsed parsed =
        parse("\xef\xbb\xbf# made up\r\n\r\nClass, weight ,z1_mm,y1_mm,x1_mm,\"z0_mm\",y0_mm,x0_mm\r\n"
              "gamma-medium,0.5,6,5,4, 3 ,2,\"1\"\r\n");
    assert_string_equal(parsed.err.text, "");
    assert_int_equal(parsed.set.n_segments, 1);
    const struct track_segment *s = parsed.set.segments;
    for (int axis = 0; axis < 3; axis++) {
        assert_close((double)s->from_lps_mm[axis], axis + 1, 0);
        assert_close((double)s->to_lps_mm[axis], axis + 4, 0);
    }
    assert_int_equal(s->class, TRACK_GAMMA_MEDIUM);
    assert_true(isnan(s->energy_mev));
    finish(&parsed);
}

static void a_line_that_is_no_segment_is_left_out_and_named(void **state)
{
    (void)state;
    static const struct {
        const char *line, *why;
    } cases[] = {
        { "1,2,3,4,5,6,proton,\n",
          "2 lines are not segments, the first is line 3: class is none of the classes: 'proton'." },
        { "1,2,x,4,5,6,lost,\n", "2 lines are not segments, the first is line 3: z0_mm is not a number: 'x'." },
        { "1,2,3,4,5,nan,lost,\n", "2 lines are not segments, the first is line 3: z1_mm is not a number: 'nan'." },
        { "1,2,3,4,5,6,lost\n", "2 lines are not segments, the first is line 3: 7 cells instead of 8." },
        { "1,2,3,4,5,6,lost,1,2\n", "2 lines are not segments, the first is line 3: 9 cells instead of 8." },
        { "1,2,3,4,5,6,lost,-1\n",
          "2 lines are not segments, the first is line 3: energy_mev is below 0 or above 1e9: '-1'." },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[400];
        snprintf(text, sizeof text, HEADER "0,0,0,1,1,1,lost,\n%s,,,,,,,\n0,0,0,1,1,2,lost,\n", cases[i].line);
        struct parsed parsed = parse(text);
        assert_true(parsed.is_read);
        assert_int_equal(parsed.set.n_segments, 2);
        assert_string_equal(report_said(&parsed.report, "tracks.bad-lines"), cases[i].why);
        finish(&parsed);
    }
}

static void a_line_longer_than_the_limit_is_not_read_in_part(void **state)
{
    (void)state;
    char text[1200];
    int n = snprintf(text, sizeof text, HEADER "0,0,0,1,1,1,lost,\n0,0,0,1,1,1,lost,1%0600d\n", 0);
    assert_true(n < (int)sizeof text);
    struct parsed parsed = parse(text);
    assert_int_equal(parsed.set.n_segments, 1);
    assert_string_equal(report_said(&parsed.report, "tracks.bad-lines"),
                        "1 lines are not segments, the first is line 3: it is longer than 511 bytes.");
    finish(&parsed);
}

static void segments_without_length_or_beyond_the_room_are_left_out(void **state)
{
    (void)state;
    struct parsed parsed = parse(HEADER "0,0,0,0,0,0,lost,\n0,0,0,1e6,0,0,lost,\n0,0,0,1000001,0,0,lost,\n"
                                        "0,-1e300,0,0,0,0,lost,\n");
    assert_true(parsed.is_read);
    assert_int_equal(parsed.set.n_segments, 1);
    assert_string_equal(report_said(&parsed.report, "tracks.far"),
                        "2 of 4 segments end more than 1000 m away and were left out.");
    assert_string_equal(report_said(&parsed.report, "tracks.zero-length"), "1 segments of no length were left out.");
    finish(&parsed);
}

static void a_table_without_a_column_or_a_segment_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } cases[] = {
        { "", "t.csv: the file is empty" },
        { "x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,class\n1,2,3,4,5,lost\n", "t.csv: the header does not name the column z1_mm" },
        { "x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm\n1,2,3,4,5,6\n", "t.csv: the header does not name the column class" },
        { "x0_mm,x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm,class\n", "t.csv: the header names the column x0_mm twice" },
        { HEADER, "t.csv: not one of 0 lines below the header is a segment" },
        { HEADER "1,2,3\n", "t.csv: not one of 1 lines below the header is a segment: 3 cells instead of 8" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct parsed parsed = parse(cases[i].text);
        assert_false(parsed.is_read);
        assert_int_equal(parsed.err.code, ERROR_FORMAT);
        assert_memory_equal(parsed.err.text, cases[i].said, strlen(cases[i].said));
        finish(&parsed);
    }
    char wide[2 * TRACK_CSV_MAX_COLUMNS + 2] = { 0 }; /* one column more: "a,a, ... ,a" */
    for (int i = 0; i < (int)sizeof wide - 1; i++)
        wide[i] = i % 2 ? ',' : 'a';
    struct parsed parsed = parse(wide);
    assert_int_equal(parsed.err.code, ERROR_LIMIT);
    finish(&parsed);
}

static void a_table_is_recognised_by_its_header(void **state)
{
    (void)state;
    static const char *const tables[] = { HEADER, "# a\n\nclass,x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm" };
    static const char *const others[] = { "", "dose,volume\n1,2\n", "x0_mm,y0_mm,z0_mm\n",
                                          "x0_mm y0_mm z0_mm class\n" };
    for (size_t i = 0; i < 2; i++)
        assert_true(track_csv_looks_like((const uint8_t *)tables[i], strlen(tables[i])));
    for (size_t i = 0; i < 4; i++)
        assert_false(track_csv_looks_like((const uint8_t *)others[i], strlen(others[i])));
}

static struct plan *load(const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    return plan;
}

/* 2 files, one of each format: counts by class and by file, and every number, after conversion. */
static void a_plan_keeps_tracks_with_energies_beside_tracks_without(void **state)
{
    (void)state;
    static const char plan_text[] =
        "{\"format\": \"beamroom-plan\", \"version\": 1,\n"
        "\"beams\": [{\"entry_mm\": [0, 0, 150], \"target_mm\": [0, 0, 0]}],\n"
        "\"tracks\": [{\"path\": \"a.pp\", \"unit\": \"cm\"}, {\"path\": \"b.csv\", \"unit\": \"cm\"}]}";
    char folder[256], out[300];
    struct error err = { 0 };
    folder_make(folder);
    folder_put_text(folder, "plan.json", plan_text);
    folder_put_text(folder, "a.pp", "0 0 0 1 2 3 0 1\n0 0 0 -1 -2 -3 3 0\n");
    folder_put_text(folder, "b.csv",
                    HEADER "0.1,0.2,0.3,1,1,1,neutron-low,2.53e-8\n0,0,0,7,8,9,gamma-low,0.478\n"
                           "0,0,0,7,8,9,gamma-low,\n");
    struct plan *plan = load(folder);
    const struct track_set *tracks = &plan->tracks;
    assert_int_equal(tracks->n_segments, 5);
    assert_int_equal(tracks->n_files, 2);
    assert_string_equal(tracks->files[0].path, "a.pp");
    assert_int_equal(tracks->files[0].n_segments, 2);
    assert_close(tracks->files[0].unit_mm, 10, 0);
    assert_string_equal(tracks->files[1].path, "b.csv");
    assert_int_equal(tracks->files[1].n_segments, 3);
    assert_close(tracks->files[1].unit_mm, 1, 0); /* the columns are in mm, whatever plan.json says */
    assert_string_equal(report_said(&plan->report, "tracks.unit-doubtful"),
                        "The plan says the tracks are in cm, but the columns of the table are in mm; mm was taken.");
    assert_close((double)tracks->segments[0].to_lps_mm[1], -20, 0); /* PA 2 cm is P -20 mm */
    assert_close((double)tracks->segments[3].to_lps_mm[1], 8, 0);
    assert_true(isnan(tracks->segments[0].energy_mev) && tracks->segments[3].energy_mev == 0.478F);
    snprintf(out, sizeof out, "%s/out", folder);
    assert_true(plan_write(plan, out, NULL, &err));
    struct plan *again = load(out);
    assert_same_plan(again, plan, 0);
    plan_destroy(plan);
    plan_destroy(again);
    folder_remove(folder);
}

/* Without plan.json: a .csv of something else is left alone. */
static void a_table_in_a_folder_without_plan_json_becomes_tracks(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    struct grid grid = made_cube_grid(20);
    folder_put_volume(folder, "mr.nii.gz", volume_create(&grid, VOXEL_F32, NULL));
    folder_put_text(folder, "tracks.csv", HEADER "0,0,0,1,2,3,neutron-high,2\n0,0,150,0,0,10,beam-line,\n");
    folder_put_text(folder, "notes.csv", "dose,volume\n1,2\n");
    struct plan *plan = load(folder);
    assert_int_equal(plan->tracks.n_segments, 2);
    assert_int_equal(plan->tracks.n_files, 1);
    assert_int_equal(plan->n_beams, 1); /* from the beam line */
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_column_goes_where_its_name_says_in_lps),
        cmocka_unit_test(columns_may_stand_in_any_order_quoted_with_others_between_and_with_windows_line_ends),
        cmocka_unit_test(a_line_that_is_no_segment_is_left_out_and_named),
        cmocka_unit_test(a_line_longer_than_the_limit_is_not_read_in_part),
        cmocka_unit_test(segments_without_length_or_beyond_the_room_are_left_out),
        cmocka_unit_test(a_table_without_a_column_or_a_segment_is_refused),
        cmocka_unit_test(a_table_is_recognised_by_its_header),
        cmocka_unit_test(a_plan_keeps_tracks_with_energies_beside_tracks_without),
        cmocka_unit_test(a_table_in_a_folder_without_plan_json_becomes_tracks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
