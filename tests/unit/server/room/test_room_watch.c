/* The small picture of the presenter that a member has beside own views: what it shows, and that it costs nobody
 * anything. */
#include "tests/unit/room_set_up.h"

enum { WATCH = 9 };

static size_t n_frames(const struct fake_page *page, uint32_t view)
{
    size_t n = 0;
    for (size_t i = 0; i < page->n_frames; i++)
        n += page->frames[i].view == view;
    return n;
}

static const struct frame_header *newest(const struct fake_page *page, uint32_t view)
{
    for (size_t i = page->n_frames; i-- > 0;)
        if (page->frames[i].view == view)
            return &page->frames[i];
    return NULL;
}

static void acknowledge(struct fake_page *page, uint32_t view)
{
    const struct frame_header *header = newest(page, view);
    assert_non_null(header);
    fake_say(&fake, page, "{\"type\":\"frame.shown\",\"view\":%u,\"sequence\":%u}", view, header->sequence);
}

static void watch(struct fake_page *page)
{
    fake_say(&fake, page, "{\"type\":\"watch\",\"size_px\":[260,195]}");
}

/* The newest message about the small picture: "axial late", "3d". */
static const char *told(const struct fake_page *page)
{
    static char text[64];
    for (size_t i = page->n_texts; i-- > 0;) {
        cJSON *json = json_read(page->texts[i], strlen(page->texts[i]), NULL);
        const bool is_it = strcmp(json_text(json, "type"), "view") == 0 && json_number(json, "view", 0) == WATCH;
        if (is_it)
            (void)snprintf(text, sizeof text, "%s%s", json_text(cJSON_GetObjectItem(json, "document"), "kind"),
                           cJSON_IsTrue(cJSON_GetObjectItem(json, "late")) ? " late" : "");
        cJSON_Delete(json);
        if (is_it)
            return text;
    }
    return "";
}

static void open_axial(struct fake_page *page)
{
    fake_say(
        &fake, page,
        "{\"type\":\"view.open\",\"view\":2,\"document\":{\"kind\":\"axial\",\"size_px\":[400,400]},\"follow\":true}");
}

static void work_in(struct fake_page *page, int view)
{
    fake_say(&fake, page, "{\"type\":\"view.active\",\"view\":%d}", view);
}

/* Ann presents, Ben looks for himself; all is drawn and acknowledged. */
static void on_their_own(void)
{
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":false}");
    settle_two();
}

static void draw_all(void)
{
    while (fake_outstanding(&fake)) {
        fake_draw(&fake, fake_oldest(&fake));
        fake_shown(&fake, &ann);
        if (newest(&ben, 1) && !ben.is_closed)
            fake_shown(&fake, &ben);
    }
}

static void it_is_the_picture_that_is_there_and_the_ones_that_the_presenter_takes(void **state)
{
    (void)state;
    on_their_own();
    const size_t n_requests = fake.n_requests;
    watch(&ben);
    assert_string_equal(told(&ben), "3d");
    assert_int_equal(n_frames(&ben, WATCH), 1);
    assert_int_equal(fake.n_requests, n_requests); /* it was drawn for Ann */
    assert_true((newest(&ben, WATCH)->flags & FRAME_SHARED) != 0);
    assert_int_equal(ben.first_byte_last, ann.first_byte_last);
    acknowledge(&ben, WATCH);
    fake_pass(&fake, 1000);

    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 1000);
    draw_all();
    fake_pass(&fake, 1000);
    draw_all();
    assert_int_equal(fake.n_requests, n_requests + 2); /* a moving one and a still, for Ann */
    assert_int_equal(n_frames(&ben, WATCH), 2);
    acknowledge(&ben, WATCH);
    fake_pass(&fake, 300);
    assert_int_equal(newest(&ben, WATCH)->flags & FRAME_STILL, FRAME_STILL); /* the last one is the best */
    fake_say(&fake, &ben, "{\"type\":\"watch\",\"size_px\":null}");
    const size_t n = n_frames(&ben, WATCH);
    fake_turn(&fake, &ann, 16, 22);
    draw_all();
    assert_int_equal(n_frames(&ben, WATCH), n);
}

