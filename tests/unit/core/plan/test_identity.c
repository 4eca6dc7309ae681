/* Patients are shown masked, and the first plan is the one that may be used. */
#include "core/plan/identity.h"
#include "tests/check.h"

static void assert_mask(const char *name, const char *id, const char *expected)
{
    struct plan_patient patient = { 0 };
    char found[IDENTITY_MASK_SIZE];
    snprintf(patient.name, sizeof patient.name, "%s", name);
    snprintf(patient.id, sizeof patient.id, "%s", id);
    identity_mask(&patient, found);
    assert_string_equal(found, expected);
}

static void a_name_gives_its_initials(void **state)
{
    (void)state;
    assert_mask("Voss^Anna", "88-20417", "A. V. \u2026417");
    assert_mask("Voss^Anna^Maria^Dr.^MD", "88-20417", "A. M. V. \u2026417");
    assert_mask("voss^anna", "88-20417", "A. V. \u2026417");
    assert_mask("VOSS", "88-20417", "V. \u2026417");
    assert_mask("Anna Voss", "88-20417", "A. V. \u2026417");
    assert_mask("Anna Maria  von Voss ", "88-20417", "A. V. \u2026417"); /* first and last word */
    assert_mask("^Anna", "88-20417", "A. \u2026417");
    assert_mask("Voss^", "88-20417", "V. \u2026417");
    assert_mask("\xc3\x9cnal^\xc3\xa9va", "88-20417", "\xc3\x89. \xc3\x9c. \u2026417"); /* Ünal^éva */
    assert_mask("\xce\xb1^\xd0\xb1", "88-20417", "\xd0\x91. \xce\x91. \u2026417");      /* alpha, be */
    assert_mask("", "88-20417", "\u2026417");
    assert_mask("", "", "\u2026");
    assert_mask("***^--", "", "\u2026");
    assert_mask("(Voss)^'Anna'", "", "A. V.");
}

static void assert_words(const char *name, const char *id, const char *birth, const char *expected)
{
    struct plan_patient patient = { 0 };
    char found[IDENTITY_WORDS_SIZE];
    snprintf(patient.name, sizeof patient.name, "%s", name);
    snprintf(patient.id, sizeof patient.id, "%s", id);
    snprintf(patient.birth_date, sizeof patient.birth_date, "%s", birth);
    identity_words(&patient, found);
    assert_string_equal(found, expected);
}

static void in_full_the_family_stands_first_in_capitals(void **state)
{
    char name[200], id[130];
    (void)state;
    assert_words("Voss^Anna^Maria^Dr.", "88-20417", "19610412", "VOSS, Anna Maria, id 88-20417, born 1961-04-12");
    assert_words("\xc3\x9cnal^\xc3\xa9va=x", "1", "", "\xc3\x9cNAL, \xc3\xa9va, id 1"); /* Ünal^éva */
    assert_words("Anna Voss", "", "1961", "Anna Voss, born 1961");
    assert_words("^Anna", "7", "", "Anna, id 7");
    assert_words("", "7", "", "id 7");
    assert_words("", "", "", "");
    memset(name, 'n', sizeof name - 1);
    memset(id, '7', sizeof id - 1);
    name[sizeof name - 1] = id[sizeof id - 1] = 0;
    struct plan_patient longest = { .birth_date = "19610412" };
    char found[IDENTITY_WORDS_SIZE];
    memcpy(longest.name, name, sizeof longest.name);
    memcpy(longest.id, id, sizeof longest.id);
    identity_words(&longest, found); /* cut, and not beyond its end */
    assert_true(strlen(found) < IDENTITY_WORDS_SIZE);
}

static void the_first_group_with_a_letter_counts(void **state)
{
    (void)state;
    assert_mask("Wang^XiaoDong=\xe7\x8e\x8b^\xe5\xb0\x8f\xe6\x9d\xb1=", "123456", "X. W. \u2026456");
    assert_mask("=\xe7\x8e\x8b^\xe5\xb0\x8f\xe6\x9d\xb1", "123456", "\xe7\x8e\x8b. \xe5\xb0\x8f. \u2026456");
    assert_mask("==\xed\x99\x8d^\xea\xb8\xb8\xeb\x8f\x99", "123456", "\xed\x99\x8d. \xea\xb8\xb8. \u2026456");
    assert_mask("===Voss", "123456", "\u2026456"); /* a name has three groups */
}

