/* The presenter, and the effects of leaving, returning, taking over and calling back. At random: test_room_following.c.
 */
#include "tests/unit/room_set_up.h"

static const char leave[] = "{\"type\":\"follow\",\"follow\":false}",
                  come_back[] = "{\"type\":\"follow\",\"follow\":true}", present[] = "{\"type\":\"present\"}",
                  show_everyone[] = "{\"type\":\"show.everyone\"}";

/* "presents", "follows" or "alone" of a member by its place in the list, as the list told last has it. */
static const char *role(const struct fake_page *page, int place)
{
    cJSON *said = fake_heard(page, "members");
    const cJSON *item = cJSON_GetArrayItem(cJSON_GetObjectItem(said, "members"), place);
    bool presents = json_flag(item, "presenting", false), follows = json_flag(item, "following", false);
    assert_false(presents && follows);
    cJSON_Delete(said);
    return presents ? "presents" : follows ? "follows" : "alone";
}

/* The document in the newest view message. */
static cJSON *told_view(const struct fake_page *page)
{
    cJSON *said = fake_heard(page, "view"), *document = cJSON_DetachItemFromObject(said, "document");
    cJSON_Delete(said);
    assert_non_null(document);
    return document;
}

static double position_mm(const cJSON *scene, const char *slice)
{
    const cJSON *slices = cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "image"), "slices");
    return json_number(cJSON_GetObjectItem(slices, slice), "position_mm", -1);
}

static double height_mm(const cJSON *view)
{
    return json_number(cJSON_GetObjectItem(view, "camera"), "height_mm", -1);
}

static void patch_view(struct fake_page *page, const char *patch)
{
    fake_say(&fake, page, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{%s}}", patch);
}

static void patch_axial(struct fake_page *page, int mm)
{
    fake_say(&fake, page,
             "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":%d}}}}}", mm);
}

static void open_axial(struct fake_page *page, int width, int height)
{
    fake_say(
        &fake, page,
        "{\"type\":\"view.open\",\"view\":1,\"document\":{\"kind\":\"axial\",\"size_px\":[%d,%d]},\"follow\":true}",
        width, height);
}

static void tick(void)
{
    fake.again_us = room_settle(fake.room, fake.now_us);
}

static void lose(struct fake_page *page)
{
    room_connection_closed(fake.room, page, fake.now_us);
    tick();
}

static void who_is_alone_presents_and_the_next_one_follows(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    assert_string_equal(role(&ann, 0), "presents");
    fake_join(&fake, &ben, true);
    assert_string_equal(role(&ben, 0), "presents");
    assert_string_equal(role(&ben, 1), "follows");
}

static void a_follower_changes_nothing_of_others_and_is_told_so(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    size_t n_drawn = fake.n_requests;
    patch_view(&ben, "\"camera\":{\"height_mm\":50}");
    assert_string_equal(refused(&ben), "403 ");
    patch_view(&ben, "\"size_px\":[100,100],\"override\":{\"regions\":{\"scalp\":{\"visible\":false}}}");
    assert_string_equal(refused(&ben), "403 ");
    patch_view(&ben, "\"kind\":\"axial\"");
    assert_string_equal(refused(&ben), "403 ");
    patch_axial(&ben, 30);
    assert_string_equal(refused(&ben), "403 ");
    fake_say(&fake, &ben, "%s", show_everyone);
    fake_say(&fake, &ben, "%s", present);
    assert_int_equal(fake_n_heard(&ben, "problem"), 6);
    patch_view(&ben, "\"size_px\":[8,8]"); /* what is wrong is still said to be wrong */
    assert_string_equal(refused(&ben), "422 /size_px/0");
    patch_view(&ben, "");
    assert_int_equal(fake_n_heard(&ben, "problem"), 7);
    fake_pass(&fake, 1000);
    assert_int_equal(fake.n_requests, n_drawn);
    assert_int_equal(fake_n_heard(&ann, "problem"), 0);
    assert_int_equal(fake_n_heard(&ann, "scene"), 0);
}

