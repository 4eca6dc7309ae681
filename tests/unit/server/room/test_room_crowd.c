/* A room as full as it may be: what the list of members costs, that one picture serves everybody, and what one who
 * shows nothing does to the others. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/room_fake.h"

static struct fake_room room;
static struct fake_page *pages; /* [ROOM_MAX_MEMBERS] */

static int start(void **state)
{
    (void)state;
    pages = calloc(ROOM_MAX_MEMBERS, sizeof *pages);
    assert_non_null(pages);
    fake_room_start(&room, ROOM_MAX_MEMBERS);
    fake_plan_ready(&room, true);
    return 0;
}

static int end(void **state)
{
    (void)state;
    fake_room_end(&room);
    for (int i = 0; i < ROOM_MAX_MEMBERS; i++)
        fake_page_end(&pages[i]);
    free(pages);
    return 0;
}

static void everybody_joins(int64_t pause_ms)
{
    for (int i = 0; i < ROOM_MAX_MEMBERS; i++) { /* the first one presents */
        fake_join(&room, &pages[i], true);
        fake_pass(&room, pause_ms);
    }
}

static int n_listed(const struct fake_page *page)
{
    cJSON *newest = fake_heard(page, "members");
    int n = cJSON_GetArraySize(cJSON_GetObjectItem(newest, "members"));
    cJSON_Delete(newest);
    return n;
}

static size_t n_list_bytes(const struct fake_page *page)
{
    size_t n = 0;
    for (size_t i = 0; i < page->n_texts; i++)
        if (strstr(page->texts[i], "\"type\":\"members\""))
            n += strlen(page->texts[i]);
    return n;
}

static void who_enters_hears_at_once_who_is_there(void **state)
{
    (void)state;
    fake_hello(&room, &pages[0]);
    for (int i = 1; i < ROOM_MAX_MEMBERS; i++) {
        fake_hello(&room, &pages[i]);
        assert_int_equal(n_listed(&pages[i]), i + 1);
    }
    fake_pass(&room, 1000);
    for (int i = 0; i < ROOM_MAX_MEMBERS; i++)
        assert_int_equal(n_listed(&pages[i]), ROOM_MAX_MEMBERS);
}

/* 200 people enter within two seconds, each with a hello and a view that follows: 400 changes. Lists may take at most
 * half of what may wait on a connection (4 MiB, 256 messages), so that no slow reader is cut for them. */
static void lists_of_a_full_room_do_not_overrun_a_slow_reader(void **state)
{
    (void)state;
    everybody_joins(10);
    fake_pass(&room, 1000);
    for (int i = 0; i < ROOM_MAX_MEMBERS; i++) {
        assert_int_equal(n_listed(&pages[i]), ROOM_MAX_MEMBERS);
        assert_in_range(fake_n_heard(&pages[i], "members"), 1, 128);
        assert_in_range(n_list_bytes(&pages[i]), 1, 2 << 20);
    }
}

static void a_small_room_hears_of_each_change_at_once(void **state)
{
    (void)state;
    for (int i = 0; i < 20; i++) {
        fake_hello(&room, &pages[i]);
        for (int k = 0; k <= i; k++)
            assert_int_equal(n_listed(&pages[k]), i + 1);
    }
}

/* Draws what is outstanding; everybody but the first n_silent followers shows it. */
static void draw_and_show(int n_silent)
{
    for (struct fake_request *request; (request = fake_oldest(&room));)
        fake_draw(&room, request);
    for (int i = 0; i < ROOM_MAX_MEMBERS; i++)
        if ((i == 0 || i > n_silent) && pages[i].n_frames)
            fake_shown(&room, &pages[i]);
}

static void one_picture_serves_all_and_who_shows_none_is_sent_two(void **state)
{
    enum { N_SILENT = 3, N_TURNS = 40 };
    (void)state;
    everybody_joins(0);
    for (int turn = 0; turn < 10; turn++) { /* until the stills are there */
        draw_and_show(0);
        fake_pass(&room, 100);
    }
    size_t n_requests = room.n_requests, n_frames[ROOM_MAX_MEMBERS];
    for (int i = 0; i < ROOM_MAX_MEMBERS; i++)
        n_frames[i] = pages[i].n_frames;
    for (unsigned turn = 1; turn <= N_TURNS; turn++) {
        fake_turn(&room, &pages[0], (int)turn, turn);
        draw_and_show(N_SILENT);
        fake_pass(&room, 40);
    }
    assert_in_range(room.n_requests - n_requests, 1, 2 * N_TURNS); /* not one for each follower */
    size_t n_least = pages[0].n_frames - n_frames[0];
    assert_in_range(n_least, N_TURNS / 2, 2 * N_TURNS);
    for (int i = 1; i < ROOM_MAX_MEMBERS; i++)
        if (i <= N_SILENT)
            assert_int_equal(pages[i].n_frames - n_frames[i], ROOM_MAX_UNSHOWN);
        else
            assert_in_range(pages[i].n_frames - n_frames[i], n_least - 2, n_least + 2);
    assert_int_equal(room_n_connected(room.room), ROOM_MAX_MEMBERS);
}

#define CROWD_TEST(name) cmocka_unit_test_setup_teardown(name, start, end)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CROWD_TEST(who_enters_hears_at_once_who_is_there),
        CROWD_TEST(lists_of_a_full_room_do_not_overrun_a_slow_reader),
        CROWD_TEST(a_small_room_hears_of_each_change_at_once),
        CROWD_TEST(one_picture_serves_all_and_who_shows_none_is_sent_two),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
