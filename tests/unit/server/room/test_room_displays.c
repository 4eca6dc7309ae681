/* Screens that show a shared view: which pictures they are given, and that they are told when theirs is old. */
#include "tests/unit/room_set_up.h"

struct screen {
    size_t n_pictures, n_ended, n_bytes; /* n_bytes: of the newest picture; 120 with the words for a draft, else 100 */
    bool is_full, is_late;
    const char *kind; /* of the newest picture */
};

static void take_picture(void *context, struct frame *picture, const char *kind)
{
    ((struct screen *)context)->n_bytes = picture->n_bytes;
    ((struct screen *)context)->n_pictures++;
    ((struct screen *)context)->kind = kind;
}

static bool has_room(void *context)
{
    return !((const struct screen *)context)->is_full;
}

static void hear_late(void *context, bool is_late)
{
    ((struct screen *)context)->is_late = is_late;
}

static void hear_end(void *context)
{
    ((struct screen *)context)->n_ended++;
}

static struct room_display *add_screen(struct screen *screen)
{
    const struct room_display_callbacks callbacks = { take_picture, has_room, hear_late, hear_end, screen };
    struct problem problem = { 0 };
    struct room_display *display = room_display_add(fake.room, NULL, &callbacks, fake.now_us, &problem);
    assert_non_null(display);
    fake.again_us = fake.now_us; /* whoever calls a room lets it tick */
    return display;
}

static void a_screen_is_told_when_its_picture_is_old_and_when_it_is_new_again(void **state)
{
    (void)state;
    struct screen screen = { 0 };
    fake_join(&fake, &ann, true);
    settle_one();
    struct room_display *display = add_screen(&screen);
    assert_int_equal(screen.n_pictures, 1);
    fake_pass(&fake, 60000);
    assert_false(screen.is_late); /* nothing has changed */

    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 900);
    assert_false(screen.is_late);
    fake_pass(&fake, 200);
    assert_true(screen.is_late);
    const size_t n_pictures = screen.n_pictures;
    settle_one();
    fake_pass(&fake, 1);
    assert_false(screen.is_late);
    assert_true(screen.n_pictures > n_pictures);

    fake_turn(&fake, &ann, 16, 22); /* this cannot be drawn: it stays old for as long as that is so */
    fake_refuse(&fake, fake_oldest(&fake));
    fake_pass(&fake, 60000);
    assert_true(screen.is_late);
    fake_turn(&fake, &ann, 24, 23);
    settle_one();
    fake_pass(&fake, 1);
    assert_false(screen.is_late);
    room_display_remove(display);
}

static void pictures_that_follow_each_other_are_not_old(void **state)
{
    (void)state;
    struct screen screen = { 0 };
    fake_join(&fake, &ann, true);
    settle_one();
    struct room_display *display = add_screen(&screen);
    for (int i = 0; i < 20; i++) { /* each picture shows a state that has passed when it comes */
        fake_turn(&fake, &ann, i + 1, 30 + (unsigned)i);
        fake_pass(&fake, 400);
        fake_draw(&fake, fake_oldest(&fake));
        fake_shown(&fake, &ann);
        fake_turn(&fake, &ann, i + 2, 60 + (unsigned)i);
        assert_false(screen.is_late);
    }
    room_display_remove(display);
}

static void nothing_is_drawn_for_a_screen_while_a_member_takes_pictures(void **state)
{
    (void)state;
    struct screen screen = { 0 };
    fake_join(&fake, &ann, true);
    settle_one();
    const size_t n_requests = fake.n_requests;
    struct room_display *display = add_screen(&screen);
    fake_pass(&fake, 10000);
    assert_int_equal(fake.n_requests, n_requests);
    room_display_remove(display);
}

static void a_screen_alone_is_drawn_for_when_it_has_taken_its_picture(void **state)
{
    (void)state;
    struct screen screen = { .is_full = true };
    struct room_display *display = add_screen(&screen);
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, 0);
    screen.is_full = false;
    fake_pass(&fake, 100);
    assert_int_equal(fake_outstanding(&fake), 1);
    fake_draw(&fake, fake_oldest(&fake));
    assert_int_equal(screen.n_pictures, 1);
    room_display_remove(display);
}

static void open_axial(struct fake_page *page)
{
    fake_say(
        &fake, page,
        "{\"type\":\"view.open\",\"view\":2,\"document\":{\"kind\":\"axial\",\"size_px\":[400,400]},\"follow\":true}");
    for (int i = 0; i < 3; i++) {
        settle_one();
        for (uint32_t sequence = 1; sequence < 9; sequence++) /* those that were not sent are refused */
            fake_say(&fake, page, "{\"type\":\"frame.shown\",\"view\":2,\"sequence\":%u}", sequence);
    }
}

