/* Size classes: who is sent a shared picture whole, who a half or a quarter; and that nobody's pane makes it be drawn
 * or compressed again. */
#include <stdlib.h>

#include "server/room/streams/lag.h"
#include "tests/unit/room_fake.h"

enum { N_PAGES = 12, WIDTH = 1440, HEIGHT = 900 };

static struct fake_room fake;
static struct fake_page *pages; /* [N_PAGES]; the first presents */

static int start(void **state)
{
    (void)state;
    pages = calloc(N_PAGES, sizeof *pages);
    assert_non_null(pages);
    fake_room_start(&fake, N_PAGES);
    fake_plan_ready(&fake, true);
    return 0;
}

static int end(void **state)
{
    (void)state;
    fake_room_end(&fake);
    for (int i = 0; i < N_PAGES; i++)
        fake_page_end(&pages[i]);
    free(pages);
    return 0;
}

static void join(int i, int width_px, int height_px, bool follow)
{
    fake_hello(&fake, &pages[i]);
    fake_say(&fake, &pages[i], "{\"type\":\"view.open\",\"view\":1,\"document\":{\"size_px\":[%d,%d]},\"follow\":%s}",
             width_px, height_px, follow ? "true" : "false");
}

static void resize(int i, int width_px, int height_px)
{
    fake_say(&fake, &pages[i], "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"size_px\":[%d,%d]}}", width_px,
             height_px);
}

static void settle(void)
{
    struct fake_page *all[N_PAGES];
    for (int i = 0; i < N_PAGES; i++)
        all[i] = &pages[i];
    fake_settle(&fake, all, N_PAGES);
}

static const struct frame_header *newest(int i)
{
    assert_true(pages[i].n_frames > 0);
    return &pages[i].frames[pages[i].n_frames - 1];
}

/* Turns the shared camera and draws until it rests. */
static void turn(void)
{
    static int degrees;
    fake_turn(&fake, &pages[0], ++degrees, 0);
    settle();
}

/* A pane of 720 x 900 shows 1440 x 900 as 720 x 450, one of 721 x 900 as 721 x 451: by hand. */
static void everybody_gets_the_smallest_picture_with_a_pixel_for_each_pixel_shown(void **state)
{
    static const struct {
        int width_px, height_px, sent_px;
    } cases[] = { { 1440, 900, 1440 }, { 4096, 4096, 1440 }, { 721, 900, 1440 }, { 720, 900, 720 },
                  { 2000, 451, 1440 }, { 2000, 450, 720 },   { 361, 900, 720 },  { 360, 900, 360 },
                  { 1440, 225, 360 },  { 390, 220, 360 },    { 16, 16, 360 } };
    const int n = sizeof cases / sizeof cases[0];
    (void)state;
    assert_true(n < N_PAGES);
    join(0, WIDTH, HEIGHT, true);
    for (int i = 0; i < n; i++)
        join(i + 1, cases[i].width_px, cases[i].height_px, true);
    turn();
    for (int i = 0; i < n; i++)
        if (newest(i + 1)->width_px != cases[i].sent_px || newest(i + 1)->height_px != cases[i].sent_px * 900 / 1440)
            fail_msg("a pane of %d x %d is sent %d x %d", cases[i].width_px, cases[i].height_px,
                     newest(i + 1)->width_px, newest(i + 1)->height_px);
    assert_int_equal(newest(0)->width_px, WIDTH);
    assert_int_equal(newest(0)->flags & (FRAME_HALF | FRAME_QUARTER), 0);
    assert_int_equal(newest(4)->flags & (FRAME_HALF | FRAME_QUARTER), FRAME_HALF);
    assert_int_equal(newest(8)->flags & (FRAME_HALF | FRAME_QUARTER), FRAME_QUARTER);
    assert_true(newest(8)->flags & FRAME_SHARED && newest(8)->flags & FRAME_STILL);
}

/* The first four whole, then four halves, then four quarters. */
static void crowd_joins(void)
{
    for (int i = 0; i < N_PAGES; i++)
        join(i, i < 4 ? WIDTH : i < 8 ? 700 : 300, HEIGHT, true);
}

