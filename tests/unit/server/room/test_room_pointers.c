/* Pointers and "look here": who hears of them, how often, and when they end. */
#include "server/room/people/look.h"
#include "server/room/people/pointers.h"
#include "server/room/state/room_state.h"
#include "tests/unit/room_set_up.h"

static void point(struct fake_page *page, int x)
{
    fake_say(&fake, page, "{\"type\":\"pointer\",\"view\":2,\"point_mm\":[%d,-20.5,30]}", x);
}

static void stop_pointing(struct fake_page *page)
{
    fake_say(&fake, page, "{\"type\":\"pointer\",\"point_mm\":null}");
}

static void ask(struct fake_page *page, int x)
{
    fake_say(&fake, page, "{\"type\":\"look.here\",\"point_mm\":[%d,0,0]}", x);
}

static void come(struct fake_page *page, int number)
{
    fake_say(&fake, page, "{\"type\":\"look.come\",\"number\":%d}", number);
}

/* x of the newest place told, in mm; -999: none was told, -998: the newest says that it is over. */
static double told_x(const struct fake_page *page, const char *type)
{
    cJSON *said = fake_heard(page, type);
    const cJSON *at = cJSON_GetObjectItem(said, "point_mm");
    double x = !said ? -999 : cJSON_IsNull(at) ? -998 : cJSON_GetArrayItem(at, 0)->valuedouble;
    cJSON_Delete(said);
    return x;
}

/* "m2 m3": who came, as told last. */
static const char *came(const struct fake_page *page)
{
    static char text[64];
    cJSON *said = fake_heard(page, "look");
    const cJSON *id;
    text[0] = 0;
    cJSON_ArrayForEach(id, cJSON_GetObjectItem(said, "came"))
    {
        size_t n = strlen(text);
        (void)snprintf(text + n, sizeof text - n, "%s%s", n ? " " : "", id->valuestring);
    }
    cJSON_Delete(said);
    return text;
}

static void meet(void)
{
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake_hello(&fake, &cem);
}

static void all_others_hear_where_a_member_points_and_the_scene_stays(void **state)
{
    (void)state;
    meet();
    uint32_t before, now;
    (void)room_scene(fake.room, &before);
    point(&ben, 12);
    assert_string_equal(heard(&ann, "pointer.at", "member"), "m2");
    cJSON *said = fake_heard(&cem, "pointer.at");
    const cJSON *at = cJSON_GetObjectItem(said, "point_mm");
    assert_float_equal(cJSON_GetArrayItem(at, 0)->valuedouble, 12, 0);
    assert_float_equal(cJSON_GetArrayItem(at, 1)->valuedouble, -20.5, 0);
    assert_float_equal(json_number(said, "view", 0), 2, 0);
    cJSON_Delete(said);
    assert_int_equal(fake_n_heard(&ben, "pointer.at"), 0);
    (void)room_scene(fake.room, &now);
    assert_int_equal(now, before);
}

static void a_member_is_passed_on_at_most_thirty_times_a_second_and_the_newest_place_always(void **state)
{
    (void)state;
    meet();
    for (int i = 0; i < 1000; i++) { /* one second of a pointer that moves every millisecond */
        point(&ann, i);
        fake_pass(&fake, 1);
    }
    size_t n = fake_n_heard(&ben, "pointer.at");
    assert_in_range(n, 29, 1000 / POINTER_EVERY_MS + 1);
    fake_pass(&fake, POINTER_EVERY_MS);
    assert_float_equal(told_x(&ben, "pointer.at"), 999, 0);
    assert_true(fake_n_heard(&ben, "pointer.at") <= n + 1);
}

static void with_many_who_point_each_is_passed_on_less_often(void **state)
{
    enum { N = 32 };
    static struct fake_page many[N];
    (void)state;
    fake_room_end(&fake);
    fake_room_start(&fake, ROOM_MAX_MEMBERS);
    fake_hello(&fake, &ann);
    for (int i = 0; i < N; i++)
        fake_hello(&fake, &many[i]);
    for (int turn = 0; turn < 100; turn++, fake_pass(&fake, 10)) /* one second */
        for (int i = 0; i < N; i++)
            point(&many[i], turn);
    /* 32 who point times 33 members are 2.06 of 512: 16.2 a second of each; the first may come at once, the last waits
     */
    assert_in_range(fake_n_heard(&ann, "pointer.at"), 14 * N, 18 * N);
    for (int i = 0; i < N; i++)
        fake_page_end(&many[i]);
}

