/* Real RT Plans, compared with pydicom and with the entry points and distances of their planning systems. */
#include "core/formats/dicom/dicom_rtplan.h"

#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

static struct rtplan *read_real(const char *path, struct report *report)
{
    struct rt_file file = rt_file_open(path);
    struct error err = { 0 };
    struct rtplan *plan = rtplan_read(file.file, "rp.dcm", report, &err);
    if (!plan)
        fail_msg("%s", err.text);
    rt_file_close(&file);
    return plan;
}

static double next_number(char **rest)
{
    char *end;
    double value = strtod(*rest, &end);
    assert_true(end > *rest && *end == '\t');
    *rest = end + 1;
    return value;
}

static void assert_same(double value, double expected)
{
    if (!(isnan(value) && isnan(expected)))
        assert_close(value, expected, 1e-9);
}

static void assert_word(const char *word, char **rest)
{
    char *tab = strchr(*rest, '\t');
    assert_non_null(tab);
    *tab = 0;
    assert_string_equal(word, *rest);
    *rest = tab + 1;
}

static void compare_beam(const struct beam *beam, char *rest)
{
    const struct beam_delivery *d = &beam->delivery;
    assert_same((double)d->number, next_number(&rest));
    assert_word(beam->name, &rest);
    assert_word(d->radiation, &rest);
    assert_same((double)d->n_control_points, next_number(&rest));
    assert_same(beam->target_lps_mm.x, next_number(&rest));
    assert_same(beam->target_lps_mm.y, next_number(&rest));
    assert_same(beam->target_lps_mm.z, next_number(&rest));
    assert_same(d->gantry_deg, next_number(&rest));
    assert_same(d->gantry_stop_deg, next_number(&rest));
    assert_same(d->collimator_deg, next_number(&rest));
    assert_same(d->couch_deg, next_number(&rest));
    assert_same(d->energy_mev, next_number(&rest));
    assert_same(d->sad_mm, next_number(&rest));
    assert_same(d->ssd_mm, next_number(&rest));
    for (int i = 0; i < 2; i++)
        assert_same(d->jaws_x_mm[i], next_number(&rest));
    for (int i = 0; i < 2; i++)
        assert_same(d->jaws_y_mm[i], next_number(&rest));
    double counted_cm2 =
        next_number(&rest); /* on points half a mm apart: one row of them on either side of each leaf */
    assert_close(d->opening_cm2, counted_cm2, 0.05 + 0.002 * counted_cm2);
    assert_same(d->dose_gy, next_number(&rest));
    assert_same(d->meterset, next_number(&rest));
    assert_same((double)d->n_fractions, next_number(&rest));
    assert_word(patient_position_word(d->patient_position), &rest);
}

/* Counts by pydicom and numpy where jaws and leaves are open, on points half a mm apart: inside our polygons, and
 * nowhere else. */
static bool compare_outlines(const char *path, const struct rtplan *plan)
{
    char folder[256], text_path[300], out[4096];
    folder_make(folder);
    (void)snprintf(text_path, sizeof text_path, "%s/outlines", folder);
    FILE *text = fopen(text_path, "w");
    assert_non_null(text);
    for (size_t b = 0; b < plan->n_beams; b++) {
        const struct beam_outline *outline = &plan->beams[b].delivery.outline;
        for (size_t p = 0; p < outline->n_polygons; p++) {
            fprintf(text, "%lld", (long long)plan->beams[b].delivery.number);
            for (size_t at = beam_outline_begin(outline, p); at < outline->ends[p]; at++)
                fprintf(text, " %.9g %.9g", (double)outline->points_mm[at][0], (double)outline->points_mm[at][1]);
            fprintf(text, "\n");
        }
    }
    assert_int_equal(fclose(text), 0);
    int status = oracle_run((char *[]){ oracle_python(), "tests/oracle/rtplan_outline.py", (char *)(uintptr_t)path,
                                        text_path, NULL },
                            out, sizeof out);
    folder_remove(folder);
    if (status == ORACLE_MISSING)
        return false;
    assert_int_equal(status, 0);
    size_t n = 0;
    for (char *line = out; *line; n++) {
        long number = strtol(line, &line, 10), n_open = strtol(line, &line, 10), n_wrong = strtol(line, &line, 10);
        if (n_wrong != 0 || n_open == 0)
            fail_msg("beam %ld: %ld of %ld open points are wrong", number, n_wrong, n_open);
        line += *line == '\n';
    }
    assert_int_equal(n, plan->n_beams);
    return true;
}

static bool compare_with_pydicom(const char *path, const struct rtplan *plan)
{
    static char out[1 << 16];
    int status =
        oracle_run((char *[]){ oracle_python(), "tests/oracle/dicom_rtplan.py", (char *)(uintptr_t)path, NULL }, out,
                   sizeof out);
    if (status == ORACLE_MISSING)
        return false;
    assert_int_equal(status, 0);
    size_t n = 0;
    for (char *line = out, *end; *line; line = end + 1, n++) {
        end = strchr(line, '\n');
        assert_non_null(end);
        *end = '\t';
        assert_true(n < plan->n_beams);
        compare_beam(&plan->beams[n], line);
    }
    assert_int_equal(n, plan->n_beams);
    return compare_outlines(path, plan);
}

