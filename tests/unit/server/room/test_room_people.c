/* People of a room: the ones who come in, and the ones who are removed. */
#include "tests/unit/people_set_up.h"

static bool patch(const char *json, struct problem *problem)
{
    cJSON *body = json_read(json, strlen(json), NULL);
    assert_non_null(body);
    const bool is_done = room_people_patch(fake.room, body, &pat, NULL, "", fake.now_us, problem);
    cJSON_Delete(body);
    return is_done;
}

/* ---- closed ----------------------------------------------------------------------------------------------------- */

static void a_room_is_closed_to_all_but_its_owner(void **state)
{
    (void)state;
    say_hello(&ann, &pat, "");
    assert_string_equal(of_member(&ann, me(&ann), "role"), "planner");
    say_hello(&ben, &rae, "");
    expect_refused(&ben, "", "the room is closed");
    say_hello(&cem, &pat_too, ""); /* has rights enough on the plan, and was not asked */
    expect_refused(&cem, "", "the room is closed");
    say_hello(&dee, &nobody, "");
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
    say_hello(&ann, &rae, "");
    assert_string_equal(of_member(&ann, me(&ann), "role"), "reviewer"); /* the plan gives no more */
    say_hello(&ben, &pat_too, "");
    assert_string_equal(of_member(&ben, me(&ben), "role"), "reviewer"); /* the room gives no more */
    say_hello(&cem, &zoe, "");
    expect_refused(&cem, "", "the room is closed"); /* has no role on the plan at all */
}

static void an_open_room_lets_in_who_has_a_role_on_the_plan(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"is_open\":true}", &problem));
    say_hello(&ann, &oli, "");
    assert_string_equal(of_member(&ann, me(&ann), "role"), "observer");
    say_hello(&ben, &zoe, "");
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
    say_hello(&ann, &rae, "");
    expect_refused(&ann, "", "the room is closed");
    say_hello(&ben, &pat_too, "");
    assert_string_equal(of_member(&ben, me(&ben), "role"), "planner");
}

/* ---- names and seats -------------------------------------------------------------------------------------------- */

static void names_come_from_the_sign_in_and_equal_ones_are_told_apart(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"plee\"}]}", &problem));
    say_hello(&ann, &pat, ",\"name\":\"Professor\"");
    say_hello(&ben, &pat_too, ",\"name\":\"Professor\"");
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
    say_hello(&ann, &pat, "");
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    say_hello(&ben, &pat_too, seat);
    assert_string_equal(heard(&ben, "welcome", "member"), "m2");
    assert_false(ann.is_closed);
    say_hello(&cem, &nobody, seat);
    expect_refused(&cem, "sign-in", "sign in to enter this room");
    say_hello(&dee, &pat, seat);
    assert_string_equal(heard(&dee, "welcome", "member"), "m1");
    assert_true(ann.is_closed);
}

static void one_users_tabs_are_one_person(void **state)
{
    (void)state;
    say_hello(&ann, &pat, ",\"person\":\"one\"");
    say_hello(&ben, &pat, ",\"person\":\"two\""); /* another browser */
    cJSON *message = fake_heard(&ben, "members");
    assert_int_equal(json_number(cJSON_GetArrayItem(cJSON_GetObjectItem(message, "members"), 0), "tabs", 0), 2);
    cJSON_Delete(message);
}

static void nobody_fills_a_room_alone(void **state)
{
    static struct fake_page tabs[ROOM_MAX_TABS + 1];
    (void)state;
    people_start_again(2 * ROOM_MAX_TABS);
    for (int i = 0; i <= ROOM_MAX_TABS; i++) {
        say_hello(&tabs[i], &pat, "");
        assert_int_equal(tabs[i].is_closed, i == ROOM_MAX_TABS);
    }
    room_connection_closed(fake.room, &tabs[0], fake.now_us);
    fake_page_end(&tabs[ROOM_MAX_TABS]);
    say_hello(&tabs[ROOM_MAX_TABS], &pat, "");
    assert_false(tabs[ROOM_MAX_TABS].is_closed);
    room_destroy(fake.room);
    for (int i = 0; i <= ROOM_MAX_TABS; i++)
        fake_page_end(&tabs[i]);
    fake_room_start(&fake, 3);
}