static void a_class_is_made_once_and_its_bytes_go_to_all_who_are_in_it(void **state)
{
    (void)state;
    crowd_joins();
    turn();
    const size_t n_requests = fake.n_requests;
    turn();
    assert_int_equal(fake.n_requests - n_requests, 2); /* a moving picture and a still, for twelve people */
    for (int i = 0; i < N_PAGES; i++) {
        assert_ptr_equal(pages[i].last_bytes, pages[i - i % 4].last_bytes);
        assert_int_equal(pages[i].n_bytes_last, i < 4 ? 100 : i < 8 ? 50 : 25);
        assert_int_equal(newest(i)->payload_bytes, pages[i].n_bytes_last);
    }
    assert_ptr_not_equal(pages[0].last_bytes, pages[4].last_bytes);
    assert_ptr_not_equal(pages[4].last_bytes, pages[8].last_bytes);
}

static void expect_requested(bool half, bool quarter)
{
    const size_t before = fake.n_requests;
    turn();
    assert_int_equal(fake.n_requests - before, 2);
    for (size_t i = before; i < fake.n_requests; i++) {
        assert_int_equal(fake.requests[i].is_reduced[0], half);
        assert_int_equal(fake.requests[i].is_reduced[1], quarter);
    }
}

static void a_class_is_made_while_somebody_is_in_it(void **state)
{
    (void)state;
    join(0, WIDTH, HEIGHT, true);
    join(1, 1000, 900, true);
    settle();
    expect_requested(false, false);
    join(2, 300, 300, true);
    expect_requested(false, true);
    resize(1, 600, 600);
    expect_requested(true, true);
    fake_say(&fake, &pages[2], "{\"type\":\"follow\",\"follow\":false}"); /* of their own, now */
    settle();
    assert_int_equal(newest(2)->width_px, 300);
    assert_int_equal(newest(2)->flags & FRAME_QUARTER, 0);
    expect_requested(true, false);
    fake_say(&fake, &pages[1], "{\"type\":\"view.close\",\"view\":1}");
    expect_requested(false, false);
    fake_say(&fake, &pages[2], "{\"type\":\"follow\",\"follow\":true}");
    expect_requested(false, true);
}

static void a_pane_that_grows_is_sent_what_is_there_and_one_that_shrinks_nothing(void **state)
{
    (void)state;
    crowd_joins();
    turn();
    const size_t n_requests = fake.n_requests, n_frames = pages[8].n_frames;
    const void *whole = pages[0].last_bytes, *half = pages[4].last_bytes, *quarter = pages[8].last_bytes;
    resize(8, 310, 310);
    assert_int_equal(pages[8].n_frames, n_frames); /* still of its class */
    resize(8, 600, 600);
    assert_ptr_equal(pages[8].last_bytes, half);
    assert_int_equal(pages[8].n_frames, n_frames + 1);
    fake_shown(&fake, &pages[8]);
    resize(8, 1000, 1000);
    assert_ptr_equal(pages[8].last_bytes, whole);
    assert_int_equal(pages[8].n_frames, n_frames + 2);
    fake_shown(&fake, &pages[8]);
    for (int i = 0; i < 50; i++) { /* to and fro: the larger picture is there already */
        resize(8, i % 2 ? 300 : 1000, 1000);
        fake_pass(&fake, 100);
    }
    assert_int_equal(pages[8].n_frames, n_frames + 2);
    assert_int_equal(fake.n_requests, n_requests); /* nothing was drawn for any of this */
    assert_ptr_equal(pages[9].last_bytes, quarter);
    turn();
    assert_int_equal(newest(8)->width_px, 360); /* the last size counts */
    resize(8, 1000, 1000);
    assert_int_equal(newest(8)->width_px, WIDTH);
}

static void who_comes_is_shown_at_once_what_is_there(void **state)
{
    (void)state;
    join(0, WIDTH, HEIGHT, true);
    turn();
    const size_t n_requests = fake.n_requests;
    join(1, 300, 300, true);
    assert_ptr_equal(pages[1].last_bytes, pages[0].last_bytes); /* no quarter was made of it */
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, n_requests);
}