static void at_most_five_come_in_a_second_and_none_before_the_last_is_acknowledged(void **state)
{
    (void)state;
    on_their_own();
    watch(&ben);
    acknowledge(&ben, WATCH);
    const size_t before = n_frames(&ben, WATCH), n_of_ann = ann.n_frames;
    for (int i = 0; i < 100; i++) { /* 4 s of a drag, 25 pictures a second */
        fake_turn(&fake, &ann, i % 40 + 50, 100 + (unsigned)i);
        fake_pass(&fake, 20);
        draw_all();
        fake_pass(&fake, 20);
        if (newest(&ben, WATCH))
            acknowledge(&ben, WATCH);
    }
    assert_true(ann.n_frames >= n_of_ann + 100);
    assert_in_range(n_frames(&ben, WATCH) - before, 15, 21);

    const size_t n = n_frames(&ben, WATCH);
    fake_turn(&fake, &ann, 200, 300);
    fake_pass(&fake, 500);
    draw_all();
    fake_turn(&fake, &ann, 210, 301);
    fake_pass(&fake, 500);
    draw_all();
    assert_true(n_frames(&ben, WATCH) <= n + 1); /* not acknowledged */
}

static void a_slow_watcher_makes_no_picture_worse(void **state)
{
    (void)state;
    on_their_own();
    watch(&ben);
    fake_pass(&fake, 5000);
    for (int i = 0; i < 10; i++) {
        fake_turn(&fake, &ann, i + 60, 100 + (unsigned)i);
        fake_pass(&fake, 20);
        assert_int_equal(fake_outstanding(&fake), 1);
        fake_draw(&fake, fake_oldest(&fake));
        fake_pass(&fake, 5);
        acknowledge(&ann, 1);
        if (i == 5) {
            fake_pass(&fake, 3000);
            draw_all();
            acknowledge(&ben, WATCH); /* very late */
        }
    }
    fake_turn(&fake, &ann, 99, 200);
    assert_int_equal(fake_oldest(&fake)->scale_percent, 100);
    cJSON *members = fake_heard(&ann, "members"); /* nobody is said to have a slow link for it */
    const cJSON *member;
    cJSON_ArrayForEach(member, cJSON_GetObjectItem(members, "members"))
        assert_string_equal(json_text(member, "lag"), "none");
    cJSON_Delete(members);
}

static void own_views_go_first(void **state)
{
    (void)state;
    on_their_own();
    fake_say(&fake, &ben, "{\"type\":\"watch\",\"size_px\":[800,600]}"); /* whole, as his own */
    acknowledge(&ben, WATCH);
    fake_pass(&fake, 1000);
    const size_t n = n_frames(&ben, WATCH);
    fake_turn(&fake, &ben, 300, 400); /* his own view; he does not acknowledge its picture yet */
    fake_draw(&fake, fake_oldest(&fake));
    fake_turn(&fake, &ann, 8, 21);
    fake_draw(&fake, fake_newest(&fake));
    fake_pass(&fake, 900);
    assert_int_equal(n_frames(&ben, WATCH), n);
    acknowledge(&ben, 1);
    assert_int_equal(n_frames(&ben, WATCH), n + 1);
    acknowledge(&ben, WATCH);

    /* While own pictures always wait, one for sixteen of theirs, which are as large here. */
    fake_settle(&fake, (struct fake_page *const[]){ &ann, &ben }, 2);
    if (newest(&ben, WATCH))
        acknowledge(&ben, WATCH);
    fake_pass(&fake, 1000);
    const size_t first = n_frames(&ben, WATCH), first_own = n_frames(&ben, 1);
    for (int i = 0; i < 64; i++) {
        fake_turn(&fake, &ben, i + 1, 500 + (unsigned)i);
        fake_turn(&fake, &ann, i + 1, 600 + (unsigned)i);
        fake_pass(&fake, 40);
        while (fake_outstanding(&fake))
            fake_draw(&fake, fake_oldest(&fake));
        const struct frame_header *own = newest(&ben, 1);
        if (own->sequence > 1) /* all but the last */
            fake_say(&fake, &ben, "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":%u}", own->sequence - 1);
        acknowledge(&ann, 1);
        acknowledge(&ben, WATCH);
    }
    const size_t n_own = n_frames(&ben, 1) - first_own, n_small = n_frames(&ben, WATCH) - first;
    assert_true(n_own >= 48);
    assert_in_range(n_small, 2, n_own / 16 + 1);
}

