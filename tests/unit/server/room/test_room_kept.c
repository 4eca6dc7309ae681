/* A room's kept state makes another one that lets the same people in with the same rights. */
#include <time.h>

#include "server/auth/secret.h"
#include "tests/unit/room_set_up.h"

static struct fake_room again;
static struct fake_page eve;

/* A room made of what is kept of the fake one; change may be NULL. */
static void wake(void (*change)(struct store_room *kept))
{
    struct store_room kept;
    assert_true(room_keep(fake.room, ROOM_ALL_PARTS, &kept));
    if (change)
        change(&kept);
    fake_room_start(&again, 3);
    again.now_us = 7; /* the clock of another boot */
    room_restore(again.room, &kept, again.now_us);
    room_kept_finish(&kept);
}

static int end(void **state)
{
    fake_room_end(&again);
    fake_page_end(&eve);
    return room_end(state);
}

static void link_make(enum wire_member_role role, bool is_one_use, char token[33])
{
    struct problem problem = { 0 };
    assert_true(room_link_create(fake.room, role, 3600, is_one_use, fake.now_us, token, &problem));
}

static void come(struct fake_room *room, struct fake_page *page, const char *token, const char *person)
{
    fake_say(room, page, "{\"type\":\"hello\",\"protocol\":2,\"link\":\"%s\",\"person\":\"%s\"}", token, person);
}

/* The role of the member who entered last, "" where none did. */
static const char *role_of_last(const struct fake_page *page)
{
    static char text[32];
    cJSON *message = fake_heard(page, "members");
    const cJSON *list = cJSON_GetObjectItem(message, "members");
    const char *found = json_text(cJSON_GetArrayItem(list, cJSON_GetArraySize(list) - 1), "role");
    (void)snprintf(text, sizeof text, "%s", found ? found : "");
    cJSON_Delete(message);
    return text;
}

static void a_kept_link_gives_its_role(void **state)
{
    char token[33];
    (void)state;
    link_make(WIRE_MEMBER_ROLE_OBSERVER, false, token);
    wake(NULL);
    come(&again, &eve, token, "");
    assert_string_equal(role_of_last(&eve), "observer");
}

static void a_link_is_kept_as_a_hash(void **state)
{
    char token[33];
    struct store_room kept;
    (void)state;
    link_make(WIRE_MEMBER_ROLE_OBSERVER, false, token);
    assert_true(room_keep(fake.room, ROOM_LINKS, &kept));
    assert_int_equal(kept.n_links, 1);
    assert_true(secret_matches(token, kept.links[0].token_hash));
    const char *bytes = (const char *)kept.links;
    for (size_t i = 0; i + 8 <= sizeof kept.links[0]; i++)
        assert_memory_not_equal(bytes + i, token, 8);
    room_kept_finish(&kept);
    fake_room_start(&again, 3);
}

static void a_used_link_stays_used_but_for_its_person(void **state)
{
    char token[33];
    (void)state;
    link_make(WIRE_MEMBER_ROLE_REVIEWER, true, token);
    come(&fake, &ann, token, "0123");
    wake(NULL);
    come(&again, &eve, token, "4567");
    cJSON *bye = fake_heard(&eve, "bye");
    assert_string_equal(json_text(bye, "reason"),
                        "the link was for one person and has been used: ask for one of your own");
    cJSON_Delete(bye);
    fake_page_end(&eve);
    come(&again, &eve, token, "0123");
    assert_string_equal(role_of_last(&eve), "reviewer");
}

static void expire(struct store_room *kept)
{
    kept->links[0].expires_ms = (int64_t)time(NULL) * 1000 - 1000;
}

static void far_away(struct store_room *kept)
{
    kept->links[0].expires_ms = INT64_MAX;
}

static void a_link_expires_by_the_wall_clock(void **state)
{
    char token[33];
    (void)state;
    link_make(WIRE_MEMBER_ROLE_REVIEWER, false, token);
    wake(expire);
    come(&again, &eve, token, "");
    cJSON *bye = fake_heard(&eve, "bye");
    assert_string_equal(json_text(bye, "reason"), "the link has expired: ask for a new one");
    cJSON_Delete(bye);
}

