/* Control passes from one member to another; links; who waits for what. Ann enters first, with the role of presenter.
 */
#include "tests/unit/room_set_up.h"

static void say(struct fake_page *page, const char *type)
{
    fake_say(&fake, page, "{\"type\":\"%s\"}", type);
}

static void say_member(struct fake_page *page, const char *type, const char *member)
{
    fake_say(&fake, page, "{\"type\":\"%s\",\"member\":\"%s\"}", type, member);
}

static void lock(struct fake_page *page, bool locked)
{
    fake_say(&fake, page, "{\"type\":\"control.lock\",\"locked\":%s}", locked ? "true" : "false");
}

static void enter(struct fake_page *page, const char *token, const char *person)
{
    fake_say(&fake, page, "{\"type\":\"hello\",\"protocol\":2,\"link\":\"%s\",\"person\":\"%s\"}", token, person);
}

static void patch(struct fake_page *page)
{
    fake_say(&fake, page,
             "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"opacity\":0.5}}},\"input\":9}");
}

/* A field of the newest control message, a text; requests as "m2 m3", locked as "locked" or "open". */
static const char *control(const struct fake_page *page, const char *field)
{
    static char text[128];
    cJSON *message = fake_heard(page, "control");
    const cJSON *value = cJSON_GetObjectItem(message, field);
    text[0] = 0;
    if (cJSON_IsBool(value))
        (void)snprintf(text, sizeof text, "%s", cJSON_IsTrue(value) ? "locked" : "open");
    else if (cJSON_IsString(value))
        (void)snprintf(text, sizeof text, "%s", value->valuestring);
    for (const cJSON *id = cJSON_IsArray(value) ? value->child : NULL; id; id = id->next)
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", text[0] ? " " : "", id->valuestring);
    cJSON_Delete(message);
    return text;
}

static const char *code(const struct fake_page *page)
{
    static char text[64];
    cJSON *message = fake_heard(page, "problem");
    const char *found = json_text(cJSON_GetObjectItem(message, "problem"), "code");
    (void)snprintf(text, sizeof text, "%s", found ? found : "");
    cJSON_Delete(message);
    return text;
}

/* A field of a member in the newest list. */
static const char *of_member(const struct fake_page *page, int index, const char *field)
{
    static char text[64];
    cJSON *message = fake_heard(page, "members");
    const cJSON *value = cJSON_GetObjectItem(cJSON_GetArrayItem(cJSON_GetObjectItem(message, "members"), index), field);
    if (cJSON_IsNumber(value))
        (void)snprintf(text, sizeof text, "%d", value->valueint);
    else
        (void)snprintf(text, sizeof text, "%s", cJSON_IsString(value) ? value->valuestring : "");
    cJSON_Delete(message);
    return text;
}

static void make_link(enum wire_member_role role, int64_t expires_s, bool is_one_use, char token[33])
{
    struct problem problem = { 0 };
    assert_true(room_link_create(fake.room, role, expires_s, is_one_use, fake.now_us, token, &problem));
    assert_int_equal(strlen(token), 32);
}

static void meet(void)
{
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_join(&fake, &cem, true);
}

/* ---- control ---------------------------------------------------------------------------------------------------- */

static void a_request_stands_until_it_is_answered(void **state)
{
    (void)state;
    meet();
    say(&cem, "control.request");
    say(&ben, "control.request");
    say(&ben, "control.request"); /* once is enough */
    assert_string_equal(control(&ann, "requests"), "m3 m2");
    assert_string_equal(control(&ann, "act"), "requested");
    assert_string_equal(control(&ann, "member"), "m2");
    say_member(&ann, "control.give", "m3");
    assert_string_equal(control(&ben, "presenter"), "m3");
    assert_string_equal(control(&ben, "requests"), "m2"); /* now with Cem */
    assert_string_equal(control(&ben, "act"), "given");
    assert_string_equal(control(&ben, "by"), "m1");
    patch(&cem);
    assert_int_equal(fake_n_heard(&cem, "problem"), 0);
    fake_say(&fake, &ben, "{\"type\":\"control.request\",\"wanted\":false}");
    assert_string_equal(control(&cem, "requests"), "");
    assert_string_equal(control(&cem, "act"), "withdrawn");
}

static void an_edit_by_who_has_lost_control_is_refused_with_its_number(void **state)
{
    (void)state;
    meet();
    say_member(&ann, "control.give", "m2");
    patch(&ann);
    assert_string_equal(refused(&ann), "403 ");
    cJSON *problem = fake_heard(&ann, "problem");
    assert_int_equal((int)json_number(problem, "input", 0), 9);
    cJSON_Delete(problem);
    patch(&ben);
    assert_int_equal(fake_n_heard(&ben, "problem"), 0);
}

