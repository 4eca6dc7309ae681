/* Messages to members about the server's disk, and how often they come. */
#include "tests/unit/room_set_up.h"

#include "server/room/out/saved.h"

static void disk(enum wire_saved_state state, uint32_t revision)
{
    fake.saved = (struct room_saved){ .state = state, .revision = revision };
    fake.again_us = room_settle(fake.room, fake.now_us);
}

/* State and revision of the newest message, as "saved 3"; "": none came. */
static const char *told(const struct fake_page *page)
{
    static char text[64];
    cJSON *message = fake_heard(page, "saved");
    (void)snprintf(text, sizeof text, "%s %d", message ? json_text(message, "state") : "",
                   (int)json_number(message, "revision", 0));
    cJSON_Delete(message);
    return text;
}

static const char *code(const struct fake_page *page)
{
    static char text[64];
    cJSON *message = fake_heard(page, "saved");
    const char *found = json_text(cJSON_GetObjectItem(message, "problem"), "code");
    (void)snprintf(text, sizeof text, "%s", found ? found : "");
    cJSON_Delete(message);
    return text;
}

static void put_note(void)
{
    fake_say(&fake, &ann, "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"here\"}}");
}

static void who_comes_is_told_at_once(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    assert_string_equal(told(&ann), "unkept 0");
    fake_pass(&fake, 100000);
    assert_int_equal(fake_n_heard(&ann, "saved"), 1);
    disk(WIRE_SAVED_STATE_FAILING, 4);
    fake_hello(&fake, &ben);
    assert_string_equal(told(&ben), "failing 4");
}

static void a_change_that_is_on_disk_soon_takes_one_message(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 1);
    fake_pass(&fake, 5000);
    size_t before = fake_n_heard(&ann, "saved");
    disk(WIRE_SAVED_STATE_SAVING, 1);
    fake_pass(&fake, 250);
    assert_int_equal(fake_n_heard(&ann, "saved"), before);
    disk(WIRE_SAVED_STATE_SAVED, 2);
    assert_int_equal(fake_n_heard(&ann, "saved"), before + 1);
    assert_string_equal(told(&ann), "saved 2");
    fake_pass(&fake, 100000);
    assert_int_equal(fake_n_heard(&ann, "saved"), before + 1);
}

static void many_changes_take_a_message_each_second_and_the_last_one_is_told(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 1);
    fake_pass(&fake, 5000);
    size_t before = fake_n_heard(&ann, "saved");
    for (uint32_t i = 2; i <= 101; i++) { /* ten seconds */
        disk(i % 2 ? WIRE_SAVED_STATE_SAVED : WIRE_SAVED_STATE_SAVING, i);
        fake_pass(&fake, 100);
    }
    assert_in_range(fake_n_heard(&ann, "saved") - before, 9, 11);
    fake_pass(&fake, SAVED_EVERY_MS);
    assert_string_equal(told(&ann), "saved 101");
}

static void a_slow_disk_is_told_as_saving(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 1);
    fake_pass(&fake, 5000);
    disk(WIRE_SAVED_STATE_SAVING, 1);
    fake_pass(&fake, SAVED_EVERY_MS + 1);
    assert_string_equal(told(&ann), "saving 1");
}

static void an_item_that_is_on_disk_is_told_though_the_scene_is_the_same(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 1);
    fake_pass(&fake, 5000);
    size_t before = fake_n_heard(&ann, "saved");
    fake.saved.state = WIRE_SAVED_STATE_SAVING;
    put_note();
    disk(WIRE_SAVED_STATE_SAVED, 1);
    assert_int_equal(fake_n_heard(&ann, "saved"), before + 1);
}

static void who_came_while_it_was_written_is_told_when_it_is_done(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 1);
    fake_pass(&fake, 5000);
    fake.saved.state = WIRE_SAVED_STATE_SAVING;
    fake_hello(&fake, &ben);
    assert_string_equal(told(&ben), "saving 1");
    disk(WIRE_SAVED_STATE_SAVED, 1); /* as all were told before */
    fake_pass(&fake, SAVED_EVERY_MS);
    assert_string_equal(told(&ben), "saved 1");
}

static void what_an_empty_room_told_nobody_delays_nothing(void **state)
{
    (void)state;
    disk(WIRE_SAVED_STATE_SAVED, 1); /* news, and nobody hears it */
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 2);
    assert_string_equal(told(&ann), "saved 2");
}

static void a_full_disk_is_told_at_once_and_so_is_its_end(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    disk(WIRE_SAVED_STATE_SAVED, 1);
    fake_pass(&fake, 5000);
    disk(WIRE_SAVED_STATE_SAVED, 2);
    fake_pass(&fake, 10);
    fake.saved.is_full = true;
    fake.saved.state = WIRE_SAVED_STATE_FAILING;
    fake.again_us = room_settle(fake.room, fake.now_us);
    assert_string_equal(told(&ann), "failing 2");
    assert_string_equal(code(&ann), "full");
    put_note(); /* the room goes on */
    assert_int_equal(fake_n_heard(&ann, "item"), 1);
    disk(WIRE_SAVED_STATE_FAILING, 2);
    fake_pass(&fake, SAVED_EVERY_MS);
    assert_string_equal(code(&ann), "write"); /* another reason */
    disk(WIRE_SAVED_STATE_SAVED, 3);
    assert_string_equal(told(&ann), "saved 3");
    assert_string_equal(code(&ann), "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(who_comes_is_told_at_once),
        ROOM_TEST(a_change_that_is_on_disk_soon_takes_one_message),
        ROOM_TEST(many_changes_take_a_message_each_second_and_the_last_one_is_told),
        ROOM_TEST(a_slow_disk_is_told_as_saving),
        ROOM_TEST(an_item_that_is_on_disk_is_told_though_the_scene_is_the_same),
        ROOM_TEST(who_came_while_it_was_written_is_told_when_it_is_done),
        ROOM_TEST(what_an_empty_room_told_nobody_delays_nothing),
        ROOM_TEST(a_full_disk_is_told_at_once_and_so_is_its_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
