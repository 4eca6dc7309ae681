/* People of a room: the ones who come in, and the ones who are removed. */
#include "tests/unit/room_set_up.h"

/* Pat is planner, Rae reviewer, Oli observer on the plan; Zoe has no role on it. Two are called Pat. */
static const struct identity pat = { .source = IDENTITY_PASSWORD, .user = "pat", .name = "Pat Lee" },
                             pat_too = { .source = IDENTITY_PROXY, .user = "plee", .name = "Pat Lee" },
                             rae = { .source = IDENTITY_PASSWORD,
                                     .user = "rae",
                                     .name = "Rae",
                                     .groups = { "physics" },
                                     .n_groups = 1 },
                             oli = { .source = IDENTITY_PASSWORD, .user = "oli", .name = "Oli" },
                             zoe = { .source = IDENTITY_PASSWORD, .user = "zoe", .name = "Zoe" },
                             nobody = { .source = IDENTITY_NOBODY };

static bool role_of(const struct identity *who, enum wire_member_role *role)
{
    static const struct {
        const struct identity *who;
        enum wire_member_role role;
    } roles[] = { { &pat, WIRE_MEMBER_ROLE_PLANNER },
                  { &pat_too, WIRE_MEMBER_ROLE_PLANNER },
                  { &rae, WIRE_MEMBER_ROLE_REVIEWER },
                  { &oli, WIRE_MEMBER_ROLE_OBSERVER } };
    for (size_t i = 0; i < sizeof roles / sizeof roles[0]; i++)
        if (strcmp(who->user, roles[i].who->user) == 0) {
            *role = roles[i].role;
            return true;
        }
    return false;
}

/* A room of Pat's, which lets guests in by links that say so. */
static int start(void **state)
{
    (void)state;
    fake_room_start_with(&fake, &(struct room_limits){ .max_members = 8, .admits_guests = true });
    fake_sign_in(&fake, role_of);
    room_set_owner(fake.room, "pat");
    fake_plan_ready(&fake, true);
    return 0;
}
#define PEOPLE_TEST(name) cmocka_unit_test_setup_teardown(name, start, room_end)

static void hello(struct fake_page *page, const struct identity *who, const char *more)
{
    page->identity = who;
    fake_say(&fake, page, "{\"type\":\"hello\",\"protocol\":2%s}", more);
}

static void by_link(struct fake_page *page, const struct identity *who, const char *token)
{
    char more[100];
    (void)snprintf(more, sizeof more, ",\"link\":\"%s\",\"name\":\"Gus\",\"person\":\"p%p\"", token, (void *)page);
    hello(page, who, more);
}

static void make_link(enum wire_member_role role, bool allows_guests, char token[33])
{
    struct problem problem = { 0 };
    const struct room_link wanted = {
        .role = role, .expires_s = 3600, .allows_guests = allows_guests, .maker = "pat", .name = "Thursday"
    };
    assert_true(room_link_make(fake.room, &wanted, fake.now_us, token, &problem));
}

static bool patch(const char *json, struct problem *problem)
{
    cJSON *body = json_read(json, strlen(json), NULL);
    assert_non_null(body);
    const bool is_done = room_people_patch(fake.room, body, &pat, NULL, "", fake.now_us, problem);
    cJSON_Delete(body);
    return is_done;
}

/* A field of the member with this id in the newest list, "" for none; "true" of a bool. */
static const char *of_member(const struct fake_page *page, const char *id, const char *field)
{
    static char text[200];
    cJSON *message = fake_heard(page, "members"), *row;
    text[0] = 0;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(message, "members"))
    {
        if (strcmp(json_text(row, "id"), id) != 0)
            continue;
        const char *value = json_text(row, field);
        (void)snprintf(text, sizeof text, "%s", value ? value : json_flag(row, field, false) ? "true" : "");
    }
    cJSON_Delete(message);
    return text;
}

static const char *me(const struct fake_page *page)
{
    static char id[64];
    (void)snprintf(id, sizeof id, "%s", heard(page, "welcome", "member"));
    return id;
}

static void expect_refused(const struct fake_page *page, const char *code, const char *reason)
{
    assert_true(page->is_closed);
    assert_int_equal(fake_n_heard(page, "welcome"), 0);
    assert_string_equal(heard(page, "bye", "code"), code);
    assert_string_equal(heard(page, "bye", "reason"), reason);
}