static void a_refused_member_waits_before_the_next_request(void **state)
{
    (void)state;
    meet();
    say(&ben, "control.request");
    say_member(&ann, "control.refuse", "m2");
    assert_string_equal(control(&ben, "act"), "refused");
    assert_string_equal(control(&ben, "requests"), "");
    fake_pass(&fake, 9999);
    say(&ben, "control.request");
    assert_string_equal(refused(&ben), "429 ");
    fake_pass(&fake, 1);
    say(&ben, "control.request");
    assert_string_equal(control(&ann, "requests"), "m2");
}

static void a_request_ends_with_the_connection(void **state)
{
    (void)state;
    meet();
    say(&ben, "control.request");
    room_connection_closed(fake.room, &ben, fake.now_us);
    assert_string_equal(control(&ann, "requests"), "");
    assert_string_equal(control(&ann, "act"), "withdrawn");
}

static void only_the_role_of_presenter_takes_at_once_and_not_while_it_is_locked(void **state)
{
    (void)state;
    meet();
    say(&ben, "control.take");
    assert_string_equal(refused(&ben), "403 ");
    say_member(&ann, "control.give", "m2");
    say(&ann, "control.take");
    assert_string_equal(control(&ben, "presenter"), "m1");
    assert_string_equal(control(&ben, "act"), "taken");
    lock(&ben, true); /* a reviewer, who does not present */
    assert_string_equal(refused(&ben), "403 ");
    assert_string_equal(code(&ben), "role");
    char token[33];
    make_link(WIRE_MEMBER_ROLE_PRESENTER, 60, false, token);
    room_connection_closed(fake.room, &cem, fake.now_us); /* the room has three places */
    enter(&dee, token, "");
    lock(&ann, true);
    assert_string_equal(control(&dee, "locked"), "locked");
    say(&dee, "control.take");
    assert_string_equal(code(&dee), "locked");
    lock(&ann, false);
    say(&dee, "control.take");
    assert_string_equal(control(&ann, "presenter"), "m4");
}

static void a_lock_ends_when_control_passes_on(void **state)
{
    (void)state;
    meet();
    lock(&ann, true);
    say_member(&ann, "control.give", "m2");
    assert_string_equal(control(&ann, "locked"), "open");
    say(&ann, "control.take");
    assert_string_equal(control(&ann, "presenter"), "m1");
    lock(&ann, true);
    room_connection_closed(fake.room, &ann, fake.now_us);
    fake_pass(&fake, 30000);
    assert_string_equal(control(&ben, "presenter"), "");
    assert_string_equal(control(&ben, "locked"), "open");
    assert_string_equal(control(&ben, "act"), "left");
    say(&ben, "control.take"); /* a reviewer takes over a room that has no presenter */
    assert_string_equal(control(&cem, "presenter"), "m2");
}

static void control_is_taken_after_30_s_without_the_presenter_and_not_before(void **state)
{
    (void)state;
    meet();
    room_connection_closed(fake.room, &ann, fake.now_us);
    fake_pass(&fake, 29999);
    say(&ben, "control.take");
    assert_string_equal(refused(&ben), "403 ");
    fake_pass(&fake, 1);
    say(&ben, "control.take");
    assert_string_equal(control(&ben, "presenter"), "m2");
}

static void who_is_given_control_while_on_their_own_follows_the_rooms_views(void **state)
{
    (void)state;
    meet();
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":false}");
    fake_turn(&fake, &ben, 40, 1);
    size_t before = fake_n_heard(&cem, "view");
    say_member(&ann, "control.give", "m2");
    cJSON *view = fake_heard(&ben, "view");
    assert_true(json_flag(view, "follow", false));
    cJSON_Delete(view);
    assert_int_equal(fake_n_heard(&cem, "view"), before); /* nobody's picture moves */
}

static void control_is_given_to_members_who_are_there_and_may_present(void **state)
{
    char token[33];
    (void)state;
    fake_join(&fake, &ann, true);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, 60, false, token);
    enter(&ben, token, "");
    fake_join(&fake, &cem, true);
    room_connection_closed(fake.room, &cem, fake.now_us);
    say_member(&ann, "control.give", "m2");
    assert_string_equal(refused(&ann), "403 /member");
    say_member(&ann, "control.give", "m3");
    assert_string_equal(refused(&ann), "404 /member");
    say_member(&ann, "control.give", "m9");
    assert_string_equal(refused(&ann), "404 /member");
    assert_string_equal(control(&ann, "presenter"), "m1");
}

