/* Pictures that fail, cannot be drawn or lack regions, and a renderer that is started again. */
#include "tests/unit/room_set_up.h"

static void a_picture_that_failed_is_requested_again_but_not_at_once(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    for (int i = 0; i < 10; i++) {
        size_t before = fake.n_requests;
        fake_fail(&fake, fake_newest(&fake));
        fake_pass(&fake, 50);
        assert_int_equal(fake.n_requests, before);
        fake_pass(&fake, 4000);
        assert_true(fake.n_requests > before);
        while (fake_outstanding(&fake) > 1)
            fake_draw(&fake, fake_oldest(&fake));
    }
    settle_one();
    assert_true(ann.frames[ann.n_frames - 1].flags & FRAME_STILL);
}

static void a_still_that_failed_is_requested_again(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_draw(&fake, fake_oldest(&fake));
    fake_shown(&fake, &ann);
    fake_pass(&fake, 150);
    assert_true(fake_newest(&fake)->is_still);
    fake_fail(&fake, fake_newest(&fake));
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_pass(&fake, 1000);
    assert_true(fake_newest(&fake)->is_still);
}

static void a_picture_that_cannot_be_is_told_once_and_not_requested_again(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_refuse(&fake, fake_oldest(&fake));
    fake_pass(&fake, 10000);
    assert_int_equal(fake_outstanding(&fake), 0);
    assert_int_equal(fake.n_requests, 1);
    assert_int_equal(fake_n_heard(&ann, "problem"), 1);
    cJSON *problem = fake_heard(&ann, "problem");
    assert_int_equal(json_number(problem, "view", 0), 1);
    assert_string_equal(json_text(cJSON_GetObjectItemCaseSensitive(problem, "problem"), "type"),
                        "/problems/validation");
    cJSON_Delete(problem);
    fake_turn(&fake, &ann, 8, 21); /* another view of it may well be drawn */
    settle_one();
    assert_true(ann.frames[ann.n_frames - 1].flags & FRAME_STILL);
    assert_int_equal(fake_n_heard(&ann, "problem"), 1);
}

static void fail_with(struct fake_request *request, enum problem_type type, int retry_after_ms)
{
    struct problem problem = { 0 };
    problem_set(&problem, type, "", "", "made up: more than a limit");
    problem.retry_after_ms = retry_after_ms;
    request->is_answered = true;
    room_picture_failed(fake.room, request->request, &problem, fake.now_us);
    fake.again_us = room_settle(fake.room, fake.now_us);
}

static void a_picture_beyond_a_limit_is_told_once_and_requested_again_only_after_a_change(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fail_with(fake_oldest(&fake), PROBLEM_LIMIT, 0);
    fake_pass(&fake, 60000);
    assert_int_equal(fake.n_requests, 1);
    assert_int_equal(fake_n_heard(&ann, "problem"), 1);
    fake_join(&fake, &ben, true); /* who comes later sees no picture either, and is told why */
    assert_int_equal(fake_n_heard(&ben, "problem"), 1);
    fake_pass(&fake, 60000);
    assert_int_equal(fake.n_requests, 1);
    assert_int_equal(fake_n_heard(&ann, "problem"), 1);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"visible\":false}}}}");
    assert_int_equal(fake.n_requests, 2);
    settle_two();
    assert_int_equal(fake_n_heard(&ben, "problem"), 1);
}

static void a_refusal_that_comes_late_does_not_hide_the_one_of_a_newer_view(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    struct fake_request *older = fake_oldest(&fake);
    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 100);
    assert_ptr_not_equal(fake_newest(&fake), older);
    fake_refuse(&fake, fake_newest(&fake));
    fake_refuse(&fake, fake_oldest(&fake));
    fake_pass(&fake, 1000);
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_join(&fake, &ben, true); /* the view as it is now cannot be drawn */
    assert_int_equal(fake_n_heard(&ben, "problem"), 1);
}

static void a_picture_of_before_the_refusal_is_not_shown_after_it(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    struct fake_request *older = fake_oldest(&fake);
    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 100);
    assert_ptr_not_equal(fake_newest(&fake), older);
    fake_refuse(&fake, fake_newest(&fake));
    assert_int_equal(fake_n_heard(&ann, "problem"), 1);
    size_t n_frames = ann.n_frames;
    fake_draw(&fake, fake_oldest(&fake)); /* it would take away the reason why there is no picture */
    assert_int_equal(ann.n_frames, n_frames);
    fake_turn(&fake, &ann, 9, 22);
    fake_pass(&fake, 100);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ann.n_frames, n_frames + 1);
}

