/* The reader of plan.json, asked directly: documents made here. */
#include <string.h>

#include "core/formats/plan_json.h"
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_told_apart_by_the_case_of_their_letters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