static void the_presenter_cannot_leave(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_say(&fake, &ann, "%s", leave);
    assert_string_equal(refused(&ann), "403 /follow");
    assert_string_equal(role(&ann, 0), "presents");
}

/* ---- leaving and returning -------------------------------------------------------------------------------------- */

static void who_leaves_goes_on_from_what_was_shown_in_the_own_size_and_scale(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    open_axial(&ann, 800, 600);
    patch_view(&ann, "\"camera\":{\"height_mm\":120}"); /* 0.2 mm per pixel */
    patch_axial(&ann, 34);
    fake_hello(&fake, &ben);
    open_axial(&ben, 500, 900);
    patch_view(&ben, "\"size_px\":[300,900]");
    fake_say(&fake, &ben, "%s", leave);
    assert_string_equal(role(&ann, 1), "alone");
    cJSON *own = told_view(&ben);
    assert_int_equal(cJSON_GetArrayItem(cJSON_GetObjectItem(own, "size_px"), 0)->valueint, 300);
    assert_close(height_mm(own), 60, 1e-9); /* 300 pixels of 0.2 mm */
    assert_close(position_mm(cJSON_GetObjectItem(own, "override"), "axial"), 34, 0);
    cJSON_Delete(own);
    settle_two();
    patch_axial(&ann, 40);
    settle_two();
    bool has_both[2] = { false };
    for (size_t i = fake.n_requests - 4; i < fake.n_requests; i++) {
        const cJSON *scene = fake.requests[i].scene; /* with Ben's override; else the room's */
        has_both[scene != NULL] = true;
        if (scene)
            assert_close(position_mm(scene, "axial"), 34, 0);
    }
    assert_true(has_both[0] && has_both[1]);
}

static void only_a_parallel_cameras_height_keeps_its_scale(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true); /* 3-D, 800 x 600 */
    patch_view(&ann, "\"camera\":{\"height_mm\":120,\"projection\":\"parallel\"}");
    fake_join(&fake, &ben, true);
    patch_view(&ben, "\"size_px\":[400,300]");
    fake_say(&fake, &ben, "%s", leave);
    cJSON *own = told_view(&ben);
    assert_close(height_mm(own), 60, 1e-9);
    cJSON_Delete(own);
    fake_say(&fake, &ben, "%s", come_back);
    patch_view(&ann, "\"camera\":{\"projection\":\"perspective\"}");
    fake_say(&fake, &ben, "%s", leave);
    own = told_view(&ben);
    assert_close(height_mm(own), 120, 0); /* it does not count: the opening angle does */
    cJSON_Delete(own);
    fake_say(&fake, &ben, "%s", come_back);
    patch_view(&ann, "\"camera\":{\"projection\":\"parallel\",\"height_mm\":10000}");
    patch_view(&ben, "\"size_px\":[4096,4096]");
    fake_say(&fake, &ben, "%s", leave);
    own = told_view(&ben);
    assert_close(height_mm(own), 10000, 0); /* the largest that a view may have */
    cJSON_Delete(own);
}

static void an_override_of_the_shared_view_goes_along(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    patch_axial(&ann, 34);
    patch_view(&ann, "\"override\":{\"regions\":{\"scalp\":{\"visible\":false}},"
                     "\"image\":{\"slices\":{\"axial\":{\"position_mm\":8}}}}");
    fake_join(&fake, &ben, true);
    fake_say(&fake, &ben, "%s", leave);
    cJSON *own = told_view(&ben);
    const cJSON *override = cJSON_GetObjectItem(own, "override"),
                *scalp = cJSON_GetObjectItem(cJSON_GetObjectItem(override, "regions"), "scalp");
    assert_false(json_flag(scalp, "visible", true));
    assert_close(position_mm(override, "axial"), 8, 0); /* what was shown, not what the scene says */
    assert_close(position_mm(override, "coronal"), 0, 0);
    cJSON_Delete(own);
}

