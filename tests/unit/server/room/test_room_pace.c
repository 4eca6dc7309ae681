/* Pacing: scale and quality of moving pictures. */
#include "server/room/state/pace.h"
#include "tests/unit/room_set_up.h"

static void software_starts_at_full_size_but_with_coarse_surfaces(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    assert_int_equal(fake_newest(&fake)->scale_percent, 100);
    assert_int_equal(fake_newest(&fake)->quality, 80);
    assert_true(fake_newest(&fake)->coarse);
    assert_false(fake_newest(&fake)->full_color);
}

static void a_graphics_card_starts_at_full_size_and_detail(void **state)
{
    (void)state;
    fake_plan_ready(&fake, false);
    fake_join(&fake, &ann, false);
    assert_int_equal(fake_newest(&fake)->scale_percent, 100);
    assert_int_equal(fake_newest(&fake)->quality, 80);
    assert_false(fake_newest(&fake)->coarse);
}

/* Turns the camera for a while; returns the scale requested last. */
static int drag(int n, int64_t interval_ms, uint32_t render_us)
{
    int scale = 0;
    for (int i = 0; i < n; i++) {
        static int x;
        fake_turn(&fake, &ann, ++x, 0);
        struct fake_request *request = fake_newest(&fake);
        scale = request->scale_percent;
        fake_pass(&fake, interval_ms);
        fake_draw_slow(&fake, request, render_us);
        fake_shown(&fake, &ann);
    }
    return scale;
}

static void slow_pictures_become_smaller_and_fast_ones_larger_again(void **state)
{
    (void)state;
    fake_plan_ready(&fake, false);
    fake_join(&fake, &ann, false);
    settle_one();
    assert_int_equal(drag(10, 60, 60000), 50); /* 4 steps of 3 pictures: 100, 75, 60, 50 */
    assert_int_equal(drag(30, 15, 8000), 50);  /* less than a second of fast ones */
    assert_int_equal(drag(80, 15, 8000), 60);
    assert_int_equal(drag(300, 15, 8000), 100);
}

static void late_acknowledgements_make_pictures_smaller(void **state)
{
    (void)state;
    fake_plan_ready(&fake, false);
    fake_join(&fake, &ann, false);
    settle_one();
    assert_int_equal(drag(10, 15, 8000), 100);
    int scale = 0;
    for (int i = 0; i < 40; i++) {
        fake_turn(&fake, &ann, 1000 + i, 0);
        struct fake_request *request = fake_newest(&fake);
        scale = request->scale_percent;
        fake_draw_slow(&fake, request, 8000);
        fake_pass(&fake, 140);
        fake_shown(&fake, &ann);
    }
    assert_int_equal(scale, 50);
}

static void a_step_up_that_does_not_hold_is_tried_less_and_less_often(void **state)
{
    struct pace pace;
    int n_up = 0;
    int64_t now_us = 1;
    (void)state;
    pace_start(&pace, false);
    for (int i = 0; i < 60 * 25;
         i++, now_us += 40000) { /* one minute: full size is too slow, three quarters are fast */
        int before = pace.step;
        pace_drawn(&pace, pace.step == 0 ? 50000 : 10000, 2000, 0, 1, now_us);
        n_up += pace.step < before;
    }
    /* after 1, 2, 4, 8, 16 s and then not within the minute */
    assert_int_equal(n_up, 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(software_starts_at_full_size_but_with_coarse_surfaces),
        ROOM_TEST(a_graphics_card_starts_at_full_size_and_detail),
        ROOM_TEST(slow_pictures_become_smaller_and_fast_ones_larger_again),
        ROOM_TEST(late_acknowledgements_make_pictures_smaller),
        ROOM_TEST(a_step_up_that_does_not_hold_is_tried_less_and_less_often),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
