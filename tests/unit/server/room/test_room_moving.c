/* Seats that are made for those who come from the room of another case of a meeting, and what the room asks of its
 * meeting: links, roles, who was removed. Random joins and leaves agree with a model. */
#include "server/room/state/room_state.h"
#include "tests/unit/people_set_up.h"

static struct problem problem;
static char id[64], secret[33];

static bool make(const struct room_seat *seat)
{
    const bool is_made = room_seat_make(fake.room, seat, fake.now_us, id, secret, &problem);
    fake.again_us = room_settle(fake.room, fake.now_us);
    return is_made;
}

/* A seat of who has signed in, without a link. */
static struct room_seat seat_of(const struct identity *who, const char *person)
{
    return (struct room_seat){ .name = who->name,
                               .user = who->user,
                               .link = "",
                               .person = person,
                               .color = 3,
                               .role = WIRE_MEMBER_ROLE_REVIEWER };
}

static void sit(struct fake_page *page, const struct identity *who, const char *with_secret)
{
    char more[160];
    (void)snprintf(more, sizeof more, ",\"member\":\"%s\",\"secret\":\"%s\",\"person\":\"p1\"", id, with_secret);
    say_hello(page, who, more);
}

static bool presents(const struct fake_page *page, const char *member)
{
    cJSON *message = fake_heard(page, "members"), *row;
    bool is_so = false;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(message, "members")) is_so =
        is_so || (strcmp(json_text(row, "id"), member) == 0 && json_flag(row, "presenting", false));
    cJSON_Delete(message);
    return is_so;
}

/* ---- seats ------------------------------------------------------------------------------------------------------ */

static void a_seat_is_taken_with_its_secret_alone(void **state)
{
    const struct room_seat seat = {
        .name = "Ann", .user = "", .link = "", .person = "", .role = WIRE_MEMBER_ROLE_REVIEWER
    };
    (void)state;
    assert_true(make(&seat));
    sit(&ann, NULL, "0123456789abcdef0123456789abcdef");
    assert_string_not_equal(heard(&ann, "welcome", "member"), id); /* somebody new */
    sit(&ben, NULL, secret);
    assert_string_equal(heard(&ben, "welcome", "member"), id);
    assert_string_equal(heard(&ben, "welcome", "name"), "Ann");
}

static void the_presenter_presents_before_it_has_come_and_half_a_minute_long(void **state)
{
    const struct room_seat seat = {
        .name = "Pat", .user = "", .link = "", .person = "", .role = WIRE_MEMBER_ROLE_PRESENTER, .presents = true
    };
    (void)state;
    assert_true(make(&seat));
    fake_hello(&fake, &ben); /* comes first, and does not become the presenter */
    assert_true(presents(&ben, id));
    fake_pass(&fake, 29000);
    assert_true(presents(&ben, id));
    fake_pass(&fake, 2000);
    assert_false(presents(&ben, id));
}

static void a_wall_is_waited_for_a_minute(void **state)
{
    const struct room_seat seat = {
        .name = "Wall 1", .user = "", .link = "", .person = "", .role = WIRE_MEMBER_ROLE_WALL
    };
    struct room_present present;
    (void)state;
    assert_true(make(&seat));
    fake_pass(&fake, 59000);
    assert_true(room_present_at(fake.room, 0, &present));
    fake_pass(&fake, 2000);
    assert_false(room_present_at(fake.room, 0, &present));
}

static void who_comes_again_gets_the_seat_of_before_with_another_secret(void **state)
{
    const struct room_seat seat = {
        .name = "Ann", .user = "", .link = "", .person = "p1", .role = WIRE_MEMBER_ROLE_REVIEWER
    };
    char before[64], old_secret[33];
    (void)state;
    assert_true(make(&seat));
    sit(&ann, NULL, secret);
    struct room_present present;
    assert_true(room_present_of(fake.room, &ann, &present));
    char person[300];
    (void)snprintf(person, sizeof person, "%s", present.person);
    room_connection_closed(fake.room, &ann, fake.now_us);
    (void)snprintf(before, sizeof before, "%s", id);
    (void)snprintf(old_secret, sizeof old_secret, "%s", secret);
    struct room_seat of_same = seat;
    of_same.person = person;
    assert_true(make(&of_same));
    assert_string_equal(id, before);
    assert_string_not_equal(secret, old_secret);
    assert_true(make(&of_same)); /* another tab of the same person: the first one is expected on that seat */
    assert_string_not_equal(id, before);
}