static void no_link_is_valid_longer_than_any_can_be_made(void **state)
{
    char token[33];
    (void)state;
    link_make(WIRE_MEMBER_ROLE_REVIEWER, false, token);
    wake(far_away);
    struct store_room kept;
    assert_true(room_keep(again.room, ROOM_LINKS, &kept));
    assert_true(kept.links[0].expires_ms <= ((int64_t)time(NULL) + 30 /* a busy machine */ + ROOM_LINK_MAX_S) * 1000);
    room_kept_finish(&kept);
    fake_pass(&again, ROOM_LINK_MAX_S * INT64_C(1000));
    come(&again, &eve, token, "");
    assert_string_equal(role_of_last(&eve), "");
}

static void spoil(struct store_room *kept)
{
    (void)snprintf(kept->links[0].role, sizeof kept->links[0].role, "boss");
}

static void a_link_with_an_unknown_role_lets_nobody_in_and_still_guards_the_room(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    link_make(WIRE_MEMBER_ROLE_PRESENTER, false, token);
    wake(spoil);
    come(&again, &eve, token, "");
    assert_string_equal(role_of_last(&eve), "");
    assert_false(room_call_may(again.room, NULL, WIRE_RIGHT_CONTROL, &problem));
}

static void drop_links(struct store_room *kept)
{
    kept->n_links = 0;
}

static void calls_of_nobody_may_less_in_a_woken_room_that_had_links(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    assert_true(room_call_may(fake.room, NULL, WIRE_RIGHT_CONTROL, &problem));
    link_make(WIRE_MEMBER_ROLE_OBSERVER, false, token);
    wake(drop_links);
    assert_false(room_call_may(again.room, NULL, WIRE_RIGHT_CONTROL, &problem));
    assert_false(room_call_may(again.room, NULL, WIRE_RIGHT_SCENE, &problem));
    assert_true(room_call_may(again.room, NULL, WIRE_RIGHT_NOTE, &problem));
}

/* The member goes, and after a while is known alone: no more in the list of members. */
static void leave_for_long(struct fake_page *page)
{
    room_connection_closed(fake.room, page, fake.now_us);
    fake.again_us = room_settle(fake.room, fake.now_us);
    fake_pass(&fake, ROOM_MEMBER_KEPT_S * 1000 + 1000);
}

static void the_first_stranger_in_a_woken_room_is_a_reviewer(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    leave_for_long(&ann);
    wake(NULL);
    fake_hello(&again, &eve);
    assert_string_equal(role_of_last(&eve), "reviewer");
}

static void demote(struct store_room *kept)
{
    for (size_t i = 0; i < kept->n_members; i++)
        kept->members[i].role[0] = 0; /* as in a database from before there were roles */
}

static void where_no_presenter_is_known_the_first_stranger_becomes_one(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    leave_for_long(&ann);
    wake(demote);
    fake_hello(&again, &eve);
    assert_string_equal(role_of_last(&eve), "presenter");
}

static void strangers_do_not_crowd_the_presenter_out_of_who_is_known(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    leave_for_long(&ann);
    for (int i = 0; i < ROOM_MAX_KNOWN + 10; i++) {
        fake_hello(&fake, &ben);
        leave_for_long(&ben);
        fake_page_end(&ben);
    }
    wake(NULL);
    fake_hello(&again, &eve);
    assert_string_equal(role_of_last(&eve), "reviewer");
}

int main(void)
{
#define KEPT_TEST(name) cmocka_unit_test_setup_teardown(name, room_start, end)
    const struct CMUnitTest tests[] = {
        KEPT_TEST(a_kept_link_gives_its_role),
        KEPT_TEST(a_link_is_kept_as_a_hash),
        KEPT_TEST(a_used_link_stays_used_but_for_its_person),
        KEPT_TEST(a_link_expires_by_the_wall_clock),
        KEPT_TEST(no_link_is_valid_longer_than_any_can_be_made),
        KEPT_TEST(a_link_with_an_unknown_role_lets_nobody_in_and_still_guards_the_room),
        KEPT_TEST(calls_of_nobody_may_less_in_a_woken_room_that_had_links),
        KEPT_TEST(the_first_stranger_in_a_woken_room_is_a_reviewer),
        KEPT_TEST(where_no_presenter_is_known_the_first_stranger_becomes_one),
        KEPT_TEST(strangers_do_not_crowd_the_presenter_out_of_who_is_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