static void a_slow_receiver_is_left_with_the_newest_place_of_each(void **state)
{
    (void)state;
    meet();
    cem.is_slow = true;
    cem.n_read = cem.n_texts;
    size_t before = cem.n_texts;
    for (int i = 0; i < 50; i++, fake_pass(&fake, 40)) {
        point(&ann, i);
        point(&ben, -i);
    }
    assert_int_equal(cem.n_texts, before + 2);
    assert_true(fake_n_heard(&ben, "pointer.at") >= 50);
    assert_float_equal(told_x(&ben, "pointer.at"), 49, 0);
    cJSON *first = json_read(cem.texts[before], strlen(cem.texts[before]), NULL);
    assert_string_equal(json_text(first, "member"), "m1");
    assert_float_equal(cJSON_GetArrayItem(cJSON_GetObjectItem(first, "point_mm"), 0)->valuedouble, 49, 0);
    cJSON_Delete(first);
}

static void a_pointer_ends_when_asked_when_it_rests_and_when_its_member_leaves(void **state)
{
    (void)state;
    meet();
    point(&ann, 1);
    fake_pass(&fake, 100);
    stop_pointing(&ann);
    assert_float_equal(told_x(&ben, "pointer.at"), -998, 0);
    size_t n = fake_n_heard(&ben, "pointer.at");
    fake_pass(&fake, 100);
    stop_pointing(&ann); /* nothing to end */
    fake_pass(&fake, 2 * POINTER_KEPT_MS);
    assert_int_equal(fake_n_heard(&ben, "pointer.at"), n);

    point(&ann, 2);
    fake_pass(&fake, POINTER_KEPT_MS - 100);
    point(&ann, 2); /* the same place is no movement */
    assert_float_equal(told_x(&ben, "pointer.at"), 2, 0);
    fake_pass(&fake, 200);
    assert_float_equal(told_x(&ben, "pointer.at"), -998, 0);

    point(&ann, 3);
    assert_float_equal(told_x(&ben, "pointer.at"), 3, 0);
    room_connection_closed(fake.room, &ann, fake.now_us);
    assert_float_equal(told_x(&ben, "pointer.at"), -998, 0);
    assert_string_equal(heard(&ben, "pointer.at", "member"), "m1");
}

static void who_comes_later_is_told_what_others_point_at(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    point(&ann, 7);
    ask(&ben, 9);
    fake_hello(&fake, &cem);
    assert_float_equal(told_x(&cem, "pointer.at"), 7, 0);
    assert_float_equal(told_x(&cem, "look"), 9, 0);
    assert_string_equal(heard(&cem, "look", "by"), "m2");
}

static void a_point_beyond_the_bounds_is_refused_and_the_pointer_stays(void **state)
{
    (void)state;
    meet();
    point(&ann, 100000);
    point(&ann, 100001);
    assert_string_equal(refused(&ann), "422 /point_mm/0");
    fake_say(&fake, &ann, "{\"type\":\"pointer\",\"point_mm\":[0,0,1e999]}");
    assert_string_equal(refused(&ann), "422 /point_mm/2");
    fake_say(&fake, &ann, "{\"type\":\"pointer\",\"view\":9,\"point_mm\":[0,0,0]}");
    assert_string_equal(refused(&ann), "422 /view");
    fake_say(&fake, &ann, "{\"type\":\"look.here\",\"point_mm\":[0,-100001,0]}");
    assert_string_equal(refused(&ann), "422 /point_mm/1");
    fake_pass(&fake, 100);
    assert_float_equal(told_x(&ben, "pointer.at"), 100000, 0);
    assert_int_equal(fake_n_heard(&ben, "look"), 0);
}

static void an_observer_does_not_point_and_does_not_ask_but_comes(void **state)
{
    (void)state;
    meet();
    fake.room->members.list[1]->role = WIRE_MEMBER_ROLE_OBSERVER;
    point(&ben, 1);
    assert_string_equal(refused(&ben), "403 ");
    ask(&ben, 1);
    assert_string_equal(refused(&ben), "403 ");
    assert_int_equal(fake_n_heard(&ann, "pointer.at") + fake_n_heard(&ann, "look"), 0);
    point(&ann, 1);
    assert_float_equal(told_x(&ben, "pointer.at"), 1, 0);
    ask(&ann, 2);
    come(&ben, 1);
    fake_pass(&fake, LOOK_EVERY_MS);
    assert_string_equal(came(&ann), "m2");
}

