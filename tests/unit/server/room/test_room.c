/* When pictures are requested, and which members get them. Pictures that fail: test_room_failures.c. */
#include "tests/unit/room_set_up.h"

static void a_new_view_gets_a_moving_picture_at_once_and_then_a_still(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    assert_int_equal(fake_outstanding(&fake), 1);
    assert_false(fake_oldest(&fake)->is_still);
    fake_draw(&fake, fake_oldest(&fake));
    fake_shown(&fake, &ann);
    assert_int_equal(ann.n_frames, 1);
    fake_pass(&fake, 149);
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_pass(&fake, 1);
    assert_true(fake_oldest(&fake)->is_still);
}

static void a_still_follows_150_ms_after_the_last_change(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    settle_one();
    for (int i = 0; i < 5; i++) { /* changes 100 ms apart: no still between them */
        fake_turn(&fake, &ann, i + 1, 0);
        assert_false(fake_newest(&fake)->is_still);
        fake_draw(&fake, fake_newest(&fake));
        fake_shown(&fake, &ann);
        if (i < 4)
            fake_pass(&fake, 100);
    }
    fake_pass(&fake, 149);
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_pass(&fake, 1);
    struct fake_request *still = fake_oldest(&fake);
    assert_non_null(still);
    assert_true(still->is_still);
    assert_true(still->full_color);
    assert_false(still->coarse);
    assert_int_equal(still->scale_percent, 100);
    assert_int_equal(still->quality, 92);
    assert_close(fake_camera_x(still), 5, 0);
}

static void an_idle_room_requests_nothing(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    settle_one();
    size_t before = fake.n_requests;
    assert_true(fake.again_us == INT64_MAX);
    fake_pass(&fake, 3600000);
    assert_int_equal(fake.n_requests, before);
}

static void a_room_without_views_requests_nothing(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"visible\":false}}}}");
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, 0);
}

static void a_change_that_changes_nothing_is_not_drawn(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_turn(&fake, &ann, 3, 0);
    settle_one();
    size_t before = fake.n_requests;
    uint32_t revision;
    (void)room_scene(fake.room, &revision);
    fake_turn(&fake, &ann, 3, 0);
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"input\":9,\"patch\":{\"regions\":{\"brain\":{\"visible\":true}}}}");
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, before);
    cJSON *scene = fake_heard(&ann, "scene"); /* its sender is still answered, with the unchanged revision */
    assert_int_equal(json_number(scene, "revision", 0), revision);
    assert_int_equal(json_number(scene, "input", 0), 9);
    cJSON_Delete(scene);
}

static void an_input_that_changes_nothing_is_answered_by_the_picture_that_is_there(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_turn(&fake, &ann, 3, 4);
    settle_one();
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 4);
    size_t n_drawn = fake.n_requests, n_frames = ann.n_frames;
    fake_turn(&fake, &ann, 3, 5);
    assert_int_equal(ann.n_frames, n_frames + 1);
    assert_int_equal(ann.frames[n_frames].input_id, 5);
    assert_true(ann.frames[n_frames].flags & FRAME_STILL);
    fake_shown(&fake, &ann);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"input\":6,\"patch\":{}}");
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 6);
    assert_int_equal(fake.n_requests, n_drawn);
}

static void a_followers_resizing_draws_nothing_and_is_answered(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_turn(&fake, &ann, 3, 1);
    settle_one();
    fake_join(&fake, &ben, true);
    settle_two();
    size_t n_drawn = fake.n_requests;
    fake_say(&fake, &ben, "{\"type\":\"view.patch\",\"view\":1,\"input\":7,\"patch\":{\"size_px\":[300,200]}}");
    assert_int_equal(ben.frames[ben.n_frames - 1].input_id, 7);
    assert_int_equal(fake.n_requests, n_drawn);
}

static void no_more_than_two_unshown_frames_are_ever_sent(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    for (int i = 0; i < 50; i++) { /* never acknowledged */
        fake_turn(&fake, &ann, i, 0);
        fake_pass(&fake, 20);
        for (struct fake_request *request; (request = fake_oldest(&fake));)
            fake_draw(&fake, request);
    }
    assert_int_equal(ann.n_frames, 2);
    assert_int_equal(fake.n_requests, 2); /* no picture is drawn without a viewer */
}