static void a_full_room_says_so(void **state)
{
    struct room_seat seat = { .name = "Ann", .user = "", .link = "", .person = "", .role = WIRE_MEMBER_ROLE_REVIEWER };
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake_hello(&fake, &cem); /* of three */
    assert_false(make(&seat));
    assert_int_equal(problem.type, PROBLEM_LIMIT);
}

/* ---- what the room asks of its meeting --------------------------------------------------------------------------- */

static bool link_is_ended;
static char barred_user[65];

static bool meeting_link(void *context, const struct room *room, const struct identity *who, const char *token,
                         struct room_meeting_link *found)
{
    (void)context;
    (void)room;
    (void)who;
    if (link_is_ended || strcmp(token, "of-the-meeting") != 0)
        return false;
    *found = (struct room_meeting_link){ .role = WIRE_MEMBER_ROLE_PRESENTER, .allows_guests = true, .maker = "pat" };
    memset(found->token_hash, 0xab, sizeof found->token_hash);
    return true;
}

static bool link_over(void *context, const struct room *room, const char *digits)
{
    (void)context;
    (void)room;
    return link_is_ended && strcmp(digits, "abababab") == 0;
}

static bool meeting_role(void *context, const struct room *room, const struct identity *who,
                         enum wire_member_role *role)
{
    (void)context;
    (void)room;
    *role = WIRE_MEMBER_ROLE_OBSERVER;
    return strcmp(who->user, "rae") == 0 || strcmp(who->user, "zoe") == 0;
}

static void meeting_barred(void *context, const struct room *room, const char *user, const char *link)
{
    (void)context;
    (void)room;
    (void)link;
    (void)snprintf(barred_user, sizeof barred_user, "%s", user);
}

static void entered(void *context, struct room *room, void *connection)
{
    (void)context;
    (void)room;
    (void)connection;
}

static const struct room_meeting_callbacks meeting = {
    .link = meeting_link, .link_is_over = link_over, .role = meeting_role, .barred = meeting_barred, .entered = entered
};

static int meeting_start(void **state)
{
    link_is_ended = false;
    barred_user[0] = 0;
    const int failed = people_start(state);
    fake.room->callbacks.meeting = &meeting;
    return failed;
}
#define MEETING_TEST(name) cmocka_unit_test_setup_teardown(name, meeting_start, room_end)

static void who_is_asked_to_the_meeting_comes_in_with_no_more_than_plan_and_meeting_give(void **state)
{
    struct room_present present;
    (void)state;
    say_hello(&ann, &rae, "");
    assert_true(room_present_of(fake.room, &ann, &present));
    assert_int_equal(present.role, WIRE_MEMBER_ROLE_OBSERVER);
    say_hello(&ben, &zoe, ""); /* is asked, and has no role on the plan */
    expect_refused(&ben, "", "the room is closed");
    say_hello(&cem, &oli, ""); /* has a role, and is not asked */
    expect_refused(&cem, "", "the room is closed");
}

static void a_link_of_the_meeting_lets_in_guests_as_guests_until_it_ends(void **state)
{
    struct room_present present;
    (void)state;
    by_link(&ann, &nobody, "of-the-meeting");
    assert_true(room_present_of(fake.room, &ann, &present));
    assert_true(present.is_guest);
    assert_int_equal(present.role, WIRE_MEMBER_ROLE_REVIEWER); /* of guests the highest */
    assert_string_equal(present.link, "abababab");
    (void)snprintf(id, sizeof id, "%s", heard(&ann, "welcome", "member"));
    (void)snprintf(secret, sizeof secret, "%s", heard(&ann, "welcome", "secret"));
    link_is_ended = true;
    assert_int_equal(room_remove_of_link(fake.room, "abababab", fake.now_us), 1);
    sit(&ben, &nobody, secret);
    assert_false(room_present_of(fake.room, &ben, &present));
    by_link(&cem, &nobody, "of-the-meeting");
    assert_false(room_present_of(fake.room, &cem, &present));
}

