/* Members and views. */
#include "tests/unit/room_set_up.h"

static void come_back(struct fake_page *page, const char *id, const char *secret)
{
    fake_say(&fake, page, "{\"type\":\"hello\",\"protocol\":2,\"member\":\"%s\",\"secret\":\"%s\"}", id, secret);
}

static int width_of(const struct fake_request *request)
{
    return cJSON_GetArrayItem(cJSON_GetObjectItem(request->view, "size_px"), 0)->valueint;
}

static void move(struct fake_page *page, int x)
{
    fake_say(&fake, page, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"camera\":{\"target_mm\":[%d,0,0]}}}", x);
}

/* ---- members ---------------------------------------------------------------------------------------------------- */

static void hello_is_answered_with_everything_a_page_needs(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    cJSON *welcome = fake_heard(&ann, "welcome");
    assert_string_equal(json_text(welcome, "room"), "7q4k-m2wz");
    assert_string_equal(json_text(welcome, "plan_id"), "head");
    assert_int_equal(strlen(json_text(welcome, "secret")), 32);
    assert_string_equal(json_text(cJSON_GetObjectItem(welcome, "plan"), "id"), "head");
    assert_non_null(cJSON_GetObjectItem(cJSON_GetObjectItem(welcome, "scene"), "regions"));
    assert_string_equal(json_text(welcome, "gl"), "osmesa llvmpipe");
    cJSON_Delete(welcome);
    assert_string_equal(heard(&ann, "renderer", "state"), "ready");
}

static void who_gives_no_name_is_numbered(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    assert_string_equal(heard(&ann, "welcome", "name"), "Reviewer 1");
    fake_hello(&fake, &ben);
    assert_string_equal(heard(&ben, "welcome", "name"), "Reviewer 2");
    fake_say(&fake, &cem, "{\"type\":\"hello\",\"protocol\":2,\"name\":\"Cem\"}");
    assert_string_equal(heard(&cem, "welcome", "name"), "Cem");
}

static void nothing_but_hello_may_come_first(void **state)
{
    (void)state;
    fake_say(&fake, &ann, "{\"type\":\"ping\",\"time_ms\":1}");
    assert_string_equal(refused(&ann), "422 /type");
    assert_true(ann.is_closed);
    assert_false(room_has_member(fake.room, &ann));
}

static void another_protocol_is_told_to_go(void **state)
{
    (void)state;
    fake_say(&fake, &ann, "{\"type\":\"hello\",\"protocol\":1}");
    assert_int_equal(fake_n_heard(&ann, "bye"), 1);
    assert_true(ann.is_closed);
}

static void a_second_hello_is_refused(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ann);
    assert_string_equal(refused(&ann), "422 /type");
    assert_int_equal(room_n_connected(fake.room), 1);
}

static void a_full_room_says_so(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake_hello(&fake, &cem);
    fake_hello(&fake, &dee);
    assert_true(dee.is_closed);
    assert_string_equal(heard(&dee, "bye", "reason"), "the room is full");
    assert_int_equal(room_n_connected(fake.room), 3);
    room_connection_closed(fake.room, &ben, fake.now_us); /* a member that is away makes room for a new one */
    dee.is_closed = false;
    fake_hello(&fake, &dee);
    assert_false(dee.is_closed);
    assert_int_equal(room_n_connected(fake.room), 3);
}

static void a_member_comes_back_with_its_secret_only(void **state)
{
    char id[64], secret[64];
    (void)state;
    fake_hello(&fake, &ann);
    (void)snprintf(id, sizeof id, "%s", heard(&ann, "welcome", "member"));
    (void)snprintf(secret, sizeof secret, "%s", heard(&ann, "welcome", "secret"));
    room_connection_closed(fake.room, &ann, fake.now_us);
    come_back(&cem, id, "00000000000000000000000000000000");
    assert_string_not_equal(heard(&cem, "welcome", "member"), id);
    come_back(&dee, id, secret);
    assert_string_equal(heard(&dee, "welcome", "member"), id);
}