static void when_credit_returns_the_newest_state_is_drawn(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    for (int i = 0; i < 50; i++) {
        fake_turn(&fake, &ann, i, 0);
        fake_pass(&fake, 20);
        for (struct fake_request *request; (request = fake_oldest(&fake));)
            fake_draw(&fake, request);
    }
    fake_say(&fake, &ann, "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":1}");
    assert_int_equal(fake_outstanding(&fake), 1);
    assert_close(fake_camera_x(fake_oldest(&fake)), 49, 0);
}

static void an_acknowledgement_counts_for_all_earlier_frames(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_draw(&fake, fake_oldest(&fake));
    fake_turn(&fake, &ann, 1, 0);
    fake_draw(&fake, fake_oldest(&fake));
    assert_int_equal(ann.n_frames, 2);
    fake_turn(&fake, &ann, 2, 0);
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_say(&fake, &ann, "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":2}");
    fake_draw(&fake, fake_oldest(&fake));
    fake_turn(&fake, &ann, 3, 0);
    fake_draw(&fake, fake_oldest(&fake)); /* two more, so both had been given back */
    assert_int_equal(ann.n_frames, 4);
}

static void an_acknowledgement_of_a_frame_never_sent_is_refused(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_draw(&fake, fake_oldest(&fake));
    fake_say(&fake, &ann, "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":2}");
    cJSON *said = fake_heard(&ann, "problem");
    assert_non_null(said);
    assert_string_equal(json_text(said, "to"), "frame.shown");
    assert_string_equal(json_text(cJSON_GetObjectItem(said, "problem"), "type"), "/problems/validation");
    assert_string_equal(json_text(cJSON_GetObjectItem(said, "problem"), "pointer"), "/sequence");
    cJSON_Delete(said);
}

static void while_two_pictures_are_being_made_nothing_more_is_requested(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    for (int i = 1; i < 40; i++) {
        fake_turn(&fake, &ann, i, 0);
        fake_pass(&fake, 10);
        assert_true(fake_outstanding(&fake) <= 2);
    }
    fake_draw(&fake, fake_oldest(&fake));
    fake_shown(&fake, &ann);
    fake_pass(&fake, 20);
    assert_close(fake_camera_x(fake_newest(&fake)), 39, 0); /* the newest state wins */
}

static void a_second_picture_is_requested_when_the_first_should_be_drawn(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_draw_slow(&fake, fake_oldest(&fake), 20000); /* from now on 20 ms are expected for a picture */
    fake_shown(&fake, &ann);
    fake_turn(&fake, &ann, 1, 0);
    fake_turn(&fake, &ann, 2, 0);
    assert_int_equal(fake_outstanding(&fake), 1);
    fake_pass(&fake, 19);
    fake_turn(&fake, &ann, 3, 0);
    assert_int_equal(fake_outstanding(&fake), 1);
    fake_pass(&fake, 1);
    assert_int_equal(fake_outstanding(&fake), 2);
    assert_close(fake_camera_x(fake_newest(&fake)), 3, 0);
}

/* True if the newest picture that was asked for of this kind of view is of one in which a member acts. */
static bool is_acted(const char *kind)
{
    for (size_t i = fake.n_requests; i-- > 0;)
        if (strcmp(json_text(fake.requests[i].view, "kind"), kind) == 0)
            return fake.requests[i].is_acted;
    fail();
    return false;
}

/* All pictures are drawn and shown, in view 2 as well. */
static void settle_both_views(void)
{
    for (int turn = 0; turn < 4; turn++) {
        settle_one();
        for (size_t i = ann.n_frames; i-- > 0;)
            if (ann.frames[i].view == 2) {
                fake_say(&fake, &ann, "{\"type\":\"frame.shown\",\"view\":2,\"sequence\":%u}", ann.frames[i].sequence);
                break;
            }
    }
}