static void what_is_no_hello_is_told_no_more_than_a_hello(void **state)
{
    static const char *const texts[] = { "{\"type\":\"hello\",\"protocol\":1}", "{\"type\":\"hello\"",
                                         "{\"type\":\"?\"}", "{\"type\":\"present\"}" };
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct fake_page *const pages[] = { &ann, &ben, &cem };
        ann.identity = &zoe;
        ben.identity = &nobody;
        cem.identity = &pat;
        for (size_t k = 0; k < 3; k++)
            fake_say(&fake, pages[k], "%s", texts[i]);
        expect_refused(&ann, "", "the room is closed");
        expect_refused(&ben, "sign-in", "sign in to enter this room");
        expect_refused(&cem, "",
                       i == 0 ? "the page speaks another protocol version: reload it"
                              : "the first message must be hello");
        assert_int_equal(ann.n_texts + ben.n_texts, 2);
        for (size_t k = 0; k < 3; k++)
            fake_page_end(pages[k]);
    }
}

static void strangers_tries_are_a_row_of_the_audit_together(void **state)
{
    (void)state;
    const size_t n_before = fake.n_audited;
    say_hello(&ann, &nobody, ",\"name\":\"a\"");
    say_hello(&ben, &nobody, ",\"name\":\"b\"");
    say_hello(&cem, &nobody, ",\"name\":\"c\"");
    assert_int_equal(fake.n_audited - n_before, 1);
}

static void the_end_of_a_sign_in_keeps_the_seat_and_not_control(void **state)
{
    struct problem problem = { 0 };
    char seat[200];
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"rae\"}]}", &problem));
    say_hello(&ann, &pat, "");
    say_hello(&ben, &rae, "");
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    assert_string_equal(of_member(&ben, "m1", "presenting"), "true");
    room_sign_in_over(fake.room, &ann, fake.now_us);
    assert_true(ann.is_signed_out);
    assert_string_equal(heard(&ann, "bye", "code"), "sign-in");
    assert_string_equal(of_member(&ben, "m1", "connected"), "");
    fake.again_us = fake.now_us;
    fake_pass(&fake, ROOM_PRESENTER_KEPT_S * 1000 + 10);
    assert_string_equal(of_member(&ben, "m2", "presenting"), "true"); /* alone there now */
    say_hello(&cem, &pat, seat);
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
    say_hello(&ben, &zoe, seat); /* comes back, and leaves the link away */
    assert_string_equal(of_member(&ben, "m1", "role"), "observer");
    say_hello(&cem, &zoe, ""); /* the link alone has let them in */
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

/* Says hello with a link as a guest of this browser. */
static void by_link_of(struct fake_page *page, const char *token, const char *browser)
{
    char more[140];
    (void)snprintf(more, sizeof more, ",\"link\":\"%s\",\"name\":\"Gus\",\"person\":\"%s\"", token, browser);
    say_hello(page, &nobody, more);
}

static void a_guests_link_for_one_seats_each_tab_of_that_browser_and_tells_others_why_not(void **state)
{
    static const char used[] = "the link was for one person and has been used: ask for one of your own";
    struct problem problem = { 0 };
    const struct room_link wanted = {
        .role = WIRE_MEMBER_ROLE_REVIEWER, .expires_s = 3600, .allows_guests = true, .is_one_use = true
    };
    char token[33];
    (void)state;
    assert_true(room_link_make(fake.room, &wanted, fake.now_us, token, &problem));
    by_link_of(&ann, token, "0123");
    by_link_of(&ben, token, "0123"); /* a second tab */
    assert_string_equal(of_member(&ben, "m1", "is_guest"), "true");
    assert_string_equal(of_member(&ben, "m2", "is_guest"), "true");
    by_link_of(&cem, token, "4567");
    expect_refused(&cem, "", used);
    by_link_of(&dee, token, ""); /* a browser that keeps nothing */
    expect_refused(&dee, "", used);
}

static void a_guest_comes_back_by_its_seat_while_guests_may(void **state)
{
    char token[33], seat[200];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
    by_link(&ann, &nobody, token);
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&ann, "welcome", "secret"));
    say_hello(&ben, &nobody, seat);
    assert_string_equal(of_member(&ben, "m1", "is_guest"), "true");
    say_hello(&cem, &rae, seat); /* who has signed in is nobody's guest */
    expect_refused(&cem, "", "the room is closed");
}

static void a_wall_looks_has_no_name_in_attendance_and_no_seat(void **state)
{
    char token[33];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_WALL, false, token);
    say_hello(&ann, &pat, "");
    char more[100];
    (void)snprintf(more, sizeof more, ",\"link\":\"%s\"", token);
    say_hello(&ben, &nobody, more);
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
    say_hello(&ann, &pat, "");
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

