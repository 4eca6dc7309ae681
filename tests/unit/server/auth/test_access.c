/* Rights: grants, tokens, owners and rooms, and every route and right by the ten kinds of caller. What each
 * kind may do stands here by right, as the hospital's table of roles has it; which right a route needs comes from
 * proto/. */
#include <time.h>

#include "core/base/mem.h"
#include "server/auth/access.h"
#include "tests/check.h"

static const struct access_line lines[] = {
    { "/plans/granted * observer", "beamroomd.conf", 3 },
    { "/plans/granted @tumour-board reviewer", "beamroomd.conf", 4 },
    { "/plans/granted/ petra presenter", "beamroomd.conf", 5 },
    { "\t/plans/granted  paul   planner+identity ", "beamroomd.conf", 6 },
    { "uploads paul planner", "beamroomd.conf", 7 },
    { "* ada admin", "beamroomd.conf", 8 },
    { "/plans/with spaces in it rolf reviewer", "beamroomd.conf", 9 },
    { "pulls @physics planner", "beamroomd.conf", 10 },
};
enum { N_LINES = sizeof lines / sizeof lines[0] };

static struct access *granted_access(void)
{
    struct access *access = access_create();
    struct error err = { 0 };
    if (!access_set(access, lines, N_LINES, &err))
        fail_msg("%s", err.text);
    return access;
}

static struct identity person(const char *user, const char *group)
{
    struct identity identity = { .source = IDENTITY_PASSWORD, .scopes = IDENTITY_SCOPE_ALL, .n_groups = group != NULL };
    mem_put_text(identity.user, sizeof identity.user, user);
    if (group)
        mem_put_text(identity.groups[0], sizeof identity.groups[0], group);
    return identity;
}

static struct access_subject plan_in(const char *folder)
{
    return (struct access_subject){ .kind = ACCESS_SUBJECT_KIND_PLAN, .folder = folder };
}

static enum access_role role_in(const char *user, const char *group, const char *folder)
{
    struct access *access = granted_access();
    const struct identity identity = person(user, group);
    const struct access_subject subject = plan_in(folder);
    const enum access_role role = access_role_on(access, &identity, &subject);
    access_destroy(access);
    return role;
}

static void the_highest_role_of_all_lines_that_match_counts(void **state)
{
    (void)state;
    assert_int_equal(role_in("olga", NULL, "/plans/granted/head-1"), ACCESS_ROLE_OBSERVER);
    assert_int_equal(role_in("rita", "tumour-board", "/plans/granted/head-1"), ACCESS_ROLE_REVIEWER);
    assert_int_equal(role_in("petra", "tumour-board", "/plans/granted/head-1"), ACCESS_ROLE_PRESENTER);
    assert_int_equal(role_in("paul", NULL, "/plans/granted/head-1"), ACCESS_ROLE_PLANNER);
    assert_int_equal(role_in("ada", NULL, "/plans/granted/head-1"), ACCESS_ROLE_ADMIN);
    assert_int_equal(role_in("rolf", NULL, "/plans/with spaces in it/a"), ACCESS_ROLE_REVIEWER);
}

static void a_folder_is_granted_with_what_is_below_it_and_nothing_beside_it(void **state)
{
    (void)state;
    assert_int_equal(role_in("paul", NULL, "/plans/granted"), ACCESS_ROLE_PLANNER);
    assert_int_equal(role_in("paul", NULL, "/plans/granted/a/b"), ACCESS_ROLE_PLANNER);
    assert_int_equal(role_in("paul", NULL, "/plans/granted-too/a"), ACCESS_ROLE_NONE);
    assert_int_equal(role_in("paul", NULL, "/plans"), ACCESS_ROLE_NONE);
    assert_int_equal(role_in("paul", NULL, "/other/plans/granted/a"), ACCESS_ROLE_NONE);
    assert_int_equal(role_in("paul", NULL, NULL), ACCESS_ROLE_NONE);
}