static void a_screen_that_names_no_view_shows_the_one_the_presenter_works_in(void **state)
{
    (void)state;
    struct screen screen = { 0 };
    fake_join(&fake, &ann, true);
    open_axial(&ann);
    fake_say(&fake, &ann, "{\"type\":\"view.active\",\"view\":2}");
    struct room_display *display = add_screen(&screen);
    assert_string_equal(screen.kind, "axial");
    assert_string_equal(room_display_kind(display), "axial");
    size_t n_pictures = screen.n_pictures;
    assert_int_equal(n_pictures, 1);

    fake_say(&fake, &ann, "{\"type\":\"view.active\",\"view\":1}");
    assert_string_equal(screen.kind, "3d"); /* the picture that is there */
    assert_int_equal(screen.n_pictures, n_pictures + 1);
    fake_turn(&fake, &ann, 8, 21);
    settle_one();
    assert_string_equal(screen.kind, "3d");
    assert_true(screen.n_pictures > n_pictures + 1);

    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":1}"); /* as when she maximises the other pane */
    assert_string_equal(screen.kind, "axial");
    room_connection_closed(fake.room, &ann, fake.now_us);
    fake_pass(&fake, 60000); /* nobody presents: what was shown stays */
    assert_string_equal(room_display_kind(display), "axial");
    assert_int_equal(screen.n_ended, 0);
    room_display_remove(display);
}

static void a_screen_that_names_a_view_keeps_it(void **state)
{
    (void)state;
    struct screen screen = { 0 };
    const struct room_display_callbacks callbacks = { take_picture, has_room, hear_late, hear_end, &screen };
    struct problem problem = { 0 };
    fake_join(&fake, &ann, true);
    open_axial(&ann);
    struct room_display *display = room_display_add(fake.room, "axial", &callbacks, fake.now_us, &problem);
    assert_non_null(display);
    fake_say(&fake, &ann, "{\"type\":\"view.active\",\"view\":1}");
    fake_turn(&fake, &ann, 8, 21);
    settle_one();
    assert_string_equal(room_display_kind(display), "axial");
    assert_string_equal(screen.kind, "axial");
    room_display_remove(display);
}

static void of_several_screens_each_goes_over(void **state)
{
    (void)state;
    struct screen screens[3] = { { 0 } };
    struct room_display *displays[3];
    for (int i = 0; i < 3; i++) /* nobody has shown a view: they make one, which ends with them */
        displays[i] = add_screen(&screens[i]);
    fake_join(&fake, &ann, true);
    open_axial(&ann);
    fake_say(&fake, &ann, "{\"type\":\"view.active\",\"view\":2}");
    for (int i = 0; i < 3; i++) {
        assert_string_equal(screens[i].kind, "axial");
        assert_int_equal(screens[i].n_ended, 0);
        room_display_remove(displays[i]);
    }
}

static void draft(bool is_on)
{
    fake.is_draft = is_on;
    fake_say(
        &fake, &ann,
        "{\"type\":\"scene.patch\",\"patch\":{\"beam\":{\"draft\":{\"enabled\":%s,\"line\":{\"entry_mm\":[0,-100,0],"
        "\"target_mm\":[0,0,0]}}}}}",
        is_on ? "true" : "false");
}

static void a_screen_is_given_no_picture_of_a_draft_without_words_for_it(void **state)
{
    (void)state;
    struct screen screen = { 0 }, late = { 0 };
    fake_join(&fake, &ann, true);
    settle_one();
    struct room_display *display = add_screen(&screen);
    assert_int_equal(screen.n_bytes, 100);
    draft(true);
    for (struct fake_request *request; (request = fake_oldest(&fake));) {
        const size_t n_pictures = screen.n_pictures;
        const bool is_marked = request->is_marked;
        fake_draw(&fake, request);
        assert_int_equal(screen.n_pictures, n_pictures + is_marked);
        assert_int_equal(screen.n_bytes, is_marked ? 120 : 100);
        fake_shown(&fake, &ann);
    }
    settle_one();
    assert_int_equal(screen.n_bytes, 120);
    assert_int_equal(ann.n_bytes_last, 100); /* her page says it itself */
    draft(false);
    settle_one();
    assert_int_equal(screen.n_bytes, 100);
    room_display_remove(display);

    draft(true); /* with no screen, no words are painted */
    settle_one();
    display = add_screen(&late);
    assert_int_equal(late.n_pictures, 0);
    settle_one();
    assert_int_equal(late.n_bytes, 120);
    fake_pass(&fake, 2000);
    assert_false(late.is_late);
    room_display_remove(display);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_screen_is_given_no_picture_of_a_draft_without_words_for_it),
        ROOM_TEST(a_screen_is_told_when_its_picture_is_old_and_when_it_is_new_again),
        ROOM_TEST(pictures_that_follow_each_other_are_not_old),
        ROOM_TEST(nothing_is_drawn_for_a_screen_while_a_member_takes_pictures),
        ROOM_TEST(a_screen_alone_is_drawn_for_when_it_has_taken_its_picture),
        ROOM_TEST(a_screen_that_names_no_view_shows_the_one_the_presenter_works_in),
        ROOM_TEST(a_screen_that_names_a_view_keeps_it),
        ROOM_TEST(of_several_screens_each_goes_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