static void who_asks_to_look_sees_who_came(void **state)
{
    (void)state;
    meet();
    ask(&ann, 5);
    assert_float_equal(told_x(&ben, "look"), 5, 0);
    assert_float_equal(told_x(&ann, "look"), 5, 0); /* the asker too */
    come(&ben, 1);
    come(&ben, 1);
    come(&ann, 1); /* is there already */
    come(&cem, 7); /* no such request */
    fake_pass(&fake, LOOK_EVERY_MS);
    assert_string_equal(came(&ann), "m2");
    come(&cem, 1);
    fake_pass(&fake, LOOK_EVERY_MS);
    assert_string_equal(came(&ann), "m2 m3");
    assert_int_equal(fake_n_heard(&ann, "look"), 3);
}

static void one_request_stands_at_a_time(void **state)
{
    (void)state;
    meet();
    ask(&ann, 5);
    come(&cem, 1);
    fake_pass(&fake, LOOK_EVERY_MS);
    ask(&ben, 6);
    fake_pass(&fake, LOOK_EVERY_MS);
    assert_string_equal(heard(&cem, "look", "by"), "m2");
    assert_string_equal(came(&ben), "");
    come(&cem, 1); /* the old one */
    fake_pass(&fake, LOOK_EVERY_MS);
    assert_string_equal(came(&ben), "");
    fake_say(&fake, &ann, "{\"type\":\"look.here\",\"point_mm\":null}"); /* not hers any more */
    assert_float_equal(told_x(&cem, "look"), 6, 0);
    fake_say(&fake, &ben, "{\"type\":\"look.here\",\"point_mm\":null}");
    assert_float_equal(told_x(&cem, "look"), -998, 0);
}

static void a_request_ends_after_its_time_and_when_the_asker_leaves(void **state)
{
    (void)state;
    meet();
    ask(&ann, 5);
    fake_pass(&fake, LOOK_KEPT_S * 1000 - 1);
    assert_float_equal(told_x(&ben, "look"), 5, 0);
    fake_pass(&fake, 1);
    assert_float_equal(told_x(&ben, "look"), -998, 0);
    ask(&ann, 8);
    fake_pass(&fake, LOOK_EVERY_MS);
    room_connection_closed(fake.room, &ben, fake.now_us);
    assert_float_equal(told_x(&cem, "look"), 8, 0);
    room_connection_closed(fake.room, &ann, fake.now_us);
    assert_float_equal(told_x(&cem, "look"), -998, 0);
}

static void a_flood_of_requests_is_told_a_few_times_a_second(void **state)
{
    (void)state;
    meet();
    for (int i = 0; i < 1000; i++) {
        ask(&ann, i);
        fake_pass(&fake, 1);
    }
    assert_true(fake_n_heard(&ben, "look") <= 1000 / LOOK_EVERY_MS + 1);
    fake_pass(&fake, LOOK_EVERY_MS);
    assert_float_equal(told_x(&ben, "look"), 999, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(all_others_hear_where_a_member_points_and_the_scene_stays),
        ROOM_TEST(a_member_is_passed_on_at_most_thirty_times_a_second_and_the_newest_place_always),
        ROOM_TEST(with_many_who_point_each_is_passed_on_less_often),
        ROOM_TEST(a_slow_receiver_is_left_with_the_newest_place_of_each),
        ROOM_TEST(a_pointer_ends_when_asked_when_it_rests_and_when_its_member_leaves),
        ROOM_TEST(who_comes_later_is_told_what_others_point_at),
        ROOM_TEST(a_point_beyond_the_bounds_is_refused_and_the_pointer_stays),
        ROOM_TEST(an_observer_does_not_point_and_does_not_ask_but_comes),
        ROOM_TEST(who_asks_to_look_sees_who_came),
        ROOM_TEST(one_request_stands_at_a_time),
        ROOM_TEST(a_request_ends_after_its_time_and_when_the_asker_leaves),
        ROOM_TEST(a_flood_of_requests_is_told_a_few_times_a_second),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