static void who_returns_sees_what_all_see(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_say(&fake, &ben, "%s", leave);
    patch_view(&ben, "\"camera\":{\"height_mm\":77},\"override\":{\"regions\":{\"scalp\":{\"visible\":false}}}");
    settle_two();
    size_t n_drawn = fake.n_requests, n_frames = ben.n_frames;
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":true,\"input\":9}");
    cJSON *view = told_view(&ben);
    assert_close(height_mm(view), -1, 0);
    assert_false(cJSON_IsObject(cJSON_GetObjectItem(view, "override")) && cJSON_GetObjectItem(view, "override")->child);
    cJSON_Delete(view);
    assert_int_equal(ben.n_frames, n_frames + 1); /* the picture that is there */
    assert_int_equal(ben.frames[n_frames].input_id, 9);
    assert_int_equal(fake.n_requests, n_drawn);
    assert_string_equal(role(&ann, 1), "follows");
}

static void who_leaves_may_bring_the_views(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    settle_two();
    fake_say(&fake, &ben,
             "{\"type\":\"follow\",\"follow\":false,\"input\":4,\"views\":[{\"view\":1,\"document\":"
             "{\"size_px\":[320,240],\"camera\":{\"height_mm\":55},"
             "\"override\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":12}}}}}}]}");
    cJSON *own = told_view(&ben);
    assert_close(height_mm(own), 55, 0);
    cJSON_Delete(own);
    assert_close(position_mm(fake_newest(&fake)->scene, "axial"), 12, 0);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(ben.frames[ben.n_frames - 1].input_id, 4);
    assert_false(ben.frames[ben.n_frames - 1].flags & FRAME_SHARED);
}

static void views_to_leave_with_are_checked_whole_before_any_applies(void **state)
{
    static const struct {
        const char *views, *problem;
    } bad[] = {
        { "{\"view\":1}", "422 /views" }, /* not a list */
        { "[3]", "422 /views/0" },
        { "[{\"view\":1}]", "422 /views/0/document" },
        { "[{\"document\":{}}]", "422 /views/0/view" },
        { "[{\"view\":\"1\",\"document\":{}}]", "422 /views/0/view" },
        { "[{\"view\":0,\"document\":{}}]", "422 /views/0/view" },
        { "[{\"view\":9,\"document\":{}}]", "422 /views/0/view" },
        { "[{\"view\":1.5,\"document\":{}}]", "422 /views/0/view" },
        { "[{\"view\":1e300,\"document\":{}}]", "422 /views/0/view" },
        { "[{\"view\":2,\"document\":{}}]", "404 /views/0/view" }, /* not open */
        { "[{\"view\":1,\"document\":{},\"x\":1}]", "422 /views/0" },
        { "[{\"view\":1,\"view\":1,\"document\":{}}]", "422 /views/0" },
        { "[{\"view\":1,\"document\":[]}]", "422 /views/0/document" },
        { "[{\"view\":1,\"document\":{\"size_px\":[1,1]}}]", "422 /views/0/document/size_px/0" },
        { "[{\"view\":1,\"document\":{}},{\"view\":1,\"document\":{}}]", "422 /views/1/view" },
        { "[{\"view\":1,\"document\":{\"override\":{\"regions\":{\"liver\":{\"visible\":false}}}}}]",
          "422 /views/0/document/override/regions/liver" },
        { "[{\"view\":1,\"document\":{}},{\"view\":3,\"document\":{\"camera\":{\"fov_deg\":0}}}]",
          "422 /views/1/document/camera/fov_deg" },
    };
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_say(
        &fake, &ben,
        "{\"type\":\"view.open\",\"view\":3,\"document\":{\"kind\":\"axial\",\"size_px\":[64,64]},\"follow\":true}");
    settle_two();
    size_t n_views = fake_n_heard(&ben, "view"), n_members = fake_n_heard(&ann, "members");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":false,\"views\":%s}", bad[i].views);
        assert_int_equal(fake_n_heard(&ben, "problem"), i + 1);
        assert_string_equal(refused(&ben), bad[i].problem);
    }
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":true,\"views\":[]}");
    assert_string_equal(refused(&ben), "422 /views");
    assert_int_equal(fake_n_heard(&ben, "view"), n_views);
    assert_int_equal(fake_n_heard(&ann, "members"), n_members);
    assert_string_equal(role(&ben, 1), "follows");
}