static void it_goes_with_the_view_that_the_presenter_works_in(void **state)
{
    (void)state;
    on_their_own();
    open_axial(&ann);
    settle_two();
    watch(&ben);
    assert_string_equal(told(&ben), "3d");
    work_in(&ann, 2);
    assert_string_equal(told(&ben), "axial");
    fake_turn(&fake, &ann, 8, 21); /* she has told which one it is: a linked camera does not change it */
    assert_string_equal(told(&ben), "axial");
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":2}");
    assert_string_equal(told(&ben), "3d");
}

static void of_a_presenter_who_tells_nothing_the_view_acted_in_counts(void **state)
{
    (void)state;
    on_their_own();
    open_axial(&ann);
    settle_two();
    watch(&ben);
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"size_px\":[500,400]}}");
    assert_string_equal(told(&ben), "3d"); /* another size is no act */
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"view\":2,\"patch\":{\"regions\":{\"brain\":{\"opacity\":0.5}}}}");
    assert_string_equal(told(&ben), "axial");
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{}}");
    assert_string_equal(told(&ben), "axial"); /* nor is an empty patch */
    fake_turn(&fake, &ann, 8, 21);
    assert_string_equal(told(&ben), "3d");
}

static void it_goes_with_control_and_away_when_nobody_presents(void **state)
{
    (void)state;
    on_their_own();
    fake_join(&fake, &cem, true);
    open_axial(&cem);
    work_in(&cem, 2); /* he follows: nobody sees that yet */
    watch(&ben);
    acknowledge(&ben, WATCH);
    assert_string_equal(told(&ben), "3d");
    fake_say(&fake, &ann, "{\"type\":\"control.give\",\"member\":\"m3\"}");
    assert_string_equal(told(&ben), "axial");

    room_connection_closed(fake.room, &cem, fake.now_us);
    fake_pass(&fake, 10000); /* he is away, and still presents */
    const size_t n_requests = fake.n_requests;
    while (fake_outstanding(&fake))
        fake_draw(&fake, fake_oldest(&fake));
    assert_true(n_frames(&ben, WATCH) > 0);
    assert_true(fake.n_requests >= n_requests);
    fake_pass(&fake, 25000); /* nobody presents: Ann and Ben are there */
    const size_t n = n_frames(&ben, WATCH);
    fake_say(&fake, &ann, "{\"type\":\"present\"}");
    assert_string_equal(told(&ben), "3d");
    fake_pass(&fake, 1000);
    assert_true(n_frames(&ben, WATCH) <= n + 1);
}

static void the_presenter_and_who_is_gone_are_sent_none(void **state)
{
    (void)state;
    on_their_own();
    watch(&ann);
    assert_int_equal(n_frames(&ann, WATCH), 0);
    assert_string_equal(told(&ann), "");
    watch(&ben);
    acknowledge(&ben, WATCH);
    room_connection_closed(fake.room, &ben, fake.now_us);
    ben.is_closed = true;
    fake_turn(&fake, &ann, 8, 21);
    const size_t n = n_frames(&ben, WATCH);
    fake_pass(&fake, 1000);
    draw_all();
    assert_int_equal(n_frames(&ben, WATCH), n);
}