/* A guest by this link in each page, until one is refused. Returns how many came in. */
static int fill(struct fake_page *pages, int n, const char *token)
{
    int n_in = 0;
    for (; n_in < n; n_in++) {
        by_link(&pages[n_in], &nobody, token);
        if (pages[n_in].is_closed)
            break;
    }
    return n_in;
}

static void one_link_fills_no_room(void **state)
{
    enum { MAX = 20 };
    static struct fake_page guests[MAX], walls[MAX];
    char token[33], wall[33], seat[200], bye[200];
    (void)state;
    people_start_again(MAX);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
    make_link(WIRE_MEMBER_ROLE_WALL, false, wall);
    assert_int_equal(fill(guests, MAX, token), MAX / 2);
    (void)snprintf(bye, sizeof bye, "%s", heard(&guests[MAX / 2], "bye", "reason"));
    assert_string_equal(bye, "as many as may come by one link are in the room already");
    cJSON *message = fake_heard(&guests[MAX / 2], "bye");
    assert_true(json_number(message, "retry_ms", -1) > 0);
    cJSON_Delete(message);
    assert_int_equal(fill(walls, MAX, wall), ROOM_MAX_WALLS);
    by_link(&ann, &zoe, token); /* has signed in */
    assert_false(ann.is_closed);
    (void)snprintf(seat, sizeof seat, ",\"member\":\"m1\",\"secret\":\"%s\"", heard(&guests[0], "welcome", "secret"));
    room_connection_closed(fake.room, &guests[0], fake.now_us);
    by_link(&ben, &nobody, token);
    assert_false(ben.is_closed);
    say_hello(&cem, &nobody, seat); /* whose place another one has taken */
    expect_refused(&cem, "", bye);
    room_connection_closed(fake.room, &ben, fake.now_us);
    say_hello(&dee, &nobody, seat);
    assert_string_equal(heard(&dee, "welcome", "member"), "m1");
    room_destroy(fake.room);
    for (int i = 0; i < MAX; i++) {
        fake_page_end(&guests[i]);
        fake_page_end(&walls[i]);
    }
    fake_room_start(&fake, 3);
}

/* ---- removing --------------------------------------------------------------------------------------------------- */

static void who_is_removed_is_told_by_whom_and_stays_out_until_asked_again(void **state)
{
    struct problem problem = { 0 };
    char seat[200];
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"rae\"}]}", &problem));
    say_hello(&ann, &pat, "");
    say_hello(&ben, &rae, "");
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
    say_hello(&cem, &rae, seat);
    expect_refused(&cem, "", "the room is closed");
    assert_true(patch("{\"people\":[{\"who\":\"@physics\"}]}", &problem)); /* their group is asked, not they */
    say_hello(&dee, &rae, "");
    expect_refused(&dee, "removed", "you were removed from this room: ask to be let in again");
    fake_page_end(&dee);
    assert_true(patch("{\"people\":[{\"who\":\"rae\"}]}", &problem));
    say_hello(&dee, &rae, "");
    assert_string_equal(heard(&dee, "welcome", "member"), "m3");
}

static void who_was_removed_comes_in_by_a_later_link_alone(void **state)
{
    char old[33], new[33];
    (void)state;
    make_link(WIRE_MEMBER_ROLE_OBSERVER, false, old);
    say_hello(&ann, &pat, "");
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
    say_hello(&ann, &pat, "");
    by_link(&ben, &nobody, token);
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m2\"}");
    assert_true(ben.is_closed);
    by_link(&cem, &nobody, token);
    expect_refused(&cem, "", "the room is closed");
}

static void a_removed_guest_has_no_earlier_seat_to_come_back_to(void **state)
{
    (void)state;
    for (int is_long_ago = 0; is_long_ago < 2; is_long_ago++) {
        char token[33], more[200], seat[200];
        make_link(WIRE_MEMBER_ROLE_OBSERVER, true, token);
        say_hello(&ann, &pat, "");
        (void)snprintf(more, sizeof more, ",\"link\":\"%s\",\"name\":\"Other\",\"person\":\"other\"", token);
        say_hello(&ben, &nobody, more);
        (void)snprintf(seat, sizeof seat, ",\"member\":\"%s\",\"secret\":\"", me(&ben));
        (void)snprintf(seat + strlen(seat), sizeof seat - strlen(seat), "%s\"", heard(&ben, "welcome", "secret"));
        room_connection_closed(fake.room, &ben, fake.now_us);
        fake_pass(&fake, is_long_ago ? ROOM_MEMBER_KEPT_S * 1000 + 10 : 10);
        by_link(&cem, &nobody, token);
        fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"%s\"}", me(&cem));
        assert_true(cem.is_closed);
        say_hello(&dee, &nobody, seat);
        expect_refused(&dee, "sign-in", "sign in to enter this room");
        struct fake_page *const pages[] = { &ann, &ben, &cem, &dee };
        room_connection_closed(fake.room, &ann, fake.now_us);
        for (size_t k = 0; k < 4; k++)
            fake_page_end(pages[k]);
    }
}

