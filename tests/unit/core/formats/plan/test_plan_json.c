/* The reader of plan.json, asked directly: documents made here. */
#include <string.h>

#include "core/formats/plan/plan_json.h"
#include "tests/check.h"
#include "tests/unit/plan_help.h"

static struct plan_file *parse(const char *text, struct report *report, struct error *err)
{
    *err = (struct error){ 0 };
    return plan_file_parse((const uint8_t *)text, strlen(text), report, err);
}

static void keys_are_told_apart_by_the_case_of_their_letters(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct error err;
    struct plan_file *file = parse("{\"format\":\"beamroom-plan\",\"version\":1,\"beams\":[{\"Path\":\"plan.dcm\","
                                   "\"entry_mm\":[0,0,0],\"target_mm\":[0,0,10]}]}",
                                   &report, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(file->n_beams, 1);
    assert_int_equal(file->n_beam_files, 0);
    assert_true(report_has(&report, "plan.unknown-key"));
    plan_file_destroy(file);
    report_finish(&report);
}

static size_t put(char *at, const char *text)
{
    memcpy(at, text, strlen(text) + 1);
    return strlen(text);
}

static void refuses_outline(const char *outline, const char *sentence)
{
    char text[65536];
    struct report report = { 0 };
    struct error err;
    assert_true(snprintf(text, sizeof text,
                         "{\"format\":\"beamroom-plan\",\"version\":1,\"beams\":[{\"entry_mm\":[0,0,0],"
                         "\"target_mm\":[0,0,10],\"delivery\":{\"outline\":%s}}]}",
                         outline) < (int)sizeof text);
    assert_null(parse(text, &report, &err));
    if (!strstr(err.text, sentence))
        fail_msg("%s", err.text);
    report_finish(&report);
}

static void an_outline_has_a_kind_and_polygons_within_its_limits(void **state)
{
    (void)state;
    static char many[65536];
    refuses_outline("[]", "beams[0].outline: expected an object");
    refuses_outline("{}", "expected kind, jaws, leaves or blocks, and polygons_mm");
    refuses_outline("{\"kind\":\"iris\",\"polygons_mm\":[[[0,0],[1,0],[0,1]]]}",
                    "expected kind, jaws, leaves or blocks");
    refuses_outline("{\"kind\":\"jaws\",\"polygons_mm\":[]}", "expected kind, jaws, leaves or blocks");
    refuses_outline("{\"kind\":\"jaws\",\"polygons_mm\":[[[0,0],[1,0]]]}", "a polygon of 2 points");
    refuses_outline("{\"kind\":\"jaws\",\"polygons_mm\":[4]}", "expected polygons");
    refuses_outline("{\"kind\":\"jaws\",\"polygons_mm\":[[[0,0],[1,0],[1]]]}", "points of two numbers");
    refuses_outline("{\"kind\":\"jaws\",\"polygons_mm\":[[[0,0],[1,0],[1,10001]]]}", "at most 10000 mm");
    char *at = many + put(many, "{\"kind\":\"leaves\",\"polygons_mm\":[[[0,0]");
    for (int i = 0; i < BEAM_OUTLINE_MAX_POINTS; i++)
        at += put(at, ",[1,0]");
    (void)put(at, "]]}");
    refuses_outline(many, "more than 1600 points");
    at = many + put(many, "{\"kind\":\"leaves\",\"polygons_mm\":[[[0,0],[1,0],[0,1]]");
    for (int i = 0; i < BEAM_OUTLINE_MAX_POLYGONS; i++)
        at += put(at, ",[[0,0],[1,0],[0,1]]");
    (void)put(at, "]}");
    refuses_outline(many, "more than 400 polygons");
}

#define SERA_BEAM(line) "{\"format\":\"beamroom-plan\",\"version\":1,\"beams\":[{" line "}]}"

static void refuses_beam(const char *text, const char *sentence)
{
    struct report report = { 0 };
    struct error err;
    assert_null(parse(text, &report, &err));
    if (!strstr(err.text, sentence))
        fail_msg("%s", err.text);
    report_finish(&report);
}

static void a_beam_may_be_given_as_on_seras_card(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct error err;
    struct plan_file *file =
        parse(SERA_BEAM("\"sera\":{\"target_cm\":[-3.84,2.49,-6.49],\"z_cm\":4.447918,\"phi_deg\":55,"
                        "\"theta_deg\":-140}"),
              &report, &err);
    assert_string_equal(err.text, "");
    assert_point(file->beams[0].target_lps_mm, 24.9, 38.4, -64.9, 1e-12);
    /* seraMC's own entry at that distance, head1.rst: (-6.182010, 5.281099, -3.938779) cm, as PA, RL, IS */
    assert_point(file->beams[0].entry_lps_mm, 52.81099, 61.82010, -39.38779, 1e-4);
    assert_int_equal(report.n_lines, 0);
    plan_file_destroy(file);
    report_finish(&report);
    refuses_beam(SERA_BEAM("\"sera\":4"), "beams[0].sera: expected an object");
    refuses_beam(SERA_BEAM("\"sera\":{\"target_cm\":[1,2]}"), "three numbers: PA, RL, IS");
    refuses_beam(SERA_BEAM("\"sera\":{\"target_cm\":[1,2,1e5],\"z_cm\":1,\"phi_deg\":1,\"theta_deg\":1}"),
                 "sera.target_cm");
    refuses_beam(SERA_BEAM("\"sera\":{\"target_cm\":[1,2,3],\"z_cm\":0,\"phi_deg\":1,\"theta_deg\":1}"), "sera.z_cm");
    refuses_beam(SERA_BEAM("\"sera\":{\"target_cm\":[1,2,3],\"z_cm\":1,\"phi_deg\":1}"), "sera.theta_deg");
    refuses_beam(SERA_BEAM("\"entry_mm\":[0,0,0],\"sera\":{}"), "one or the other");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_told_apart_by_the_case_of_their_letters),
        cmocka_unit_test(an_outline_has_a_kind_and_polygons_within_its_limits),
        cmocka_unit_test(a_beam_may_be_given_as_on_seras_card),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