/* ---- links ------------------------------------------------------------------------------------------------------ */

static void a_link_gives_its_role(void **state)
{
    char token[33];
    (void)state;
    fake_hello(&fake, &ann);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, 60, false, token);
    enter(&ben, token, "");
    assert_string_equal(of_member(&ann, 1, "role"), "observer");
    patch(&ben);
    assert_string_equal(refused(&ben), "403 ");
    assert_string_equal(code(&ben), "role");
    say(&ben, "control.request");
    assert_string_equal(code(&ben), "role");
}

static void an_observer_who_is_left_alone_does_not_present(void **state)
{
    char token[33];
    (void)state;
    fake_join(&fake, &ann, true);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, 60, false, token);
    enter(&ben, token, "");
    room_connection_closed(fake.room, &ann, fake.now_us);
    fake_pass(&fake, 30000);
    assert_string_equal(control(&ben, "presenter"), "");
}

static void links_that_are_unknown_expired_or_used_are_refused_with_a_sentence(void **state)
{
    char token[33], one[33];
    (void)state;
    fake_hello(&fake, &ann);
    make_link(WIRE_MEMBER_ROLE_REVIEWER, 60, true, one);
    enter(&ben, "0123456789abcdef0123456789abcdef", "");
    assert_true(ben.is_closed);
    assert_string_equal(heard(&ben, "bye", "reason"),
                        "the link is not one of this room, or ended long ago: ask for a new one");
    enter(&cem, one, "");
    assert_string_equal(of_member(&ann, 1, "role"), "reviewer");
    enter(&dee, one, "");
    assert_true(dee.is_closed);
    assert_string_equal(heard(&dee, "bye", "reason"),
                        "the link was for one person and has been used: ask for one of your own");
    make_link(WIRE_MEMBER_ROLE_REVIEWER, 60, false, token);
    fake_pass(&fake, 60000);
    ben.is_closed = false;
    enter(&ben, token, "");
    assert_true(ben.is_closed);
    assert_string_equal(heard(&ben, "bye", "reason"), "the link has expired: ask for a new one");
    assert_int_equal(room_n_connected(fake.room), 2);
}

static void a_link_for_one_person_lets_that_person_in_again(void **state)
{
    char one[33];
    (void)state;
    fake_hello(&fake, &ann);
    make_link(WIRE_MEMBER_ROLE_REVIEWER, 60, true, one);
    enter(&ben, one, "b7a3");
    enter(&cem, one, "b7a3");
    assert_false(cem.is_closed);
    assert_string_equal(of_member(&ann, 1, "tabs"), "2");
    assert_string_equal(of_member(&ann, 0, "tabs"), "1");
}

static void who_came_by_a_link_comes_back_when_it_has_expired_long_ago(void **state)
{
    char token[33], secret[64];
    (void)state;
    fake_hello(&fake, &ann);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, 60, false, token);
    enter(&ben, token, "");
    (void)snprintf(secret, sizeof secret, "%s", heard(&ben, "welcome", "secret"));
    room_connection_closed(fake.room, &ben, fake.now_us);
    fake_pass(&fake, ROOM_MEMBER_KEPT_S * 1000 + 1000); /* no longer in the list of members */
    fake_say(&fake, &ben, "{\"type\":\"hello\",\"protocol\":2,\"member\":\"m2\",\"secret\":\"%s\",\"link\":\"%s\"}",
             secret, token);
    assert_false(ben.is_closed);
    assert_int_equal(fake_n_heard(&ben, "welcome"), 2);
    assert_string_equal(heard(&ben, "welcome", "member"), "m2");
    assert_string_equal(of_member(&ann, 1, "role"), "observer");
}

static void links_are_bounded_and_expired_ones_make_room(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    for (int i = 0; i < ROOM_MAX_LINKS; i++)
        make_link(WIRE_MEMBER_ROLE_OBSERVER, 60 + i, false, token);
    assert_false(room_link_create(fake.room, WIRE_MEMBER_ROLE_OBSERVER, 60, false, fake.now_us, token, &problem));
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    fake_pass(&fake, 60000);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, 60, false, token);
}

/* ---- calls over HTTP -------------------------------------------------------------------------------------------- */