/* ---- closed ----------------------------------------------------------------------------------------------------- */

static void a_room_is_closed_to_all_but_its_owner(void **state)
{
    (void)state;
    hello(&ann, &pat, "");
    assert_string_equal(of_member(&ann, me(&ann), "role"), "planner");
    hello(&ben, &rae, "");
    expect_refused(&ben, "", "the room is closed");
    hello(&cem, &pat_too, ""); /* has rights enough on the plan, and was not asked */
    expect_refused(&cem, "", "the room is closed");
    hello(&dee, &nobody, "");
    expect_refused(&dee, "sign-in", "sign in to enter this room");
    assert_true(dee.is_signed_out && !ben.is_signed_out);
}

static void who_is_asked_by_name_or_group_comes_in_with_no_more_than_the_plan_gives(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"@physics\",\"role\":\"presenter\"},{\"who\":\"plee\",\"role\":"
                      "\"reviewer\"},{\"who\":\"zoe\"}]}",
                      &problem));
    hello(&ann, &rae, "");
    assert_string_equal(of_member(&ann, me(&ann), "role"), "reviewer"); /* the plan gives no more */
    hello(&ben, &pat_too, "");
    assert_string_equal(of_member(&ben, me(&ben), "role"), "reviewer"); /* the room gives no more */
    hello(&cem, &zoe, "");
    expect_refused(&cem, "", "the room is closed"); /* has no role on the plan at all */
}

static void an_open_room_lets_in_who_has_a_role_on_the_plan(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"is_open\":true}", &problem));
    hello(&ann, &oli, "");
    assert_string_equal(of_member(&ann, me(&ann), "role"), "observer");
    hello(&ben, &zoe, "");
    expect_refused(&ben, "", "the room is closed");
}

static void people_are_checked_whole(void **state)
{
    static const struct {
        const char *json;
        int type;
    } wrong[] = { { "{\"people\":[{\"who\":\"a b\"}]}", PROBLEM_VALIDATION },
                  { "{\"people\":[{\"who\":\"@\"}]}", PROBLEM_VALIDATION },
                  { "{\"people\":[{\"role\":\"observer\"}]}", PROBLEM_VALIDATION },
                  { "{\"people\":[{\"who\":\"rae\",\"role\":\"wall\"}]}", PROBLEM_VALIDATION },
                  { "{\"people\":[{\"who\":\"rae\",\"more\":1}]}", PROBLEM_VALIDATION },
                  { "{\"people\":\"rae\"}", PROBLEM_VALIDATION },
                  { "{\"is_open\":1}", PROBLEM_VALIDATION },
                  { "{\"owner\":\"rae\"}", PROBLEM_VALIDATION } };
    struct problem problem = { 0 };
    cJSON *before = room_people(fake.room);
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        problem = (struct problem){ 0 };
        assert_false(patch(wrong[i].json, &problem));
        assert_int_equal(problem.type, wrong[i].type);
    }
    cJSON *after = room_people(fake.room);
    assert_true(cJSON_Compare(before, after, true));
    cJSON_Delete(before);
    cJSON_Delete(after);
}

static void a_room_from_before_sign_in_is_open_to_planners_alone(void **state)
{
    (void)state;
    room_set_owner(fake.room, "");
    hello(&ann, &rae, "");
    expect_refused(&ann, "", "the room is closed");
    hello(&ben, &pat_too, "");
    assert_string_equal(of_member(&ben, me(&ben), "role"), "planner");
}

/* ---- names and seats -------------------------------------------------------------------------------------------- */

static void names_come_from_the_sign_in_and_equal_ones_are_told_apart(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"plee\"}]}", &problem));
    hello(&ann, &pat, ",\"name\":\"Professor\"");
    hello(&ben, &pat_too, ",\"name\":\"Professor\"");
    assert_string_equal(heard(&ann, "welcome", "name"), "Pat Lee");
    assert_string_equal(of_member(&ben, "m1", "name"), "Pat Lee");
    assert_string_equal(of_member(&ben, "m1", "user"), "pat");
    assert_string_equal(of_member(&ben, "m2", "user"), "plee");
    assert_string_equal(of_member(&ben, "m2", "is_guest"), "");
}