/* The point where the beam axis enters the surface, by the planning system's distance. */
static struct vec3 surface_point(const struct beam *beam)
{
    struct vec3 along = vec3_normalize(vec3_sub(beam->target_lps_mm, beam->entry_lps_mm));
    return vec3_add(beam->entry_lps_mm, vec3_scale(along, beam->delivery.ssd_mm));
}

static void ten_square_fields_come_from_the_front(void **state)
{
    (void)state;
    char path[512];
    if (!data_path("dicomrt-plans/06MV_plan.dcm", path, sizeof path))
        skip();
    struct rtplan *plan = read_real(path, NULL);
    static const double sides_mm[] = { 20, 30, 40, 50, 70, 100, 150, 200, 300, 400 };
    assert_int_equal(plan->n_beams, 10);
    for (int i = 0; i < 10; i++) {
        const struct beam *beam = &plan->beams[i];
        assert_point(beam->entry_lps_mm, 0, -1200, 0, 1e-9);
        assert_point(surface_point(beam), 0, -300, 0, 1e-9); /* the file's own Surface Entry Point */
        assert_close(beam->delivery.jaws_y_mm[1] - beam->delivery.jaws_y_mm[0], sides_mm[i], 1e-9);
        assert_close(beam->delivery.opening_x_mm[1] - beam->delivery.opening_x_mm[0], sides_mm[i], 1e-9);
        assert_close(beam->delivery.opening_y_mm[1] - beam->delivery.opening_y_mm[0], sides_mm[i], 1e-9);
    }
    bool is_compared = compare_with_pydicom(path, plan);
    rtplan_destroy(plan);
    if (!is_compared)
        skip(); /* no pydicom: everything before it passed */
}

static void two_arcs_turn_from_the_left_and_from_the_right(void **state)
{
    (void)state;
    char path[512];
    if (!data_path("dicomrt-plans/vmat_example.dcm", path, sizeof path))
        skip();
    struct report report = { 0 };
    struct rtplan *plan = read_real(path, &report);
    assert_int_equal(plan->n_beams, 2);
    assert_int_equal(plan->beams[0].delivery.n_control_points, 32);
    assert_int_equal(plan->beams[1].delivery.n_control_points, 31);
    assert_point(surface_point(&plan->beams[0]), 51, 0, 0, 1e-9); /* the file's own Surface Entry Points */
    assert_point(surface_point(&plan->beams[1]), -51, 0, 0, 1e-9);
    assert_close(plan->beams[0].delivery.gantry_travel_deg, 60, 1e-9);  /* clockwise from 90 to 150 */
    assert_close(plan->beams[1].delivery.gantry_travel_deg, -60, 1e-9); /* counter-clockwise from 270 to 210 */
    assert_close(plan->target_dose_gy, 1, 0);
    assert_int_equal(plan->n_fractions, 2);
    assert_string_equal(plan->prescription, "Plan: RxA");
    assert_true(report_has(&report, "beam.arc"));
    bool is_compared = compare_with_pydicom(path, plan);
    report_finish(&report);
    rtplan_destroy(plan);
    if (!is_compared)
        skip(); /* no pydicom: everything before it passed */
}

static void the_oncentra_beams_meet_the_body_at_their_distances(void **state)
{
    (void)state;
    char folder[512], path[1024];
    if (!data_path("dicomrt-oncentra-phantom", folder, sizeof folder) || !rt_find(folder, "RP", 0, path, sizeof path))
        skip();
    struct rtplan *plan = read_real(path, NULL);
    assert_int_equal(plan->n_beams, 3);
    assert_string_equal(plan->beams[2].delivery.radiation, "ELECTRON");
    /* the body's outline at z = 0 is the square x -20..30, y -20..30 of the structure set; distances have 2 decimals */
    assert_point(surface_point(&plan->beams[0]), 0.29, -20, 0, 0.011);
    assert_point(surface_point(&plan->beams[1]), 30, 0.59, 0, 0.011);
    assert_point(surface_point(&plan->beams[2]), 0.29, 30, 0, 0.011);
    /* beam 2: gantry 90, collimator 90: the collimator's x axis runs superior, y anterior (gantry x points
     * posterior) */
    assert_point(plan->beams[1].delivery.collimator_x_lps, 0, 0, 1, 1e-12);
    assert_point(plan->beams[1].delivery.collimator_y_lps, 0, -1, 0, 1e-12);
    bool is_compared = compare_with_pydicom(path, plan);
    rtplan_destroy(plan);
    if (!is_compared)
        skip(); /* no pydicom: everything before it passed */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_square_fields_come_from_the_front),
        cmocka_unit_test(two_arcs_turn_from_the_left_and_from_the_right),
        cmocka_unit_test(the_oncentra_beams_meet_the_body_at_their_distances),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