static void coming_back_ends_the_old_connection(void **state)
{
    char id[64], secret[64];
    (void)state;
    fake_join(&fake, &ann, false);
    (void)snprintf(id, sizeof id, "%s", heard(&ann, "welcome", "member"));
    (void)snprintf(secret, sizeof secret, "%s", heard(&ann, "welcome", "secret"));
    come_back(&dee, id, secret);
    assert_true(ann.is_closed);
    assert_int_equal(fake_n_heard(&ann, "bye"), 1);
    room_connection_closed(fake.room, &ann, fake.now_us); /* the late report of its end changes nothing */
    assert_int_equal(room_n_connected(fake.room), 1);
}

static void a_member_who_is_away_is_kept_five_minutes(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    room_connection_closed(fake.room, &ann, fake.now_us);
    fake_pass(&fake, 0);
    fake.again_us = room_settle(fake.room, fake.now_us);
    cJSON *members = room_members(fake.room);
    assert_int_equal(cJSON_GetArraySize(members), 2);
    cJSON_Delete(members);
    fake_pass(&fake, 299999);
    members = room_members(fake.room);
    assert_int_equal(cJSON_GetArraySize(members), 2);
    cJSON_Delete(members);
    fake_pass(&fake, 1);
    members = room_members(fake.room);
    assert_int_equal(cJSON_GetArraySize(members), 1);
    cJSON_Delete(members);
    assert_true(fake.again_us == INT64_MAX);
}

static void who_is_there_is_said_after_each_change(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    size_t before = fake_n_heard(&ann, "members");
    fake_join(&fake, &ben, true); /* enters and follows */
    assert_int_equal(fake_n_heard(&ann, "members"), before + 2);
    room_connection_closed(fake.room, &ben, fake.now_us);
    assert_int_equal(fake_n_heard(&ann, "members"), before + 3);
}

static void a_closed_room_says_bye_to_everybody(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    room_destroy(fake.room);
    assert_true(ann.is_closed && ben.is_closed);
    assert_string_equal(heard(&ann, "bye", "reason"), "the room is closed");
    fake.room = NULL;
}

/* ---- views ------------------------------------------------------------------------------------------------------ */

static void the_shared_view_goes_on_from_who_opened_it_first(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    move(&ann, 42);
    fake_join(&fake, &ben, true);
    cJSON *view = fake_heard(&ben, "view");
    const cJSON *camera = cJSON_GetObjectItem(cJSON_GetObjectItem(view, "document"), "camera");
    assert_close(cJSON_GetArrayItem(cJSON_GetObjectItem(camera, "target_mm"), 0)->valuedouble, 42, 0);
    assert_true(json_flag(view, "follow", false));
    cJSON_Delete(view);
}

static void followers_hear_of_a_move_with_the_frame_that_shows_it_and_once(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    size_t ben_before = fake_n_heard(&ben, "view"), ann_before = fake_n_heard(&ann, "view");
    for (int i = 1; i <= 30; i++)
        move(&ann, i);
    assert_int_equal(fake_n_heard(&ben, "view"), ben_before);
    fake_draw(&fake, fake_oldest(&fake));
    assert_int_equal(fake_n_heard(&ben, "view"), ben_before + 1);
    assert_int_equal(fake_n_heard(&ann, "view"), ann_before); /* not sent to the member who moved it */
}

static void a_shared_view_has_the_presenters_size(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true); /* 800 wide, and presents */
    fake_hello(&fake, &ben);
    fake_say(&fake, &ben, "{\"type\":\"view.open\",\"view\":1,\"document\":{\"size_px\":[400,300]},\"follow\":true}");
    settle_two();
    assert_int_equal(width_of(&fake.requests[fake.n_requests - 1]), 800);
    size_t before = fake.n_requests;
    fake_say(&fake, &ben, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"size_px\":[500,300]}}");
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, before);
    move(&ann, 2);
    assert_int_equal(width_of(fake_newest(&fake)), 800);
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"size_px\":[640,480]}}");
    settle_two();
    assert_int_equal(width_of(&fake.requests[fake.n_requests - 1]), 640);
}