static void the_end_of_an_id_is_short_where_the_id_is(void **state)
{
    (void)state;
    static const char *const expected[] = { "A. V.",         "A. V. \u20261", "A. V. \u20262",  "A. V. \u20263",
                                            "A. V. \u20264", "A. V. \u20265", "A. V. \u2026456" };
    for (size_t n = 0; n <= 6; n++) {
        char id[8];
        snprintf(id, sizeof id, "%.*s", (int)n, "123456");
        assert_mask("Voss^Anna", id, expected[n]);
    }
    assert_mask("", "\xe6\x82\xa3\xe8\x80\x85\xe7\x95\xaa\xe5\x8f\xb7\xe4\xb8\x80\xe4\xba\x8c",
                "\u2026\xe5\x8f\xb7\xe4\xb8\x80\xe4\xba\x8c"); /* six ideographs */
}

static void characters_that_are_not_seen_are_no_part_of_it(void **state)
{
    (void)state;
    assert_mask("\xe2\x80\xaeVoss^\xe2\x81\xa6"
                "Anna",
                "88-20417", "A. V. \u2026417"); /* U+202E, U+2066 */
    assert_mask("Voss^Anna",
                "88-20\xe2\x80\xae"
                "417\xe2\x80\x8f",
                "A. V. \u2026417"); /* U+202E, U+200F */
    assert_mask("Voss^Anna", "1\xe2\x80\xae\xe2\x80\xae\xe2\x80\xae\xe2\x80\xae\xe2\x80\xae", "A. V. \u20261");
    assert_mask("\xff\xfeVoss^\xc3", "88-2041\xc3", "V. \u2026041"); /* not UTF-8 */
    assert_mask("\x01^\x7f", "\x02\x03", "\u2026");
}

static void the_longest_mask_fits(void **state)
{
    (void)state;
    struct plan_patient patient = { 0 };
    char found[IDENTITY_MASK_SIZE];
    snprintf(patient.name, sizeof patient.name, "%s", "\xf0\xa0\x80\x80^\xf0\xa0\x80\x80^\xf0\xa0\x80\x80");
    snprintf(patient.id, sizeof patient.id, "%s",
             "\xf0\xa0\x80\x80\xf0\xa0\x80\x80\xf0\xa0\x80\x80\xf0\xa0\x80\x80\xf0\xa0\x80\x80\xf0\xa0\x80\x80");
    identity_mask(&patient, found);
    assert_int_equal(strlen(found), 3 * 6 + 3 + 3 * 4);
}

static int shown_of(const char *const (*plans)[3], size_t n)
{
    struct plan *plan = plan_create("p");
    for (size_t i = 0; i < n; i++) {
        struct treatment_plan *treatment = &plan->treatment_plans[plan->n_treatment_plans++];
        snprintf(treatment->approval, sizeof treatment->approval, "%s", plans[i][0]);
        snprintf(treatment->date, sizeof treatment->date, "%s", plans[i][1]);
        snprintf(treatment->time, sizeof treatment->time, "%s", plans[i][2]);
    }
    int shown = plan_shown_treatment_plan(plan);
    plan_destroy(plan);
    return shown;
}

static void an_approved_plan_is_shown_first_then_the_newest(void **state)
{
    (void)state;
    assert_int_equal(shown_of(NULL, 0), -1);
    static const char *const a[][3] = { { "REJECTED", "20261201", "" },
                                        { "UNAPPROVED", "20261130", "" },
                                        { "APPROVED", "20261101", "" },
                                        { "", "20261129", "" } };
    assert_int_equal(shown_of(a, 4), 2);
    assert_int_equal(shown_of(a, 2), 1);
    static const char *const b[][3] = { { "", "20261101", "0900" }, { "", "20261101", "1000" }, { "", "", "1100" } };
    assert_int_equal(shown_of(b, 3), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_name_gives_its_initials),
        cmocka_unit_test(the_first_group_with_a_letter_counts),
        cmocka_unit_test(the_end_of_an_id_is_short_where_the_id_is),
        cmocka_unit_test(in_full_the_family_stands_first_in_capitals),
        cmocka_unit_test(characters_that_are_not_seen_are_no_part_of_it),
        cmocka_unit_test(the_longest_mask_fits),
        cmocka_unit_test(an_approved_plan_is_shown_first_then_the_newest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