static void a_group_is_no_user_and_a_user_no_group(void **state)
{
    (void)state;
    assert_int_equal(role_in("tumour-board", NULL, "/plans/granted/a"), ACCESS_ROLE_OBSERVER);
    assert_int_equal(role_in("x", "petra", "/plans/granted/a"), ACCESS_ROLE_OBSERVER);
    assert_int_equal(role_in("x", "ada", "/plans/other"), ACCESS_ROLE_NONE);
    assert_int_equal(role_in("*", "*", "/plans/other"), ACCESS_ROLE_NONE);
    assert_int_equal(role_in("", NULL, "/plans/granted/a"),
                     ACCESS_ROLE_NONE); /* a session without a user is nobody's */
}

static void what_a_line_may_not_be_is_said_with_its_place_and_changes_nothing(void **state)
{
    (void)state;
    static const struct {
        const char *value, *sentence;
    } wrong[] = {
        { "", "a.conf, line 7: grant = , expected FOLDER WHO ROLE" },
        { "ann reviewer", "a.conf, line 7: grant = ann reviewer, expected FOLDER WHO ROLE" },
        { "/plans ann boss",
          "a.conf, line 7: the role is \"boss\", expected observer, reviewer, presenter, planner or admin, with "
          "+identity behind it or not" },
        { "/plans ann none",
          "a.conf, line 7: the role is \"none\", expected observer, reviewer, presenter, planner or admin, with "
          "+identity behind it or not" },
        { "/plans ann +identity",
          "a.conf, line 7: the role is \"+identity\", expected observer, reviewer, presenter, planner or admin, with "
          "+identity behind it or not" },
        { "plans ann reviewer",
          "a.conf, line 7: the folder is \"plans\", expected an absolute path, uploads, pulls or *" },
        { "/plans @ reviewer",
          "a.conf, line 7: who is \"@\", expected a user, @group, or * for whoever has signed in" },
        { "/plans a* reviewer",
          "a.conf, line 7: who is \"a*\", expected a user, @group, or * for whoever has signed in" },
    };
    struct access *access = granted_access();
    const struct identity ada = person("ada", NULL);
    const struct access_subject subject = plan_in("/plans/x");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct error err = { 0 };
        const struct access_line both[] = { lines[0], { wrong[i].value, "a.conf", 7 } };
        assert_false(access_set(access, both, 2, &err));
        assert_string_equal(err.text, wrong[i].sentence);
        assert_int_equal(access_role_on(access, &ada, &subject), ACCESS_ROLE_ADMIN);
    }
    struct access_line many[ACCESS_MAX_GRANTS + 1];
    for (size_t i = 0; i < ACCESS_MAX_GRANTS + 1; i++)
        many[i] = (struct access_line){ "/plans ann reviewer", "a.conf", (int)i + 1 };
    struct error err = { 0 };
    assert_false(access_set(access, many, ACCESS_MAX_GRANTS + 1, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_true(access_set(access, many, ACCESS_MAX_GRANTS, &err));
    assert_int_equal(access_role_on(access, &ada, &subject), ACCESS_ROLE_NONE); /* replaced as a whole */
    access_destroy(access);
}

static bool may(const struct access *access, const struct identity *identity, enum access_right right,
                const struct access_subject *subject)
{
    return access_check(access, identity, right, subject);
}

static void identities_of_patients_are_granted_apart_from_roles(void **state)
{
    (void)state;
    struct access *access = granted_access();
    const struct identity paul = person("paul", NULL), ada = person("ada", NULL);
    struct access_subject here = plan_in("/plans/granted/a"), upload = plan_in("/data/plans/u");
    upload.is_upload = true;
    assert_true(may(access, &paul, ACCESS_IDENTITY, &here));
    assert_false(may(access, &paul, ACCESS_IDENTITY, &upload)); /* planner there, without +identity */
    assert_false(may(access, &ada, ACCESS_IDENTITY, &here));
    upload.owner = "ada";
    assert_false(may(access, &ada, ACCESS_IDENTITY, &upload)); /* nor as its owner */
    access_destroy(access);
}

static void a_token_is_held_to_its_scopes_and_folders(void **state)
{
    (void)state;
    struct access *access = granted_access();
    struct identity token = person("paul", NULL);
    const struct access_subject here = plan_in("/plans/granted/a"), below = plan_in("/plans/granted/board/a");
    token.source = IDENTITY_TOKEN;
    token.scopes = IDENTITY_SCOPE_READ;
    assert_true(may(access, &token, ACCESS_LOOK, &here));
    assert_false(may(access, &token, ACCESS_NOTE, &here));
    assert_false(may(access, &token, ACCESS_PLAN, &here));
    token.scopes = IDENTITY_SCOPE_PLAN;
    assert_true(may(access, &token, ACCESS_LOOK, &here)); /* who may change may read */
    assert_true(may(access, &token, ACCESS_PLAN, &here));
    token.scopes = 0;
    assert_false(may(access, &token, ACCESS_LOOK, &here));
    assert_false(may(access, &token, ACCESS_SIGNED_IN, &(struct access_subject){ 0 }));
    token.scopes = IDENTITY_SCOPE_READ;
    mem_put_text(token.folders, sizeof token.folders, "uploads\n/plans/granted/board/\n");
    assert_false(may(access, &token, ACCESS_LOOK, &here));
    assert_true(may(access, &token, ACCESS_LOOK, &below));
    struct access_subject upload = plan_in("/data/plans/u");
    upload.is_upload = true;
    assert_true(may(access, &token, ACCESS_LOOK, &upload));
    upload.is_upload = false;
    assert_false(may(access, &token, ACCESS_LOOK, &upload));
    access_destroy(access);
}

static void a_closed_room_lets_in_whom_it_knows_and_administrators(void **state)
{
    (void)state;
    struct access *access = granted_access();
    const struct identity paul = person("paul", NULL), ada = person("ada", NULL), nobody = { 0 };
    struct access_subject room = { .kind = ACCESS_SUBJECT_KIND_ROOM, .folder = "/plans/granted/a", .is_closed = true };
    assert_false(may(access, &paul, ACCESS_LOOK, &room));
    assert_true(may(access, &ada, ACCESS_CONTROL, &room));
    room.is_closed = false;
    assert_true(may(access, &paul, ACCESS_CONTROL, &room));
    assert_false(may(access, &nobody, ACCESS_LOOK, &room));
    room.is_closed = true;
    room.room_role = ACCESS_ROLE_REVIEWER; /* by the seat's secret, or by name */
    assert_true(may(access, &paul, ACCESS_NOTE, &room));
    assert_false(may(access, &paul, ACCESS_CONTROL, &room));
    assert_true(may(access, &nobody, ACCESS_NOTE, &room));
    assert_false(may(access, &nobody, ACCESS_EXPORT, &room));
    access_destroy(access);
}

static void a_seat_in_a_room_shows_its_plan_and_gives_no_more_of_it(void **state)
{
    (void)state;
    struct access *access = granted_access();
    const struct identity nobody = { 0 };
    struct access_subject plan = plan_in("/plans/other/a");
    plan.room_role = ACCESS_ROLE_PRESENTER;
    for (int right = ACCESS_SIGNED_IN; right < ACCESS_N_RIGHTS; right++)
        assert_int_equal(may(access, &nobody, (enum access_right)right, &plan),
                         right == ACCESS_LOOK || right == ACCESS_MEASURE);
    access_destroy(access);
}

/* ---- the matrix ---- */

enum { OWN, GRANTED, FOREIGN, N_SUBJECTS };
enum kind { NOBODY, OBSERVER, REVIEWER, PRESENTER, PLANNER, ADMIN, GUEST, WALL, TOKEN_READ, TOKEN_PLAN, N_KINDS };
#define BIT(right) (1U << ACCESS_##right)
enum {
    ANYBODY = BIT(FREE),
    EACH = ANYBODY | BIT(SIGNED_IN),
    OF_OBSERVER = EACH | BIT(LOOK),
    OF_REVIEWER = OF_OBSERVER | BIT(MEASURE) | BIT(EXPORT) | BIT(POINT) | BIT(NOTE) | BIT(SCENE) | BIT(MEET),
    OF_PRESENTER = OF_REVIEWER | BIT(CONTROL),
    OF_PLANNER = OF_PRESENTER | BIT(CLOSE) | BIT(PLAN),
    OF_ADMIN = OF_PLANNER | BIT(SERVE),
    OF_READER = OF_OBSERVER | BIT(MEASURE) | BIT(EXPORT)
};
/* The rights of each kind on what it made itself, on what was granted to it, and on the rest. Administrators are so
 * everywhere. Own of a guest and a wall: their room; a guest takes no files away and makes no rooms. */
static const unsigned rights_of[N_KINDS][N_SUBJECTS] = {
    [NOBODY] = { ANYBODY, ANYBODY, ANYBODY },
    [OBSERVER] = { OF_PLANNER, OF_OBSERVER, EACH },
    [REVIEWER] = { OF_PLANNER, OF_REVIEWER, EACH },
    [PRESENTER] = { OF_PLANNER, OF_PRESENTER, EACH },
    [PLANNER] = { OF_PLANNER, OF_PLANNER, EACH },
    [ADMIN] = { OF_ADMIN, OF_ADMIN, OF_ADMIN },
    [GUEST] = { ANYBODY | BIT(LOOK) | BIT(MEASURE) | BIT(POINT) | BIT(NOTE) | BIT(SCENE), ANYBODY, ANYBODY },
    [WALL] = { ANYBODY | BIT(LOOK), ANYBODY, ANYBODY },
    [TOKEN_READ] = { OF_READER, OF_READER, EACH },
    [TOKEN_PLAN] = { OF_PLANNER, OF_PLANNER, EACH },
};
static const struct access_line roles[] = {
    { "/granted olga observer", "m", 1 },
    { "/granted rita reviewer", "m", 2 },
    { "/granted petra presenter", "m", 3 },
    { "/granted paul planner", "m", 4 },
    { "* ada admin", "m", 5 },
};

static struct identity caller(enum kind kind)
{
    static const char *const users[N_KINDS] = { "", "olga", "rita", "petra", "paul", "ada", "", "", "paul", "paul" };
    struct identity identity = person(users[kind], NULL);
    if (users[kind][0] == 0)
        identity = (struct identity){ .source = IDENTITY_NOBODY };
    if (kind == TOKEN_READ || kind == TOKEN_PLAN) {
        identity.source = IDENTITY_TOKEN;
        identity.scopes = kind == TOKEN_READ ? IDENTITY_SCOPE_READ : IDENTITY_SCOPE_PLAN;
    }
    return identity;
}

static struct access_subject subject_for(const struct access_route *route, enum kind kind, int which,
                                         const struct identity *identity)
{
    struct access_subject subject = { .kind = route->subject };
    if (route->subject == ACCESS_SUBJECT_KIND_NONE || route->subject == ACCESS_SUBJECT_KIND_SERVER)
        return subject;
    subject.folder = which == GRANTED ? "/granted/a" : "/elsewhere/a";
    if (which == OWN && (kind == GUEST || kind == WALL))
        subject.room_role = kind == GUEST ? ACCESS_ROLE_REVIEWER : ACCESS_ROLE_OBSERVER;
    else if (which == OWN)
        subject.owner = identity->user;
    return subject;
}

/* Cells of the matrix of this row that are not as the table above has it for the right that the row should need. */
static size_t wrong_cells(const struct access *access, const struct access_route *row, enum access_right should_need)
{
    size_t n_wrong = 0;
    for (int kind = 0; kind < N_KINDS; kind++)
        for (int which = 0; which < N_SUBJECTS; which++) {
            const struct identity identity = caller((enum kind)kind);
            const struct access_subject subject = subject_for(row, (enum kind)kind, which, &identity);
            const bool is_server = row->subject == ACCESS_SUBJECT_KIND_SERVER;
            unsigned allowed = rights_of[kind][is_server ? FOREIGN : which];
            if (row->subject != ACCESS_SUBJECT_KIND_ROOM && (kind == GUEST || kind == WALL))
                allowed &= ANYBODY | BIT(LOOK) | BIT(MEASURE);
            n_wrong += access_check(access, &identity, row->right, &subject) != ((allowed >> should_need & 1) == 1);
        }
    return n_wrong;
}

static struct access *access_of_roles(void)
{
    struct access *access = access_create();
    struct error err = { 0 };
    assert_true(access_set(access, roles, sizeof roles / sizeof roles[0], &err));
    return access;
}

static void every_route_answers_the_ten_kinds_of_caller_as_the_table_of_roles_has_it(void **state)
{
    (void)state;
    struct access *access = access_of_roles();
    size_t n = 0;
    for (const struct access_route *row = access_routes; row->method; row++, n++)
        if (wrong_cells(access, row, row->right) > 0)
            fail_msg("%s %s: %zu cells are wrong", row->method, row->path, wrong_cells(access, row, row->right));
    assert_true(n > 90);
    access_destroy(access);
}

static void a_route_that_lost_its_check_is_found_in_the_matrix(void **state)
{
    (void)state;
    struct access *access = access_of_roles();
    for (const struct access_route *row = access_routes; row->method; row++) {
        struct access_route changed = *row;
        changed.right = ACCESS_FREE;
        if (row->right != ACCESS_FREE)
            assert_true(wrong_cells(access, &changed, row->right) > 0);
    }
    access_destroy(access);
}

static void the_machines_one_person_may_do_everything_also_without_grants(void **state)
{
    (void)state;
    const struct identity machine = { .source = IDENTITY_MACHINE };
    for (const struct access_route *row = access_routes; row->method; row++)
        assert_true(access_check(NULL, &machine, row->right, &(struct access_subject){ .kind = row->subject }));
    const struct identity someone = person("ada", NULL);
    const struct access_subject plan = plan_in("/plans/a");
    assert_false(access_check(NULL, &someone, ACCESS_LOOK, &plan));
}

static void a_check_against_all_lines_there_may_be_takes_few_microseconds(void **state)
{
    (void)state;
    enum { N = 2000 };
    static char texts[ACCESS_MAX_GRANTS][80];
    struct access_line many[ACCESS_MAX_GRANTS];
    for (size_t i = 0; i < ACCESS_MAX_GRANTS; i++) {
        (void)snprintf(texts[i], sizeof texts[i], "/plans/of/the/clinic/%zu @group-of-the-clinic-%zu planner", i % 4,
                       i);
        many[i] = (struct access_line){ texts[i], "m", (int)i };
    }
    struct access *access = access_create();
    struct error err = { 0 };
    assert_true(access_set(access, many, ACCESS_MAX_GRANTS, &err));
    struct identity identity = person("paul", NULL);
    for (identity.n_groups = 0; identity.n_groups < IDENTITY_MAX_GROUPS; identity.n_groups++)
        (void)snprintf(identity.groups[identity.n_groups], sizeof identity.groups[0], "group-of-the-hospital-%zu",
                       identity.n_groups);
    const struct access_subject plan = plan_in("/plans/of/the/clinic/3/head-1");
    const double before_s = cpu_s();
    for (int i = 0; i < N; i++)
        assert_false(access_check(access, &identity, ACCESS_LOOK, &plan));
    const double each_us = 1e6 * (cpu_s() - before_s) / N;
    print_message("%.2f us a check, %d lines, %d groups\n", each_us, ACCESS_MAX_GRANTS, IDENTITY_MAX_GROUPS);
    assert_true(each_us < 250); /* 5 us in the release build; a sanitizer on a busy machine takes its time */
    access_destroy(access);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_highest_role_of_all_lines_that_match_counts),
        cmocka_unit_test(a_folder_is_granted_with_what_is_below_it_and_nothing_beside_it),
        cmocka_unit_test(a_group_is_no_user_and_a_user_no_group),
        cmocka_unit_test(what_a_line_may_not_be_is_said_with_its_place_and_changes_nothing),
        cmocka_unit_test(identities_of_patients_are_granted_apart_from_roles),
        cmocka_unit_test(a_token_is_held_to_its_scopes_and_folders),
        cmocka_unit_test(a_closed_room_lets_in_whom_it_knows_and_administrators),
        cmocka_unit_test(a_seat_in_a_room_shows_its_plan_and_gives_no_more_of_it),
        cmocka_unit_test(every_route_answers_the_ten_kinds_of_caller_as_the_table_of_roles_has_it),
        cmocka_unit_test(a_route_that_lost_its_check_is_found_in_the_matrix),
        cmocka_unit_test(the_machines_one_person_may_do_everything_also_without_grants),
        cmocka_unit_test(a_check_against_all_lines_there_may_be_takes_few_microseconds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