static void an_own_view_starts_as_a_copy_and_goes_its_own_way(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    move(&ann, 7);
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":false}");
    cJSON *view = fake_heard(&ben, "view");
    const cJSON *camera = cJSON_GetObjectItem(cJSON_GetObjectItem(view, "document"), "camera");
    assert_close(cJSON_GetArrayItem(cJSON_GetObjectItem(camera, "target_mm"), 0)->valuedouble, 7, 0);
    cJSON_Delete(view);
    settle_two();
    size_t before = ann.n_frames;
    move(&ben, 8);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ann.n_frames, before);
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":true}"); /* and back */
    view = fake_heard(&ben, "view");
    camera = cJSON_GetObjectItem(cJSON_GetObjectItem(view, "document"), "camera");
    assert_close(cJSON_GetArrayItem(cJSON_GetObjectItem(camera, "target_mm"), 0)->valuedouble, 7, 0);
    cJSON_Delete(view);
}

/* Half as many pixels at the same scale show half as many mm; a beam's-eye view has a scale with its ring only. */
static void an_own_beams_eye_view_keeps_ring_scale_and_beam_slice(void **state)
{
    (void)state;
    for (int has_ring = 0; has_ring < 2; has_ring++) {
        fake_hello(&fake, &ann);
        fake_hello(&fake, &ben);
        fake_say(
            &fake, &ann,
            "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"kind\":\"beam\",\"size_px\":[800,600],"
            "\"camera\":{\"height_mm\":240},\"beam\":{\"along_mm\":-30%s}}}",
            has_ring ? ",\"aperture_mm\":90" : "");
        fake_say(&fake, &ben,
                 "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"kind\":\"beam\",\"size_px\":[400,"
                 "300]}}");
        fake_say(&fake, &ann,
                 "{\"type\":\"scene.patch\",\"patch\":{\"beam\":{\"slice\":{\"along_mm\":44}}},\"input\":1}");
        fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":false}");
        cJSON *said = fake_heard(&ben, "view");
        const cJSON *document = cJSON_GetObjectItem(said, "document"), *beam = cJSON_GetObjectItem(document, "beam"),
                    *override = cJSON_GetObjectItem(document, "override");
        assert_close(json_number(cJSON_GetObjectItem(document, "camera"), "height_mm", NAN), has_ring ? 120 : 240, 0);
        assert_close(json_number(beam, "along_mm", NAN), -30, 0);
        assert_close(json_number(beam, "aperture_mm", 0), has_ring ? 90 : 0, 0);
        assert_close(json_number(cJSON_GetObjectItem(cJSON_GetObjectItem(override, "beam"), "slice"), "along_mm", NAN),
                     44, 0);
        cJSON_Delete(said);
        room_end(NULL);
        room_start(NULL);
    }
}

static void each_kind_has_its_own_shared_view(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.open\",\"view\":2,\"document\":{\"kind\":\"axial\",\"size_px\":[300,300]},\"follow\":true}");
    assert_int_equal(fake_outstanding(&fake), 2);
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"camera\":{\"height_mm\":120}}}");
    settle_one();
    size_t before = fake.n_requests;
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"kind\":\"coronal\"}}");
    assert_int_equal(fake.n_requests, before + 1);
    assert_string_equal(json_text(fake_newest(&fake)->view, "kind"), "coronal");
}

static void a_view_that_is_closed_gets_nothing_more(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    struct fake_request *request = fake_newest(&fake);
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":1}");
    fake_draw(&fake, request);
    assert_int_equal(ann.n_frames, 0);
    fake_pass(&fake, 1000);
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":1}");
    assert_string_equal(refused(&ann), "404 /view");
}