static void who_has_left_and_says_it_again_keeps_the_own_views(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_say(&fake, &ben, "%s", leave);
    patch_view(&ben, "\"camera\":{\"height_mm\":77}");
    fake_say(&fake, &ben, "%s", leave);
    cJSON *own = told_view(&ben);
    assert_close(height_mm(own), 77, 0);
    cJSON_Delete(own);
}

/* ---- the presenter goes ----------------------------------------------------------------------------------------- */

static void a_presenter_who_is_back_within_30_s_presents_and_nothing_has_moved(void **state)
{
    char id[64], secret[64];
    (void)state;
    fake_join(&fake, &ann, true);
    patch_view(&ann, "\"camera\":{\"height_mm\":88}");
    (void)snprintf(id, sizeof id, "%s", heard(&ann, "welcome", "member"));
    (void)snprintf(secret, sizeof secret, "%s", heard(&ann, "welcome", "secret"));
    fake_join(&fake, &ben, true);
    settle_two();
    lose(&ann);
    assert_string_equal(role(&ben, 0), "presents");
    fake_say(&fake, &ben, "%s", present);
    assert_string_equal(refused(&ben), "403 ");
    fake_pass(&fake, 29999);
    assert_string_equal(role(&ben, 0), "presents");
    size_t n_drawn = fake.n_requests, n_views = fake_n_heard(&ben, "view");
    fake_say(&fake, &dee, "{\"type\":\"hello\",\"protocol\":2,\"member\":\"%s\",\"secret\":\"%s\"}", id, secret);
    fake_say(&fake, &dee,
             "{\"type\":\"view.open\",\"view\":1,\"document\":{\"size_px\":[800,600],\"camera\":{\"height_mm\":5}},"
             "\"follow\":true}");
    fake_pass(&fake, 60000);
    assert_string_equal(role(&ben, 0), "presents");
    assert_int_equal(fake.n_requests, n_drawn);
    assert_int_equal(fake_n_heard(&ben, "view"), n_views);
    patch_view(&dee, "\"camera\":{\"height_mm\":99}");
    assert_close(height_mm(fake_newest(&fake)->view), 99, 0);
}

static void a_presenter_whose_connection_went_silent_is_away_since_the_last_sign(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_join(&fake, &cem, true);
    fake_settle(&fake, (struct fake_page *const[]){ &ann, &ben, &cem }, 3);
    const int64_t heard_us = fake.now_us;
    fake_pass(&fake, 15000);
    room_connection_lost(fake.room, &ann, heard_us, fake.now_us);
    tick();
    fake_pass(&fake, 14999);
    assert_string_equal(role(&ben, 0), "presents");
    fake_pass(&fake, 1);
    assert_string_equal(role(&ben, 0), "alone");
    fake_say(&fake, &ben, "%s", present);
    assert_string_equal(role(&ben, 1), "presents");
}

static void after_30_s_nobody_presents_and_anybody_takes_over(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_join(&fake, &cem, true);
    fake_settle(&fake, (struct fake_page *const[]){ &ann, &ben, &cem }, 3);
    lose(&ann);
    size_t n_drawn = fake.n_requests, n_members = fake_n_heard(&ben, "members");
    fake_pass(&fake, 29999);
    assert_string_equal(role(&ben, 0), "presents");
    fake_pass(&fake, 1);
    assert_string_equal(role(&ben, 0), "alone");
    assert_int_equal(fake_n_heard(&ben, "members"), n_members + 1);
    patch_axial(&ben, 5);
    assert_string_equal(refused(&ben), "403 ");
    fake_pass(&fake, 60000);
    assert_int_equal(fake.n_requests, n_drawn); /* all is as it was */
    fake_say(&fake, &cem, "%s", present);
    assert_string_equal(role(&ben, 2), "presents");
    fake_say(&fake, &ben, "%s", present);
    assert_string_equal(refused(&ben), "403 ");
    patch_axial(&cem, 5);
    assert_int_equal(fake_n_heard(&cem, "problem"), 0);
}