static void calls_of_nobody_may_less_once_the_room_has_a_link(void **state)
{
    static const bool without[] = { true, true, true, true, true }, with[] = { true, true, true, false, false };
    char token[33];
    (void)state;
    for (int right = WIRE_RIGHT_LOOK; right <= WIRE_RIGHT_CONTROL; right++)
        assert_int_equal(room_call_may(fake.room, NULL, (enum wire_right)right, NULL), without[right]);
    make_link(WIRE_MEMBER_ROLE_OBSERVER, 60, false, token);
    for (int right = WIRE_RIGHT_LOOK; right <= WIRE_RIGHT_CONTROL; right++)
        assert_int_equal(room_call_may(fake.room, NULL, (enum wire_right)right, NULL), with[right]);
}

static void a_call_of_a_member_has_its_rights(void **state)
{
    char ann_is[128], ben_is[128];
    struct problem problem = { 0 };
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    (void)snprintf(ann_is, sizeof ann_is, "m1 %s", heard(&ann, "welcome", "secret"));
    (void)snprintf(ben_is, sizeof ben_is, "m2 %s", heard(&ben, "welcome", "secret"));
    assert_true(room_call_may(fake.room, ann_is, WIRE_RIGHT_SCENE, NULL));
    assert_true(room_call_may(fake.room, ann_is, WIRE_RIGHT_CONTROL, NULL));
    assert_true(room_call_may(fake.room, ben_is, WIRE_RIGHT_NOTE, NULL));
    assert_false(room_call_may(fake.room, ben_is, WIRE_RIGHT_CONTROL, &problem));
    assert_int_equal(problem.type, PROBLEM_FORBIDDEN);
    assert_false(room_call_may(fake.room, ben_is, WIRE_RIGHT_SCENE, &problem)); /* he does not present */
    assert_int_equal(problem.type, PROBLEM_NOT_PRESENTER);
    ben_is[1] = '1'; /* Ann's id with Ben's secret */
    static const char *const bad[] = { "", "m1", "m1 ", "m1 0", " ", "m3 0123456789abcdef0123456789abcdef" };
    assert_false(room_call_may(fake.room, ben_is, WIRE_RIGHT_LOOK, &problem));
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(room_call_may(fake.room, bad[i], WIRE_RIGHT_LOOK, &problem));
    assert_string_equal(problem.code, "member");
}

/* ---- lag -------------------------------------------------------------------------------------------------------- */

static void who_does_not_acknowledge_lags_by_the_link(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_draw(&fake, fake_oldest(&fake));
    fake_pass(&fake, 999);
    assert_string_equal(of_member(&ann, 0, "lag"), "none");
    fake_pass(&fake, 1);
    assert_string_equal(of_member(&ann, 0, "lag"), "link");
    fake_shown(&fake, &ann);
    fake_pass(&fake, 2999); /* told for 3 s at least */
    assert_string_equal(of_member(&ann, 0, "lag"), "link");
    fake_pass(&fake, 1);
    assert_string_equal(of_member(&ann, 0, "lag"), "none");
}

static void who_waits_for_a_picture_lags_by_the_renderer(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_pass(&fake, 1000);
    assert_string_equal(of_member(&ann, 0, "lag"), "renderer");
    settle_one();
    fake_pass(&fake, 3000);
    assert_string_equal(of_member(&ann, 0, "lag"), "none");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_request_stands_until_it_is_answered),
        ROOM_TEST(an_edit_by_who_has_lost_control_is_refused_with_its_number),
        ROOM_TEST(a_refused_member_waits_before_the_next_request),
        ROOM_TEST(a_request_ends_with_the_connection),
        ROOM_TEST(only_the_role_of_presenter_takes_at_once_and_not_while_it_is_locked),
        ROOM_TEST(a_lock_ends_when_control_passes_on),
        ROOM_TEST(control_is_taken_after_30_s_without_the_presenter_and_not_before),
        ROOM_TEST(who_is_given_control_while_on_their_own_follows_the_rooms_views),
        ROOM_TEST(control_is_given_to_members_who_are_there_and_may_present),
        ROOM_TEST(a_link_gives_its_role),
        ROOM_TEST(an_observer_who_is_left_alone_does_not_present),
        ROOM_TEST(links_that_are_unknown_expired_or_used_are_refused_with_a_sentence),
        ROOM_TEST(a_link_for_one_person_lets_that_person_in_again),
        ROOM_TEST(who_came_by_a_link_comes_back_when_it_has_expired_long_ago),
        ROOM_TEST(links_are_bounded_and_expired_ones_make_room),
        ROOM_TEST(calls_of_nobody_may_less_once_the_room_has_a_link),
        ROOM_TEST(a_call_of_a_member_has_its_rights),
        ROOM_TEST(who_does_not_acknowledge_lags_by_the_link),
        ROOM_TEST(who_waits_for_a_picture_lags_by_the_renderer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