static void pictures_of_a_closed_view_are_waited_for_by_nobody(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    struct fake_request *request = fake_newest(&fake);
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":1}");
    assert_false(request->is_forgotten); /* ben still views it */
    fake_say(&fake, &ben, "{\"type\":\"view.close\",\"view\":1}");
    assert_true(request->is_forgotten);
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_pass(&fake, 1000);
    assert_int_equal(fake_outstanding(&fake), 0); /* without a viewer nothing is requested */
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"kind\":\"3d\",\"size_px\":[800,600]}}");
    assert_true(fake_outstanding(&fake) > 0); /* a viewer who comes back needs the picture again */
    settle_one();
    assert_true(ann.frames[ann.n_frames - 1].flags & FRAME_STILL);

    fake_turn(&fake, &ann, 10, 5);
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":1}");
    assert_int_equal(fake_outstanding(&fake), 0);
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"kind\":\"3d\",\"size_px\":[800,600]}}");
    assert_int_equal(fake_outstanding(&fake), 1); /* at once, long before a still is due */
    assert_false(fake_newest(&fake)->is_still);
    settle_one();

    fake_say(&fake, &ann, "{\"type\":\"view.open\",\"view\":1,\"document\":{}}");
    fake_turn(&fake, &ann, 30, 7); /* an own view whose page disconnects without closing it */
    request = fake_newest(&fake);
    assert_non_null(request);
    room_connection_closed(fake.room, &ann, fake.now_us);
    assert_true(request->is_forgotten);
}

static void a_frame_of_a_view_closed_meanwhile_may_still_be_acknowledged(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_draw(&fake, fake_newest(&fake));
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":1}");
    fake_shown(&fake, &ann);
    assert_int_equal(fake_n_heard(&ann, "problem"), 0);
}

static void an_override_shows_another_scene_to_one_view(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"override\":{\"regions\":{\"scalp\":{\"visible\":false}}}}}");
    settle_one();
    const cJSON *scene = fake.requests[fake.n_requests - 1].scene;
    assert_non_null(scene);
    assert_false(json_flag(cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "regions"), "scalp"), "visible", true));
    assert_true(json_flag(cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "regions"), "brain"), "visible", false));
    /* the room's scene changes below the override */
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"opacity\":0.5}}}}");
    scene = fake_newest(&fake)->scene;
    assert_close(json_number(cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "regions"), "brain"), "opacity", 0), 0.5,
                 0);
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"override\":{\"regions\":{\"liver\":{\"visible\":false}}}}}");
    assert_string_equal(refused(&ann), "422 /override/regions/liver");
}

static void a_view_number_outside_one_to_eight_is_refused(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_say(&fake, &ann, "{\"type\":\"view.open\",\"view\":9,\"document\":{}}");
    assert_string_equal(refused(&ann), "422 /view");
    fake_say(&fake, &ann, "{\"type\":\"view.open\",\"view\":0,\"document\":{}}");
    assert_string_equal(refused(&ann), "422 /view");
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(hello_is_answered_with_everything_a_page_needs),
        ROOM_TEST(who_gives_no_name_is_numbered),
        ROOM_TEST(nothing_but_hello_may_come_first),
        ROOM_TEST(another_protocol_is_told_to_go),
        ROOM_TEST(a_second_hello_is_refused),
        ROOM_TEST(a_full_room_says_so),
        ROOM_TEST(a_member_comes_back_with_its_secret_only),
        ROOM_TEST(coming_back_ends_the_old_connection),
        ROOM_TEST(a_member_who_is_away_is_kept_five_minutes),
        ROOM_TEST(who_is_there_is_said_after_each_change),
        ROOM_TEST(a_closed_room_says_bye_to_everybody),
        ROOM_TEST(the_shared_view_goes_on_from_who_opened_it_first),
        ROOM_TEST(followers_hear_of_a_move_with_the_frame_that_shows_it_and_once),
        ROOM_TEST(a_shared_view_has_the_presenters_size),
        ROOM_TEST(an_own_view_starts_as_a_copy_and_goes_its_own_way),
        ROOM_TEST(an_own_beams_eye_view_keeps_ring_scale_and_beam_slice),
        ROOM_TEST(each_kind_has_its_own_shared_view),
        ROOM_TEST(a_view_that_is_closed_gets_nothing_more),
        ROOM_TEST(pictures_of_a_closed_view_are_waited_for_by_nobody),
        ROOM_TEST(a_frame_of_a_view_closed_meanwhile_may_still_be_acknowledged),
        ROOM_TEST(an_override_shows_another_scene_to_one_view),
        ROOM_TEST(a_view_number_outside_one_to_eight_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