static void who_is_removed_is_told_to_the_meeting_and_does_not_come_back_by_its_link(void **state)
{
    struct room_present present;
    (void)state;
    say_hello(&ann, &pat, "");
    by_link(&ben, &rae, "of-the-meeting");
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"%s\"}", me(&ben));
    assert_string_equal(barred_user, "rae");
    by_link(&cem, &rae, "of-the-meeting");
    assert_false(room_present_of(fake.room, &cem, &present));
}

static void a_seat_is_its_persons_alone(void **state)
{
    struct room_present present;
    const struct room_seat seat = seat_of(&rae, "user:rae");
    (void)state;
    assert_true(make(&seat));
    sit(&ann, &oli, secret);
    assert_false(room_present_of(fake.room, &ann, &present));
    sit(&ben, &nobody, secret);
    assert_false(room_present_of(fake.room, &ben, &present));
    sit(&cem, &rae, secret);
    assert_true(room_present_of(fake.room, &cem, &present));
    assert_int_equal(present.color, 3);
}

/* ---- at random --------------------------------------------------------------------------------------------------- */

enum { N_PAGES = 3, N_STEPS = 400 };

/* Each page's newest seat, and whether somebody sits on it. */
struct model {
    char id[64], secret[33];
    bool has_seat, sits;
};

static void random_joins_and_leaves_agree_with_the_model(void **state)
{
    struct fake_page *const pages[N_PAGES] = { &ann, &ben, &cem };
    struct model model[N_PAGES] = { { .has_seat = false } };
    uint32_t seed = 7;
    (void)state;
    for (int step = 0; step < N_STEPS; step++) {
        seed = seed * 1664525u + 1013904223u;
        const unsigned i = (seed >> 8) % N_PAGES, what = (seed >> 16) % 4;
        char person[8];
        (void)snprintf(person, sizeof person, "p%u", i);
        const struct room_seat seat = {
            .name = person, .user = "", .link = "", .person = person, .role = WIRE_MEMBER_ROLE_REVIEWER
        };
        if (what == 0 && !model[i].sits) {
            assert_true(make(&seat));
            model[i].has_seat = true;
            (void)snprintf(model[i].id, sizeof model[i].id, "%s", id);
            (void)snprintf(model[i].secret, sizeof model[i].secret, "%s", secret);
        } else if (what == 1 && model[i].has_seat && !model[i].sits) {
            (void)snprintf(id, sizeof id, "%s", model[i].id);
            fake_page_end(pages[i]);
            char more[160];
            (void)snprintf(more, sizeof more, ",\"member\":\"%s\",\"secret\":\"%s\",\"person\":\"%s\"", id,
                           model[i].secret, person);
            say_hello(pages[i], NULL, more);
            assert_string_equal(heard(pages[i], "welcome", "member"), model[i].id);
            model[i].sits = true;
        } else if (what == 2 && model[i].sits) {
            room_connection_closed(fake.room, pages[i], fake.now_us);
            model[i].sits = false;
        } else {
            fake_pass(&fake, 1000 * ((seed >> 20) % 120));
        }
        size_t n_sit = 0;
        for (size_t k = 0; k < N_PAGES; k++)
            n_sit += model[k].sits;
        assert_int_equal(room_n_connected(fake.room), n_sit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_seat_is_taken_with_its_secret_alone),
        ROOM_TEST(the_presenter_presents_before_it_has_come_and_half_a_minute_long),
        ROOM_TEST(a_wall_is_waited_for_a_minute),
        ROOM_TEST(who_comes_again_gets_the_seat_of_before_with_another_secret),
        ROOM_TEST(a_full_room_says_so),
        MEETING_TEST(who_is_asked_to_the_meeting_comes_in_with_no_more_than_plan_and_meeting_give),
        MEETING_TEST(a_link_of_the_meeting_lets_in_guests_as_guests_until_it_ends),
        MEETING_TEST(who_is_removed_is_told_to_the_meeting_and_does_not_come_back_by_its_link),
        MEETING_TEST(a_seat_is_its_persons_alone),
        ROOM_TEST(random_joins_and_leaves_agree_with_the_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