static void the_last_planner_stays_and_nobody_removes_themself(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    assert_true(patch("{\"people\":[{\"who\":\"plee\"}]}", &problem));
    make_link(WIRE_MEMBER_ROLE_PRESENTER, false, token);
    say_hello(&ann, &pat, "");
    by_link(&ben, &zoe, token);
    fake_say(&fake, &ben, "{\"type\":\"member.remove\",\"member\":\"m1\"}");
    assert_string_equal(refused(&ben), "409 /member");
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m1\"}");
    assert_string_equal(refused(&ann), "409 /member");
    say_hello(&cem, &pat_too, "");
    fake_say(&fake, &ben, "{\"type\":\"member.remove\",\"member\":\"m1\"}"); /* there is another one now */
    assert_true(ann.is_closed);
    assert_string_equal(of_member(&ben, "m3", "role"), "planner");
}

/* ---- calls ------------------------------------------------------------------------------------------------------ */

static void a_call_has_the_role_of_its_seat_or_its_person(void **state)
{
    char seat[100];
    (void)state;
    say_hello(&ann, &pat, "");
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
    say_hello(&ann, &pat, "");
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
    (void)people_start(NULL);
    room_set_owner(fake.room, "");
    room_restore(fake.room, &kept, fake.now_us);
    room_kept_finish(&kept);
    cJSON *after = room_people(fake.room);
    assert_true(cJSON_Compare(before, after, true));
    cJSON_Delete(before);
    cJSON_Delete(after);
    say_hello(&ann, &pat_too, seat);
    expect_refused(&ann, "", "the room is closed");
    fake_page_end(&ann);
    say_hello(&ann, &pat, seat);
    assert_string_equal(heard(&ann, "welcome", "member"), "m1");
    say_hello(&ben, &nobody, guest);
    assert_string_equal(of_member(&ben, "m2", "is_guest"), "true");
    by_link(&cem, &zoe, token);
    expect_refused(&cem, "removed", "you were removed from this room: ask to be let in again");
    say_hello(&dee, &rae, "");
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
        PEOPLE_TEST(what_is_no_hello_is_told_no_more_than_a_hello),
        PEOPLE_TEST(strangers_tries_are_a_row_of_the_audit_together),
        PEOPLE_TEST(the_end_of_a_sign_in_keeps_the_seat_and_not_control),
        PEOPLE_TEST(who_comes_by_an_observers_link_is_an_observer),
        PEOPLE_TEST(an_unknown_link_tells_no_more_than_a_closed_room),
        PEOPLE_TEST(a_guest_looks_points_and_writes_as_the_link_says),
        PEOPLE_TEST(a_guests_link_for_one_seats_each_tab_of_that_browser_and_tells_others_why_not),
        PEOPLE_TEST(a_guest_comes_back_by_its_seat_while_guests_may),
        PEOPLE_TEST(a_wall_looks_has_no_name_in_attendance_and_no_seat),
        PEOPLE_TEST(a_link_tells_who_made_it_and_its_end_can_put_out_who_came_by_it),
        PEOPLE_TEST(one_link_fills_no_room),
        PEOPLE_TEST(who_is_removed_is_told_by_whom_and_stays_out_until_asked_again),
        PEOPLE_TEST(who_was_removed_comes_in_by_a_later_link_alone),
        PEOPLE_TEST(a_removed_guests_link_lets_in_nobody_else),
        PEOPLE_TEST(a_removed_guest_has_no_earlier_seat_to_come_back_to),
        PEOPLE_TEST(the_last_planner_stays_and_nobody_removes_themself),
        PEOPLE_TEST(a_call_has_the_role_of_its_seat_or_its_person),
        PEOPLE_TEST(it_all_lasts_over_sleep),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