static void who_is_left_alone_presents_with_the_own_views(void **state)
{
    uint32_t before, after;
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_say(&fake, &ben, "%s", leave);
    patch_view(&ben,
               "\"camera\":{\"height_mm\":66},\"override\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":21}}}}");
    settle_two();
    lose(&ann);
    (void)room_scene(fake.room, &before);
    fake_pass(&fake, 30000);
    const cJSON *scene = room_scene(fake.room, &after);
    assert_string_equal(role(&ben, 1), "presents");
    assert_int_equal(after, before + 1);
    assert_close(position_mm(scene, "axial"), 21, 0);
    cJSON *view = told_view(&ben);
    assert_close(height_mm(view), 66, 0);
    assert_null(cJSON_GetObjectItem(view, "override"));
    cJSON_Delete(view);
    fake_join(&fake, &cem, true);
    view = told_view(&cem);
    assert_close(height_mm(view), 66, 0);
    cJSON_Delete(view);
}

static void a_full_room_keeps_the_place_of_its_presenter(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake_hello(&fake, &cem);
    lose(&ann);
    fake_hello(&fake, &dee);
    assert_string_equal(heard(&dee, "bye", "reason"), "the room is full");
    fake_pass(&fake, 30000);
    dee.is_closed = false;
    fake_hello(&fake, &dee);
    assert_false(dee.is_closed);
}

/* ---- taking over, calling back ---------------------------------------------------------------------------------- */

static void who_takes_over_shows_the_own_views_to_all(void **state)
{
    uint32_t before, after;
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_join(&fake, &cem, true);
    patch_view(&cem, "\"size_px\":[640,480]");
    fake_say(&fake, &cem, "%s", leave);
    patch_view(
        &cem,
        "\"camera\":{\"height_mm\":66},"
        "\"override\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":21}}},\"regions\":{\"scalp\":{\"opacity\":0.5}}}");
    lose(&ann);
    fake_pass(&fake, 30000);
    (void)room_scene(fake.room, &before);
    fake_settle(&fake, (struct fake_page *const[]){ &ben, &cem }, 2);
    fake_say(&fake, &cem, "{\"type\":\"present\",\"input\":17}");
    const cJSON *scene = room_scene(fake.room, &after);
    assert_int_equal(after, before + 1);
    assert_close(position_mm(scene, "axial"), 21, 0);
    assert_close(json_number(cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "regions"), "scalp"), "opacity", 0), 0.5,
                 0);
    cJSON *told = fake_heard(&ben, "scene");
    assert_string_equal(json_text(told, "by"), "m3");
    cJSON_Delete(told);
    assert_int_equal(fake_outstanding(&fake), 1); /* one picture for both */
    fake_draw(&fake, fake_newest(&fake));
    cJSON *view = told_view(&ben);
    assert_close(height_mm(view), 66, 0);
    assert_int_equal(cJSON_GetArrayItem(cJSON_GetObjectItem(view, "size_px"), 0)->valueint, 640);
    cJSON_Delete(view);
    assert_string_equal(heard(&ben, "view", "by"), "m3");
    assert_true(ben.frames[ben.n_frames - 1].flags & FRAME_SHARED);
    assert_int_equal(cem.frames[cem.n_frames - 1].input_id, 17);
}

static void the_presenter_calls_everybody_back(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_join(&fake, &cem, false);
    fake_say(&fake, &ben, "%s", leave);
    patch_view(&ben, "\"camera\":{\"height_mm\":66}");
    assert_string_equal(role(&ann, 1), "alone");
    fake_say(&fake, &ann, "%s", show_everyone);
    assert_string_equal(role(&ann, 1), "follows");
    assert_string_equal(role(&ann, 2), "follows");
    cJSON *view = told_view(&ben);
    assert_close(height_mm(view), -1, 0);
    cJSON_Delete(view);
    fake_settle(&fake, (struct fake_page *const[]){ &ann, &ben, &cem }, 3);
    size_t n_drawn = fake.n_requests;
    fake_turn(&fake, &ann, 5, 0);
    fake_draw(&fake, fake_newest(&fake));
    assert_int_equal(fake.n_requests, n_drawn + 1);
    assert_int_equal(cem.first_byte_last, ann.first_byte_last);
}