static void a_seat_is_its_users_alone(void **state)
{
    struct problem problem = { 0 };
    char seat[200];
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"plee\"}]}", &problem));
    hello(&ann, &pat, "");
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    hello(&ben, &pat_too, seat);
    assert_string_equal(heard(&ben, "welcome", "member"), "m2");
    assert_false(ann.is_closed);
    hello(&cem, &nobody, seat);
    expect_refused(&cem, "sign-in", "sign in to enter this room");
    hello(&dee, &pat, seat);
    assert_string_equal(heard(&dee, "welcome", "member"), "m1");
    assert_true(ann.is_closed);
}

static void one_users_tabs_are_one_person(void **state)
{
    (void)state;
    hello(&ann, &pat, ",\"person\":\"one\"");
    hello(&ben, &pat, ",\"person\":\"two\""); /* another browser */
    cJSON *message = fake_heard(&ben, "members");
    assert_int_equal(json_number(cJSON_GetArrayItem(cJSON_GetObjectItem(message, "members"), 0), "tabs", 0), 2);
    cJSON_Delete(message);
}

static void nobody_fills_a_room_alone(void **state)
{
    static struct fake_page tabs[ROOM_MAX_TABS + 1];
    (void)state;
    fake_room_end(&fake);
    fake_room_start_with(&fake, &(struct room_limits){ .max_members = 2 * ROOM_MAX_TABS });
    fake_sign_in(&fake, role_of);
    room_set_owner(fake.room, "pat");
    for (int i = 0; i <= ROOM_MAX_TABS; i++) {
        hello(&tabs[i], &pat, "");
        assert_int_equal(tabs[i].is_closed, i == ROOM_MAX_TABS);
    }
    room_connection_closed(fake.room, &tabs[0], fake.now_us);
    fake_page_end(&tabs[ROOM_MAX_TABS]);
    hello(&tabs[ROOM_MAX_TABS], &pat, "");
    assert_false(tabs[ROOM_MAX_TABS].is_closed);
    room_destroy(fake.room);
    for (int i = 0; i <= ROOM_MAX_TABS; i++)
        fake_page_end(&tabs[i]);
    fake_room_start(&fake, 3);
}

static void strangers_tries_are_a_row_of_the_audit_together(void **state)
{
    (void)state;
    const size_t n_before = fake.n_audited;
    hello(&ann, &nobody, ",\"name\":\"a\"");
    hello(&ben, &nobody, ",\"name\":\"b\"");
    hello(&cem, &nobody, ",\"name\":\"c\"");
    assert_int_equal(fake.n_audited - n_before, 1);
}

static void the_end_of_a_sign_in_keeps_the_seat_and_not_control(void **state)
{
    struct problem problem = { 0 };
    char seat[200];
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"rae\"}]}", &problem));
    hello(&ann, &pat, "");
    hello(&ben, &rae, "");
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    assert_string_equal(of_member(&ben, "m1", "presenting"), "true");
    room_sign_in_over(fake.room, &ann, fake.now_us);
    assert_true(ann.is_signed_out);
    assert_string_equal(heard(&ann, "bye", "code"), "sign-in");
    assert_string_equal(of_member(&ben, "m1", "connected"), "");
    fake.again_us = fake.now_us;
    fake_pass(&fake, ROOM_PRESENTER_KEPT_S * 1000 + 10);
    assert_string_equal(of_member(&ben, "m2", "presenting"), "true"); /* alone there now */
    hello(&cem, &pat, seat);
    assert_string_equal(heard(&cem, "welcome", "member"), "m1");
    assert_string_equal(of_member(&cem, "m2", "presenting"), "true");
    assert_string_equal(of_member(&cem, "m1", "presenting"), "");
}

/* ---- links and guests ------------------------------------------------------------------------------------------- */

static void who_comes_by_an_observers_link_is_an_observer(void **state)
{
    char token[33], seat[200];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, false, token);
    by_link(&ann, &zoe, token);
    assert_string_equal(of_member(&ann, me(&ann), "role"), "observer");
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    hello(&ben, &zoe, seat); /* comes back, and leaves the link away */
    assert_string_equal(of_member(&ben, "m1", "role"), "observer");
    hello(&cem, &zoe, ""); /* the link alone has let them in */
    expect_refused(&cem, "", "the room is closed");
    by_link(&dee, &nobody, token);
    expect_refused(&dee, "sign-in", "sign in to enter this room");
}