static void who_opens_a_view_that_cannot_be_drawn_is_sent_the_reason_and_no_older_picture(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    settle_one(); /* there is a picture */
    fake_turn(&fake, &ann, 5, 1);
    fake_refuse(&fake, fake_newest(&fake));
    fake_join(&fake, &ben, true);
    assert_string_equal(refused(&ben), "422 ");
    assert_int_equal(ben.n_frames, 0);
    fake_turn(&fake, &ann, 10, 2);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ben.n_frames, 1);
}

static void a_limit_that_says_when_to_come_again_is_no_last_word(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fail_with(fake_oldest(&fake), PROBLEM_LIMIT, 500);
    fake_pass(&fake, 10000);
    assert_int_equal(fake_n_heard(&ann, "problem"), 0);
    assert_true(fake.n_requests > 1);
}

static void what_a_picture_leaves_out_is_told_before_it_and_when_it_changes(void **state)
{
    static const char one[] = "{\"n\":1,\"regions\":[{\"region\":\"brain\",\"reason\":\"too fine\"}]}";
    (void)state;
    fake_join(&fake, &ann, false);
    fake.missing = one;
    settle_one(); /* moving picture and still */
    assert_true(ann.n_frames >= 2);
    assert_int_equal(fake_n_heard(&ann, "missing"), 1);
    cJSON *said = fake_heard(&ann, "missing");
    assert_int_equal(json_number(said, "view", 0), 1);
    assert_string_equal(json_text(cJSON_GetArrayItem(cJSON_GetObjectItem(said, "regions"), 0), "reason"), "too fine");
    cJSON_Delete(said);
    fake.missing = NULL;
    fake_turn(&fake, &ann, 4, 0);
    settle_one();
    assert_int_equal(fake_n_heard(&ann, "missing"), 2);
    said = fake_heard(&ann, "missing");
    assert_int_equal(json_number(said, "n", -1), 0);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(said, "regions")), 0);
    cJSON_Delete(said);
}

static void a_new_renderer_is_told_the_scene_and_draws_everything_anew(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.25}}}}");
    settle_one();
    fake_turn(&fake, &ann, 8, 21);
    struct fake_request *lost = fake_newest(&fake);
    room_renderer_state(fake.room, WIRE_RENDERER_STATE_RESTARTING, NULL, 0, NULL, fake.now_us);
    cJSON *said = fake_heard(&ann, "renderer");
    assert_string_equal(json_text(said, "state"), "restarting");
    cJSON_Delete(said);
    fake_turn(&fake, &ann, 9, 22); /* patches go on; nothing is asked for */
    size_t before = fake.n_requests, scenes = fake.n_scenes, frames = ann.n_frames;
    uint32_t revision;
    (void)room_scene(fake.room, &revision);
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, before);
    fake_plan_ready(&fake, true);
    assert_int_equal(fake.n_scenes, scenes + 1);
    assert_int_equal(fake.told_revision, revision); /* the room's state went on */
    assert_int_equal(fake.n_requests, before + 1);
    fake_draw(&fake, lost); /* a late answer of the old one is dropped */
    assert_int_equal(ann.n_frames, frames);
    struct fake_request *again = fake_newest(&fake);
    assert_close(fake_camera_x(again), 9, 0);
    assert_false(again->is_still);
    fake_draw(&fake, again);
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 22);
    settle_one();
    assert_true(ann.frames[ann.n_frames - 1].flags & FRAME_STILL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_picture_that_failed_is_requested_again_but_not_at_once),
        ROOM_TEST(a_still_that_failed_is_requested_again),
        ROOM_TEST(a_picture_that_cannot_be_is_told_once_and_not_requested_again),
        ROOM_TEST(a_picture_beyond_a_limit_is_told_once_and_requested_again_only_after_a_change),
        ROOM_TEST(a_refusal_that_comes_late_does_not_hide_the_one_of_a_newer_view),
        ROOM_TEST(a_picture_of_before_the_refusal_is_not_shown_after_it),
        ROOM_TEST(who_opens_a_view_that_cannot_be_drawn_is_sent_the_reason_and_no_older_picture),
        ROOM_TEST(a_limit_that_says_when_to_come_again_is_no_last_word),
        ROOM_TEST(what_a_picture_leaves_out_is_told_before_it_and_when_it_changes),
        ROOM_TEST(a_new_renderer_is_told_the_scene_and_draws_everything_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