static void pictures_of_the_view_in_which_a_member_acts_are_to_go_first(void **state)
{
    static const char hide[] =
        "{\"type\":\"scene.patch\",\"view\":%d,\"patch\":{\"regions\":{\"%s\":{\"visible\":false}}}}";
    (void)state;
    fake_join(&fake, &ann, false); /* view 1 is 3-D */
    fake_say(&fake, &ann,
             "{\"type\":\"view.open\",\"view\":2,\"document\":{\"kind\":\"axial\",\"size_px\":[400,300]}}");
    settle_both_views();
    assert_false(is_acted("axial") || is_acted("3d"));
    fake_say(&fake, &ann, hide, 2, "brain");
    assert_true(is_acted("axial"));
    assert_false(is_acted("3d"));
    settle_both_views();
    fake_turn(&fake, &ann, 1, 0);
    assert_true(is_acted("3d"));
    /* half a second after the last of them nobody acts any more */
    settle_both_views();
    fake_pass(&fake, 600);
    fake_say(&fake, &ann, hide, 0, "scalp");
    assert_false(is_acted("axial") || is_acted("3d"));
}

static void a_frame_is_not_sent_out_of_order(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    settle_one();
    size_t before = ann.n_frames;
    fake_turn(&fake, &ann, 1, 0);
    struct fake_request *older = fake_newest(&fake);
    fake_pass(&fake, 60);
    fake_turn(&fake, &ann, 2, 0);
    struct fake_request *newer = fake_newest(&fake);
    assert_ptr_not_equal(older, newer);
    fake_draw(&fake, newer);
    fake_draw(&fake, older);
    assert_int_equal(ann.n_frames, before + 1);
    assert_int_equal(ann.first_byte_last, (uint8_t)newer->request);
}

static void a_change_does_not_wait_for_a_slow_still(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    settle_one();
    fake_turn(&fake, &ann, 1, 0);
    fake_draw(&fake, fake_oldest(&fake));
    fake_shown(&fake, &ann);
    fake_pass(&fake, 150);
    struct fake_request *still = fake_newest(&fake);
    assert_true(still->is_still);
    for (int i = 2; i < 30; i++) { /* the still is not answered; moving pictures go on */
        fake_turn(&fake, &ann, i, 0);
        struct fake_request *moving = fake_newest(&fake);
        assert_ptr_not_equal(moving, still);
        assert_false(moving->is_still);
        fake_draw(&fake, moving);
        fake_shown(&fake, &ann);
        fake_pass(&fake, 200);
        assert_int_equal(fake_outstanding(&fake), 1); /* no second still beside it */
    }
    size_t before = ann.n_frames;
    fake_draw(&fake, still); /* the late still shows an older view */
    assert_int_equal(ann.n_frames, before);
    struct fake_request *last = fake_newest(&fake);
    assert_true(last->is_still);
    assert_close(fake_camera_x(last), 29, 0);
    fake_draw(&fake, last);
    assert_int_equal(ann.n_frames, before + 1);
}

static void a_slow_member_does_not_slow_another(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    size_t ann_before = ann.n_frames, ben_before = ben.n_frames;
    for (int i = 0; i < 20; i++) { /* Ben acknowledges nothing */
        fake_turn(&fake, &ann, i + 1, 0);
        fake_pass(&fake, 20);
        fake_draw(&fake, fake_oldest(&fake));
        fake_shown(&fake, &ann);
    }
    assert_int_equal(ann.n_frames - ann_before, 20);
    assert_int_equal(ben.n_frames - ben_before, 2);
    fake_pass(&fake, 200);
    fake_draw(&fake, fake_oldest(&fake)); /* the still */
    fake_shown(&fake, &ann);
    size_t drawn = fake.n_requests;
    uint64_t still = fake.requests[drawn - 1].request;
    assert_int_equal(ben.n_frames - ben_before, 2);
    fake_shown(&fake, &ben); /* its credit returns: the newest picture, from what is there */
    assert_int_equal(ben.n_frames - ben_before, 3);
    assert_int_equal(ben.first_byte_last, (uint8_t)still);
    assert_true(ben.frames[ben.n_frames - 1].flags & FRAME_STILL);
    assert_int_equal(fake.n_requests, drawn);
}