static void an_unknown_link_tells_no_more_than_a_closed_room(void **state)
{
    (void)state;
    by_link(&ann, &zoe, "00000000000000000000000000000000");
    expect_refused(&ann, "", "the room is closed");
}

static void a_guest_looks_points_and_writes_as_the_link_says(void **state)
{
    char look[33], note[33];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, look);
    make_link(WIRE_MEMBER_ROLE_PRESENTER, true, note);
    by_link(&ann, &nobody, look);
    by_link(&ben, &nobody, note);
    assert_string_equal(of_member(&ben, "m1", "is_guest"), "true");
    assert_string_equal(of_member(&ben, "m1", "name"), "Gus");
    assert_string_equal(of_member(&ben, "m2", "role"), "reviewer"); /* a guest is never more */
    assert_string_equal(of_member(&ben, "m2", "presenting"), "");
    fake_say(&fake, &ann, "{\"type\":\"pointer\",\"view\":0,\"point_mm\":[1,2,3]}");
    assert_int_equal(fake_n_heard(&ann, "problem"), 0);
    fake_say(&fake, &ann, "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"x\"}}");
    assert_string_equal(refused(&ann), "403 ");
    fake_say(&fake, &ben, "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"x\"}}");
    assert_int_equal(fake_n_heard(&ben, "problem"), 0);
    fake_say(&fake, &ben, "{\"type\":\"present\"}");
    assert_string_equal(refused(&ben), "403 ");
    fake_say(&fake, &ben, "{\"type\":\"control.request\"}");
    assert_int_equal(fake_n_heard(&ben, "problem"), 2);
}

static void a_guest_comes_back_by_its_seat_while_guests_may(void **state)
{
    char token[33], seat[200];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
    by_link(&ann, &nobody, token);
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    hello(&ben, &nobody, seat);
    assert_string_equal(of_member(&ben, "m1", "is_guest"), "true");
    hello(&cem, &rae, seat); /* who has signed in is nobody's guest */
    expect_refused(&cem, "", "the room is closed");
}

static void a_wall_looks_has_no_name_in_attendance_and_no_seat(void **state)
{
    char token[33];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_WALL, false, token);
    hello(&ann, &pat, "");
    char more[100];
    (void)snprintf(more, sizeof more, ",\"link\":\"%s\"", token);
    hello(&ben, &nobody, more);
    assert_string_equal(of_member(&ann, "m2", "role"), "wall");
    assert_string_equal(of_member(&ann, "m2", "name"), "Thursday"); /* the link's */
    fake_say(&fake, &ben, "{\"type\":\"pointer\",\"view\":0,\"point_mm\":[1,2,3]}");
    assert_string_equal(refused(&ben), "403 ");
    cJSON *record = room_record(fake.room);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(record, "present")), 1);
    cJSON_Delete(record);
    room_connection_closed(fake.room, &ben, fake.now_us);
    assert_string_equal(of_member(&ann, "m2", "role"), "");
}

static void a_link_tells_who_made_it_and_its_end_can_put_out_who_came_by_it(void **state)
{
    char token[33], digits[9];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
    hello(&ann, &pat, "");
    by_link(&ben, &nobody, token);
    by_link(&cem, &zoe, token);
    room_link_digits(token, digits);
    cJSON *list = room_links(fake.room, fake.now_us), *row = cJSON_GetArrayItem(list, 0);
    assert_string_equal(json_text(row, "by"), "pat");
    assert_string_equal(json_text(row, "name"), "Thursday");
    assert_int_equal(json_number(row, "came", 0), 2);
    assert_true(json_flag(row, "guests", false));
    cJSON_Delete(list);
    assert_true(room_link_revoke_all(fake.room, digits, NULL, "", fake.now_us));
    assert_string_equal(heard(&ben, "bye", "code"), "removed");
    assert_true(cem.is_closed && !ann.is_closed);
    assert_int_equal(room_n_connected(fake.room), 1);
}

/* ---- removing --------------------------------------------------------------------------------------------------- */

