/* A statement of whom a plan is of: what it changes, and what it never changes. */
#include "core/base/mem.h"
#include "core/plan/fit.h"
#include "core/plan/identity.h"
#include "core/plan/plan.h"
#include "tests/check.h"

static const struct plan_statement one_person = { .kind = STATEMENT_ONE_PERSON, .by = "Anna Weiss", .time_ms = 1 };

static void name_patient(struct plan *plan, const char *id, const char *name)
{
    struct plan_patient *patient = &plan->patients[plan->n_patients++];
    mem_put_text(patient->id, sizeof patient->id, id);
    mem_put_text(patient->name, sizeof patient->name, name);
}

/* Two beams, of one patient each; the treatment plan is of the first. */
static struct plan *plan_of_two(void)
{
    struct plan *plan = plan_create("two");
    name_patient(plan, "12345", "Virtanen^Aino");
    name_patient(plan, "12345", "Virtanen^Aina");
    plan->n_beams = 2;
    plan->beam_origins[1].patient = 1;
    plan->n_treatment_plans = 1;
    report_add(&plan->report, REPORT_WARNING, "patient.several", "", "No patient identity in these files.");
    return plan;
}

static void patients_that_are_one_person_are_of_the_one_that_is_shown(void **state)
{
    struct plan *plan = plan_of_two();
    (void)state;
    assert_true(fit_is_of_other(plan, (struct fit_part){ FIT_BEAM, 1 }));
    plan_state(plan, &one_person, STATEMENT_SAME_FILES);
    assert_int_equal(plan->statement.state, STATEMENT_USED);
    assert_false(fit_is_of_other(plan, (struct fit_part){ FIT_BEAM, 1 }));
    assert_int_equal(plan->n_patients, 2);
    assert_string_equal(plan->report.lines[0].sentence,
                        "This folder's files name several patients. Anna Weiss has stated that they are one person.");
    plan_destroy(plan);
}

static void a_statement_on_other_files_changes_nothing(void **state)
{
    struct plan *plan = plan_of_two();
    (void)state;
    plan_state(plan, &one_person, STATEMENT_OTHER_FILES);
    assert_int_equal(plan->statement.state, STATEMENT_OUTDATED);
    assert_true(fit_is_of_other(plan, (struct fit_part){ FIT_BEAM, 1 }));
    plan_destroy(plan);
}

static void files_that_could_not_be_read_again_change_nothing_and_that_is_said(void **state)
{
    struct plan *plan = plan_of_two();
    (void)state;
    plan_state(plan, &one_person, STATEMENT_FILES_UNREAD);
    assert_int_equal(plan->statement.state, STATEMENT_UNREAD);
    assert_string_equal(statement_state_word(plan->statement.state), "unread");
    assert_true(fit_is_of_other(plan, (struct fit_part){ FIT_BEAM, 1 }));
    assert_string_equal(plan->report.lines[1].code, "patient.statement-unread");
    plan_destroy(plan);
}

static void a_stated_patient_is_shown_where_the_files_name_nobody(void **state)
{
    struct plan_statement statement = { .kind = STATEMENT_IDENTITY, .by = "Anna Weiss" };
    struct plan *plan = plan_create("nameless");
    char masked[IDENTITY_MASK_SIZE];
    (void)state;
    mem_put_text(statement.patient.name, sizeof statement.patient.name, "Morgen^Ottilie");
    mem_put_text(statement.patient.id, sizeof statement.patient.id, "88-50327");
    plan_state(plan, &statement, STATEMENT_SAME_FILES);
    assert_int_equal(plan->statement.state, STATEMENT_USED);
    assert_int_equal(plan_shown_patient(plan), 0);
    assert_string_equal(plan->report.lines[0].code, "patient.stated");
    assert_int_equal(plan->report.lines[0].severity, REPORT_NOTE);
    identity_mask(&plan->patients[0], masked);
    assert_string_equal(masked, "O. M. \u2026327");
    plan_destroy(plan);
}

static void files_that_name_another_patient_win_and_that_is_an_error(void **state)
{
    struct plan_statement statement = { .kind = STATEMENT_IDENTITY, .by = "Anna Weiss" };
    struct plan *plan = plan_of_two();
    (void)state;
    mem_put_text(statement.patient.id, sizeof statement.patient.id, "88-50327");
    plan_state(plan, &statement, STATEMENT_OTHER_FILES);
    assert_int_equal(plan->statement.state, STATEMENT_CONTRADICTED);
    assert_int_equal(plan->n_patients, 2);
    assert_int_equal(plan->report.lines[1].severity, REPORT_ERROR);
    assert_string_equal(plan->report.lines[1].code, "patient.stated-differs");
    statement.patient = plan->patients[1]; /* the very patient: nothing is wrong, but the files say it now */
    plan_state(plan, &statement, STATEMENT_OTHER_FILES);
    assert_int_equal(plan->statement.state, STATEMENT_OUTDATED);
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patients_that_are_one_person_are_of_the_one_that_is_shown),
        cmocka_unit_test(a_statement_on_other_files_changes_nothing),
        cmocka_unit_test(files_that_could_not_be_read_again_change_nothing_and_that_is_said),
        cmocka_unit_test(a_stated_patient_is_shown_where_the_files_name_nobody),
        cmocka_unit_test(files_that_name_another_patient_win_and_that_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