static void two_followers_share_one_render(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    size_t before = fake.n_requests, ann_before = ann.n_frames, ben_before = ben.n_frames;
    fake_turn(&fake, &ann, 5, 0);
    assert_int_equal(fake.n_requests, before + 1);
    fake_draw(&fake, fake_oldest(&fake));
    assert_int_equal(ann.n_frames, ann_before + 1);
    assert_int_equal(ben.n_frames, ben_before + 1);
    assert_true(ben.frames[ben.n_frames - 1].flags & FRAME_SHARED);
    assert_int_equal(ann.first_byte_last, ben.first_byte_last);
}

static void own_views_are_drawn_each_for_itself(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, false);
    settle_two();
    size_t before = fake.n_requests, ben_before = ben.n_frames;
    fake_turn(&fake, &ann, 5, 0);
    fake_pass(&fake, 50);
    assert_int_equal(fake.n_requests, before + 1);
    fake_draw(&fake, fake_oldest(&fake));
    assert_int_equal(ben.n_frames, ben_before);
    assert_false(ann.frames[ann.n_frames - 1].flags & FRAME_SHARED);
}

static void a_late_follower_gets_the_picture_that_is_there_at_once(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    settle_one();
    size_t before = fake.n_requests;
    fake_join(&fake, &ben, true);
    assert_int_equal(ben.n_frames, 1);
    assert_true(ben.frames[0].flags & FRAME_STILL);
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, before); /* and nothing is drawn for it */
}

static void a_frame_carries_the_newest_input_it_shows_and_none_newer(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    settle_one();
    fake_turn(&fake, &ann, 1, 11);
    struct fake_request *first = fake_newest(&fake);
    fake_turn(&fake, &ann, 2, 12); /* after the first was asked for */
    fake_turn(&fake, &ann, 3, 13);
    fake_draw(&fake, first);
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 11);
    fake_shown(&fake, &ann);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 13);
}

static void input_numbers_are_each_members_own(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    fake_turn(&fake, &ann, 1, 77);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 77);
    assert_int_equal(ben.frames[ben.n_frames - 1].input_id, 0);
}

static void many_inputs_between_two_pictures_are_never_reported_too_early(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    settle_one();
    fake_turn(&fake, &ann, 1, 100);
    struct fake_request *first = fake_newest(&fake);
    for (unsigned i = 0; i < 200; i++)
        fake_turn(&fake, &ann, 2 + (int)i, 101 + i);
    fake_draw(&fake, first);
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 100);
    fake_shown(&fake, &ann);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ann.frames[ann.n_frames - 1].input_id, 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_new_view_gets_a_moving_picture_at_once_and_then_a_still),
        ROOM_TEST(a_still_follows_150_ms_after_the_last_change),
        ROOM_TEST(an_idle_room_requests_nothing),
        ROOM_TEST(a_room_without_views_requests_nothing),
        ROOM_TEST(a_change_that_changes_nothing_is_not_drawn),
        ROOM_TEST(an_input_that_changes_nothing_is_answered_by_the_picture_that_is_there),
        ROOM_TEST(a_followers_resizing_draws_nothing_and_is_answered),
        ROOM_TEST(no_more_than_two_unshown_frames_are_ever_sent),
        ROOM_TEST(when_credit_returns_the_newest_state_is_drawn),
        ROOM_TEST(an_acknowledgement_counts_for_all_earlier_frames),
        ROOM_TEST(an_acknowledgement_of_a_frame_never_sent_is_refused),
        ROOM_TEST(while_two_pictures_are_being_made_nothing_more_is_requested),
        ROOM_TEST(a_second_picture_is_requested_when_the_first_should_be_drawn),
        ROOM_TEST(pictures_of_the_view_in_which_a_member_acts_are_to_go_first),
        ROOM_TEST(a_frame_is_not_sent_out_of_order),
        ROOM_TEST(a_change_does_not_wait_for_a_slow_still),
        ROOM_TEST(a_slow_member_does_not_slow_another),
        ROOM_TEST(two_followers_share_one_render),
        ROOM_TEST(own_views_are_drawn_each_for_itself),
        ROOM_TEST(a_late_follower_gets_the_picture_that_is_there_at_once),
        ROOM_TEST(a_frame_carries_the_newest_input_it_shows_and_none_newer),
        ROOM_TEST(input_numbers_are_each_members_own),
        ROOM_TEST(many_inputs_between_two_pictures_are_never_reported_too_early),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