static void who_is_removed_is_told_by_whom_and_stays_out_until_asked_again(void **state)
{
    struct problem problem = { 0 };
    char seat[200];
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"rae\"}]}", &problem));
    hello(&ann, &pat, "");
    hello(&ben, &rae, "");
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m2\",\"secret\":\"%s\"", heard(&ben, "welcome", "secret"));
    fake_say(&fake, &ben, "{\"type\":\"member.remove\",\"member\":\"m1\"}");
    assert_string_equal(refused(&ben), "403 ");
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m2\",\"reason\":\"wrong meeting\"}");
    assert_string_equal(heard(&ben, "bye", "reason"), "Pat Lee removed you from this room: wrong meeting");
    assert_string_equal(heard(&ben, "bye", "code"), "removed");
    assert_string_equal(of_member(&ann, "m2", "name"), "");
    assert_string_equal(fake.audit[(fake.n_audited - 1) % 16],
                        "leave m2 done {} -1 -1"); /* and before it who removed them */
    assert_string_equal(fake.audit[(fake.n_audited - 2) % 16],
                        "removed m1 done {\"member\":\"m2\",\"name\":\"Rae\",\"user\":\"rae\",\"reason\":\"wrong "
                        "meeting\"} -1 -1");
    hello(&cem, &rae, seat);
    expect_refused(&cem, "", "the room is closed");
    assert_true(patch("{\"people\":[{\"who\":\"@physics\"}]}", &problem)); /* their group is asked, not they */
    hello(&dee, &rae, "");
    expect_refused(&dee, "removed", "you were removed from this room: ask to be let in again");
    fake_page_end(&dee);
    assert_true(patch("{\"people\":[{\"who\":\"rae\"}]}", &problem));
    hello(&dee, &rae, "");
    assert_string_equal(heard(&dee, "welcome", "member"), "m3");
}

static void who_was_removed_comes_in_by_a_later_link_alone(void **state)
{
    char old[33], new[33];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, false, old);
    hello(&ann, &pat, "");
    by_link(&ben, &zoe, old);
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m2\"}");
    by_link(&cem, &zoe, old);
    expect_refused(&cem, "removed", "you were removed from this room: ask to be let in again");
    make_link(WIRE_MEMBER_ROLE_OBSERVER, false, new);
    by_link(&dee, &zoe, new);
    assert_string_equal(of_member(&dee, "m3", "role"), "observer");
}

static void a_removed_guests_link_lets_in_nobody_else(void **state)
{
    char token[33];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
    hello(&ann, &pat, "");
    by_link(&ben, &nobody, token);
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m2\"}");
    assert_true(ben.is_closed);
    by_link(&cem, &nobody, token);
    expect_refused(&cem, "", "the room is closed");
}

static void the_last_planner_stays_and_nobody_removes_themself(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"plee\"}]}", &problem));
    make_link(WIRE_MEMBER_ROLE_PRESENTER, false, token);
    hello(&ann, &pat, "");
    by_link(&ben, &zoe, token);
    fake_say(&fake, &ben, "{\"type\":\"member.remove\",\"member\":\"m1\"}");
    assert_string_equal(refused(&ben), "409 /member");
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m1\"}");
    assert_string_equal(refused(&ann), "409 /member");
    hello(&cem, &pat_too, "");
    fake_say(&fake, &ben, "{\"type\":\"member.remove\",\"member\":\"m1\"}"); /* there is another one now */
    assert_true(ann.is_closed);
    assert_string_equal(of_member(&ben, "m3", "role"), "planner");
}

/* ---- calls ------------------------------------------------------------------------------------------------------ */

static void a_call_has_the_role_of_its_seat_or_its_person(void **state)
{
    char seat[100];
    (void)state;
    hello(&ann, &pat, "");
    (void)snprintf(seat, sizeof seat, "m1 %s", heard(&ann, "welcome", "secret"));
    struct room_caller caller = room_caller_of(fake.room, &pat, seat);
    assert_true(caller.is_here && caller.is_member && caller.role == WIRE_MEMBER_ROLE_PLANNER);
    caller = room_caller_of(fake.room, &pat, NULL);
    assert_true(caller.is_here && !caller.is_member && caller.role == WIRE_MEMBER_ROLE_PLANNER);
    assert_false(room_caller_of(fake.room, &rae, seat).is_here);
    assert_false(room_caller_of(fake.room, &rae, NULL).is_here);
    assert_false(room_caller_of(fake.room, &nobody, NULL).is_here);
    assert_true(room_is_listed_to(fake.room, &pat));
    assert_false(room_is_listed_to(fake.room, &rae));
}

/* ---- on disk ---------------------------------------------------------------------------------------------------- */