static void it_is_drawn_for_who_watches_only_while_nobody_else_takes_pictures(void **state)
{
    (void)state;
    on_their_own();
    watch(&ben);
    acknowledge(&ben, WATCH);
    for (unsigned i = 0; i < 2; i++) { /* Ann takes no pictures any more */
        fake_turn(&fake, &ann, 8 + (int)i, 21 + i);
        fake_pass(&fake, 50);
        fake_draw(&fake, fake_oldest(&fake));
    }
    acknowledge(&ben, WATCH);
    fake_turn(&fake, &ann, 20, 31);
    fake_pass(&fake, 1500); /* the last picture that she was sent has come to Ben 200 ms after the one before */
    acknowledge(&ben, WATCH);
    const size_t n_requests = fake.n_requests;
    assert_int_equal(fake_outstanding(&fake), 0);
    assert_string_equal(told(&ben), "3d late");
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, n_requests + 1);
    fake_draw(&fake, fake_oldest(&fake));
    assert_string_equal(told(&ben), "3d");
}

static void it_is_said_to_be_late_after_a_second_and_comes_again_from_a_new_renderer(void **state)
{
    (void)state;
    on_their_own();
    watch(&ben);
    acknowledge(&ben, WATCH);
    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 900);
    assert_string_equal(told(&ben), "3d");
    fake_pass(&fake, 200);
    assert_string_equal(told(&ben), "3d late");
    room_renderer_state(fake.room, WIRE_RENDERER_STATE_RESTARTING, "crashed", 0, NULL, fake.now_us);
    fake_plan_ready(&fake, true);
    const size_t n = n_frames(&ben, WATCH);
    draw_all();
    fake_pass(&fake, 10);
    assert_int_equal(n_frames(&ben, WATCH), n + 1);
    assert_string_equal(told(&ben), "3d");
    acknowledge(&ben, WATCH);
    fake_pass(&fake, 10000);
    draw_all();
    fake_pass(&fake, 60000);
    assert_string_equal(told(&ben), "3d"); /* nothing has changed since */
}

static void an_observer_may_and_two_tabs_of_a_person_each_have_their_own(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    on_their_own();
    assert_true(room_link_create(fake.room, WIRE_MEMBER_ROLE_OBSERVER, 3600, false, fake.now_us, token, &problem));
    fake_say(&fake, &cem, "{\"type\":\"hello\",\"protocol\":2,\"link\":\"%s\",\"person\":\"p\"}", token);
    watch(&cem);
    assert_int_equal(fake_n_heard(&cem, "problem"), 0);
    assert_int_equal(n_frames(&cem, WATCH), 1);
    watch(&ben);
    assert_int_equal(n_frames(&ben, WATCH), 1);
    acknowledge(&cem, WATCH);
    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 1000);
    draw_all();
    assert_int_equal(n_frames(&cem, WATCH), 2); /* she has acknowledged, he has not */
    assert_int_equal(n_frames(&ben, WATCH), 1);
}

static void a_picture_that_cannot_be_drawn_is_the_presenters_problem(void **state)
{
    (void)state;
    on_their_own();
    watch(&ben);
    acknowledge(&ben, WATCH);
    fake_turn(&fake, &ann, 8, 21);
    fake_refuse(&fake, fake_oldest(&fake));
    assert_int_equal(fake_n_heard(&ann, "problem"), 1);
    assert_int_equal(fake_n_heard(&ben, "problem"), 0);
    fake_pass(&fake, 1100);
    assert_string_equal(told(&ben), "3d late");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(it_is_the_picture_that_is_there_and_the_ones_that_the_presenter_takes),
        ROOM_TEST(at_most_five_come_in_a_second_and_none_before_the_last_is_acknowledged),
        ROOM_TEST(a_slow_watcher_makes_no_picture_worse),
        ROOM_TEST(own_views_go_first),
        ROOM_TEST(it_goes_with_the_view_that_the_presenter_works_in),
        ROOM_TEST(of_a_presenter_who_tells_nothing_the_view_acted_in_counts),
        ROOM_TEST(it_goes_with_control_and_away_when_nobody_presents),
        ROOM_TEST(the_presenter_and_who_is_gone_are_sent_none),
        ROOM_TEST(it_is_drawn_for_who_watches_only_while_nobody_else_takes_pictures),
        ROOM_TEST(it_is_said_to_be_late_after_a_second_and_comes_again_from_a_new_renderer),
        ROOM_TEST(an_observer_may_and_two_tabs_of_a_person_each_have_their_own),
        ROOM_TEST(a_picture_that_cannot_be_drawn_is_the_presenters_problem),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