/* At 50 % the picture of a view of 1440 has 720 pixels: all are shown by a pane of 700. */
static void pictures_that_are_drawn_smaller_are_not_reduced_below_what_is_shown(void **state)
{
    (void)state;
    fake_plan_ready(&fake, false);
    join(0, WIDTH, HEIGHT, true);
    join(1, 700, HEIGHT, true);
    join(2, 300, HEIGHT, true);
    settle();
    int scale = 100;
    for (int i = 0; i < 12; i++) { /* three slow pictures for each step down */
        fake_turn(&fake, &pages[0], 1000 + i, 0);
        struct fake_request *request = fake_newest(&fake);
        scale = request->scale_percent;
        assert_true(request->is_reduced[0]); /* of 1440 for the pane of 700, of 1080, 864 and 720 for that of 300 */
        assert_int_equal(request->is_reduced[1], scale == 100);
        fake_pass(&fake, 60);
        fake_draw_slow(&fake, request, 60000);
        for (int j = 0; j < 3; j++)
            fake_shown(&fake, &pages[j]);
    }
    assert_int_equal(scale, 50);
    assert_int_equal(newest(0)->width_px, 720);
    assert_int_equal(newest(1)->width_px, 720);
    assert_int_equal(newest(2)->width_px, 360);
    settle();
    assert_int_equal(newest(1)->width_px, 720); /* the still is drawn in full size */
    assert_true(newest(1)->flags & FRAME_HALF);
    assert_int_equal(newest(2)->width_px, 360);
    assert_true(newest(2)->flags & FRAME_QUARTER);
}

static void a_class_that_could_not_be_made_is_replaced_by_a_larger_one(void **state)
{
    (void)state;
    crowd_joins();
    turn();
    fake_turn(&fake, &pages[0], 500, 0);
    struct fake_request *request = fake_newest(&fake);
    assert_true(request->is_reduced[0] && request->is_reduced[1]);
    request->is_reduced[1] = false; /* no memory in the renderer */
    fake_draw(&fake, request);
    assert_int_equal(newest(8)->width_px, 720);
    assert_ptr_equal(pages[8].last_bytes, pages[4].last_bytes);
}

static void take_picture(void *context, struct frame *picture, const char *kind)
{
    (void)kind;
    *(int *)context = picture->header.width_px;
}

static bool has_room(void *context)
{
    (void)context;
    return true;
}

static void hear_late(void *context, bool is_late)
{
    (void)context, (void)is_late;
}

static void hear_end(void *context)
{
    (void)context;
}

static void a_display_is_given_the_whole_picture(void **state)
{
    (void)state;
    int width_px = 0;
    const struct room_display_callbacks callbacks = { take_picture, has_room, hear_late, hear_end, &width_px };
    struct problem problem = { 0 };
    crowd_joins();
    turn();
    struct room_display *display = room_display_add(fake.room, NULL, &callbacks, fake.now_us, &problem);
    assert_non_null(display);
    assert_int_equal(width_px, WIDTH);
    width_px = 0;
    turn();
    assert_int_equal(width_px, WIDTH);
    room_display_remove(display);
}

static void a_slow_link_gets_smaller_pictures_while_they_move(void **state)
{
    (void)state;
    join(0, WIDTH, HEIGHT, true);
    join(1, 1000, 900, true);
    turn();
    fake_turn(&fake, &pages[0], 700, 0);
    fake_draw(&fake, fake_newest(&fake));
    fake_shown(&fake, &pages[0]);
    assert_int_equal(newest(1)->width_px, WIDTH);
    fake_pass(&fake, LAG_AFTER_US / 1000 + 10); /* page 1 does not show it */
    fake_shown(&fake, &pages[1]);
    fake_turn(&fake, &pages[0], 701, 0);
    struct fake_request *moving = fake_newest(&fake);
    assert_false(moving->is_still);
    assert_true(moving->is_reduced[0]);
    fake_draw(&fake, moving);
    assert_int_equal(newest(1)->width_px, 720);
    assert_int_equal(newest(0)->width_px, WIDTH);
    settle();
    assert_int_equal(newest(1)->width_px, WIDTH);
    assert_true(newest(1)->flags & FRAME_STILL);
}

#define SIZE_TEST(name) cmocka_unit_test_setup_teardown(name, start, end)

int main(void)
{
    const struct CMUnitTest tests[] = {
        SIZE_TEST(everybody_gets_the_smallest_picture_with_a_pixel_for_each_pixel_shown),
        SIZE_TEST(a_class_is_made_once_and_its_bytes_go_to_all_who_are_in_it),
        SIZE_TEST(a_class_is_made_while_somebody_is_in_it),
        SIZE_TEST(a_pane_that_grows_is_sent_what_is_there_and_one_that_shrinks_nothing),
        SIZE_TEST(who_comes_is_shown_at_once_what_is_there),
        SIZE_TEST(pictures_that_are_drawn_smaller_are_not_reduced_below_what_is_shown),
        SIZE_TEST(a_class_that_could_not_be_made_is_replaced_by_a_larger_one),
        SIZE_TEST(a_display_is_given_the_whole_picture),
        SIZE_TEST(a_slow_link_gets_smaller_pictures_while_they_move),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