static void it_all_lasts_over_sleep(void **state)
{
    struct problem problem = { 0 };
    struct store_room kept;
    char token[33], seat[200], guest[200];
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"@physics\",\"role\":\"observer\"}]}", &problem));
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
    hello(&ann, &pat, "");
    by_link(&ben, &nobody, token);
    by_link(&cem, &zoe, token);
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    (void)snprintf(guest, sizeof guest, ",\"member\":\"m2\",\"secret\":\"%s\"", heard(&ben, "welcome", "secret"));
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m3\"}");
    cJSON *before = room_people(fake.room);
    assert_true(room_keep(fake.room, ROOM_ALL_PARTS, &kept));
    assert_true(room_people_name(kept.owner, kept.people, &pat, true));
    assert_false(room_people_name(kept.owner, kept.people, &pat, false)); /* the grant was withdrawn */
    assert_true(room_people_name(kept.owner, kept.people, &rae, true));   /* of the group */
    assert_false(room_people_name(kept.owner, kept.people, &rae, false));
    assert_false(room_people_name(kept.owner, kept.people, &zoe, true));
    assert_false(room_people_name(kept.owner, kept.people, &oli, true));
    (void)room_end(NULL);
    (void)start(NULL);
    room_set_owner(fake.room, "");
    room_restore(fake.room, &kept, fake.now_us);
    room_kept_finish(&kept);
    cJSON *after = room_people(fake.room);
    assert_true(cJSON_Compare(before, after, true));
    cJSON_Delete(before);
    cJSON_Delete(after);
    hello(&ann, &pat_too, seat);
    expect_refused(&ann, "", "the room is closed");
    fake_page_end(&ann);
    hello(&ann, &pat, seat);
    assert_string_equal(heard(&ann, "welcome", "member"), "m1");
    hello(&ben, &nobody, guest);
    assert_string_equal(of_member(&ben, "m2", "is_guest"), "true");
    by_link(&cem, &zoe, token);
    expect_refused(&cem, "removed", "you were removed from this room: ask to be let in again");
    hello(&dee, &rae, "");
    assert_string_equal(of_member(&dee, "m4", "role"), "observer");
    cJSON *links = room_links(fake.room, fake.now_us);
    assert_string_equal(json_text(cJSON_GetArrayItem(links, 0), "by"), "pat");
    assert_int_equal(json_number(cJSON_GetArrayItem(links, 0), "came", 0), 1);
    cJSON_Delete(links);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        PEOPLE_TEST(a_room_is_closed_to_all_but_its_owner),
        PEOPLE_TEST(who_is_asked_by_name_or_group_comes_in_with_no_more_than_the_plan_gives),
        PEOPLE_TEST(an_open_room_lets_in_who_has_a_role_on_the_plan),
        PEOPLE_TEST(people_are_checked_whole),
        PEOPLE_TEST(a_room_from_before_sign_in_is_open_to_planners_alone),
        PEOPLE_TEST(names_come_from_the_sign_in_and_equal_ones_are_told_apart),
        PEOPLE_TEST(a_seat_is_its_users_alone),
        PEOPLE_TEST(one_users_tabs_are_one_person),
        PEOPLE_TEST(nobody_fills_a_room_alone),
        PEOPLE_TEST(strangers_tries_are_a_row_of_the_audit_together),
        PEOPLE_TEST(the_end_of_a_sign_in_keeps_the_seat_and_not_control),
        PEOPLE_TEST(who_comes_by_an_observers_link_is_an_observer),
        PEOPLE_TEST(an_unknown_link_tells_no_more_than_a_closed_room),
        PEOPLE_TEST(a_guest_looks_points_and_writes_as_the_link_says),
        PEOPLE_TEST(a_guest_comes_back_by_its_seat_while_guests_may),
        PEOPLE_TEST(a_wall_looks_has_no_name_in_attendance_and_no_seat),
        PEOPLE_TEST(a_link_tells_who_made_it_and_its_end_can_put_out_who_came_by_it),
        PEOPLE_TEST(who_is_removed_is_told_by_whom_and_stays_out_until_asked_again),
        PEOPLE_TEST(who_was_removed_comes_in_by_a_later_link_alone),
        PEOPLE_TEST(a_removed_guests_link_lets_in_nobody_else),
        PEOPLE_TEST(the_last_planner_stays_and_nobody_removes_themself),
        PEOPLE_TEST(a_call_has_the_role_of_its_seat_or_its_person),
        PEOPLE_TEST(it_all_lasts_over_sleep),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