static void a_follower_who_shows_a_new_kind_chooses_nothing_but_its_size(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_hello(&fake, &ben);
    fake_say(
        &fake, &ben,
        "{\"type\":\"view.open\",\"view\":1,\"document\":{\"kind\":\"axial\",\"size_px\":[200,300],"
        "\"camera\":{\"height_mm\":9},\"override\":{\"regions\":{\"scalp\":{\"visible\":false}}}},\"follow\":true}");
    cJSON *view = told_view(&ben);
    assert_close(height_mm(view), -1, 0);
    assert_null(cJSON_GetObjectItem(view, "override"));
    cJSON_Delete(view);
    open_axial(&ann, 640, 480); /* and has the presenter's when the presenter shows it too */
    settle_two();
    view = told_view(&ben);
    assert_int_equal(cJSON_GetArrayItem(cJSON_GetObjectItem(view, "size_px"), 0)->valueint, 640);
    cJSON_Delete(view);
}

static void open_of(struct fake_page *page, int view, const char *document)
{
    fake_say(&fake, page,
             "{\"type\":\"view.open\",\"view\":%d,\"document\":{\"size_px\":[300,300],%s},\"follow\":true}", view,
             document);
}

static double told_x_mm(const struct fake_page *page)
{
    cJSON *view = told_view(page);
    const cJSON *target = cJSON_GetObjectItem(cJSON_GetObjectItem(view, "camera"), "target_mm");
    double x = cJSON_IsArray(target) ? cJSON_GetArrayItem(target, 0)->valuedouble : -1;
    cJSON_Delete(view);
    return x;
}

static void a_second_view_of_a_kind_has_its_own_number_and_is_followed_by_it(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    open_of(&ann, 1, "\"kind\":\"3d\",\"camera\":{\"target_mm\":[11,0,0]}");
    open_of(&ann, 6, "\"kind\":\"3d\",\"number\":2,\"camera\":{\"target_mm\":[22,0,0]}");
    fake_hello(&fake, &ben);
    open_of(&ben, 3, "\"kind\":\"3d\",\"number\":2");
    assert_close(told_x_mm(&ben), 22, 0);
    open_of(&ben, 1, "\"kind\":\"3d\"");
    assert_close(told_x_mm(&ben), 11, 0);
    patch_view(&ann, "\"number\":2"); /* another number is another shared view */
    assert_close(told_x_mm(&ann), 22, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(who_is_alone_presents_and_the_next_one_follows),
        ROOM_TEST(a_follower_changes_nothing_of_others_and_is_told_so),
        ROOM_TEST(the_presenter_cannot_leave),
        ROOM_TEST(who_leaves_goes_on_from_what_was_shown_in_the_own_size_and_scale),
        ROOM_TEST(only_a_parallel_cameras_height_keeps_its_scale),
        ROOM_TEST(an_override_of_the_shared_view_goes_along),
        ROOM_TEST(who_returns_sees_what_all_see),
        ROOM_TEST(who_leaves_may_bring_the_views),
        ROOM_TEST(views_to_leave_with_are_checked_whole_before_any_applies),
        ROOM_TEST(who_has_left_and_says_it_again_keeps_the_own_views),
        ROOM_TEST(a_presenter_who_is_back_within_30_s_presents_and_nothing_has_moved),
        ROOM_TEST(a_presenter_whose_connection_went_silent_is_away_since_the_last_sign),
        ROOM_TEST(after_30_s_nobody_presents_and_anybody_takes_over),
        ROOM_TEST(who_is_left_alone_presents_with_the_own_views),
        ROOM_TEST(a_full_room_keeps_the_place_of_its_presenter),
        ROOM_TEST(who_takes_over_shows_the_own_views_to_all),
        ROOM_TEST(the_presenter_calls_everybody_back),
        ROOM_TEST(a_follower_who_shows_a_new_kind_chooses_nothing_but_its_size),
        ROOM_TEST(a_second_view_of_a_kind_has_its_own_number_and_is_followed_by_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
