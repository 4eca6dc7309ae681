/* Oblique views of a room: there is a shared one for each plane. */
#include "server/room/state/room_state.h"
#include "tests/unit/room_set_up.h"

static void open_oblique(struct fake_page *page, int view, const char *plane, bool follow)
{
    fake_say(&fake, page,
             "{\"type\":\"view.open\",\"view\":%d,\"follow\":%s,\"document\":{\"kind\":\"oblique\",\"plane\":\"%s\","
             "\"size_px\":[400,300]}}",
             view, follow ? "true" : "false", plane);
}

/* The stream that a view of the n-th member shows. */
static const struct stream *stream_of(int member, int view)
{
    assert_in_range(member, 0, fake.room->members.n - 1);
    return fake.room->members.list[member]->views[view - 1].stream;
}

static size_t n_shared_obliques(void)
{
    size_t n = 0;
    for (const struct stream *stream = fake.room->streams.first; stream; stream = stream->next)
        n += stream->is_shared && stream->kind == SCENE_KIND_OBLIQUE;
    return n;
}

static double target_x(const struct stream *stream)
{
    const cJSON *target = cJSON_GetObjectItem(cJSON_GetObjectItem(stream->view, "camera"), "target_mm");
    return cJSON_IsArray(target) ? cJSON_GetArrayItem(target, 0)->valuedouble : NAN;
}

static void two_oblique_panes_of_the_presenter_are_two_shared_views(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    open_oblique(&ann, 2, "a", true);
    open_oblique(&ann, 3, "b", true);
    assert_ptr_not_equal(stream_of(0, 2), stream_of(0, 3));
    open_oblique(&ben, 2, "b", true);
    open_oblique(&ben, 3, "a", true);
    assert_ptr_equal(stream_of(1, 2), stream_of(0, 3));
    assert_ptr_equal(stream_of(1, 3), stream_of(0, 2));

    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":3,\"patch\":{\"camera\":{\"target_mm\":[7,0,0]}}}");
    assert_float_equal(target_x(stream_of(1, 2)), 7, 0);
    assert_true(isnan(target_x(stream_of(1, 3))));
}

static void the_presenter_shows_another_plane_in_a_pane_and_followers_of_the_first_stay(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    open_oblique(&ann, 2, "a", true);
    open_oblique(&ben, 2, "a", true);
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"plane\":\"b\"}}");
    assert_string_equal(json_text(stream_of(0, 2)->view, "plane"), "b");
    assert_string_equal(json_text(stream_of(1, 2)->view, "plane"), "a");
    assert_ptr_not_equal(stream_of(0, 2), stream_of(1, 2));
}

/* A plane of another kind of view means nothing: such views are one. */
static void a_plane_tells_only_oblique_views_apart(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_say(&fake, &ann,
             "{\"type\":\"view.open\",\"view\":2,\"follow\":true,\"document\":{\"kind\":\"axial\",\"plane\":\"a\"}}");
    fake_say(&fake, &ben,
             "{\"type\":\"view.open\",\"view\":2,\"follow\":true,\"document\":{\"kind\":\"axial\",\"plane\":\"b\"}}");
    assert_ptr_equal(stream_of(0, 2), stream_of(1, 2));
}

/* The first of two panes of a plane gives the shared view its document; another plane's pane has its own. */
static void who_takes_over_shares_each_plane(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    open_oblique(&ann, 2, "a", true);
    open_oblique(&ben, 2, "a", false);
    open_oblique(&ben, 3, "b", false);
    open_oblique(&ben, 4, "a", false);
    fake_say(&fake, &ben, "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"camera\":{\"target_mm\":[2,0,0]}}}");
    fake_say(&fake, &ben, "{\"type\":\"view.patch\",\"view\":3,\"patch\":{\"camera\":{\"target_mm\":[3,0,0]}}}");
    fake_say(&fake, &ben, "{\"type\":\"view.patch\",\"view\":4,\"patch\":{\"camera\":{\"target_mm\":[4,0,0]}}}");
    fake_join(&fake, &cem, true);
    open_oblique(&cem, 2, "a", true);
    room_connection_closed(fake.room, &ann, fake.now_us);
    fake_pass(&fake, 31000); /* nobody presents any more */
    fake_say(&fake, &ben, "{\"type\":\"present\"}");
    for (int view = 2; view <= 4; view++)
        assert_true(stream_of(1, view)->is_shared);
    assert_ptr_equal(stream_of(1, 2), stream_of(2, 2));
    assert_ptr_equal(stream_of(1, 4), stream_of(2, 2));
    assert_float_equal(target_x(stream_of(2, 2)), 2, 0);
    assert_float_equal(target_x(stream_of(1, 3)), 3, 0);
}

static void who_leaves_keeps_the_plane_where_it_is(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"obliques\":{\"a\":{\"origin_mm\":[1,2,3],\"normal\":"
             "[0,1,1]}}}}}");
    open_oblique(&ann, 2, "a", true);
    open_oblique(&ben, 2, "a", true);
    fake_say(&fake, &ben, "{\"type\":\"follow\",\"follow\":false}");
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"obliques\":{\"a\":{\"origin_mm\":[9,9,9]}}}}}");
    const cJSON *override = cJSON_GetObjectItem(stream_of(1, 2)->view, "override"),
                *planes = cJSON_GetObjectItem(cJSON_GetObjectItem(override, "image"), "obliques"),
                *plane = cJSON_GetObjectItem(planes, "a"), *origin = cJSON_GetObjectItem(plane, "origin_mm"),
                *normal = cJSON_GetObjectItem(plane, "normal");
    const double expected[2][3] = { { 1, 2, 3 }, { 0, 1, 1 } };
    assert_int_equal(cJSON_GetArraySize(origin), 3);
    assert_int_equal(cJSON_GetArraySize(normal), 3);
    for (int i = 0; i < 3; i++) {
        assert_float_equal(cJSON_GetArrayItem(origin, i)->valuedouble, expected[0][i], 0);
        assert_float_equal(cJSON_GetArrayItem(normal, i)->valuedouble, expected[1][i], 0);
    }
}

static void shared_views_of_planes_that_nobody_sees_do_not_add_up(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    for (int i = 0; i < 100; i++) {
        char plane[16];
        (void)snprintf(plane, sizeof plane, "p%d", i);
        open_oblique(&ann, 2, plane, true);
    }
    assert_true(n_shared_obliques() <= 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(two_oblique_panes_of_the_presenter_are_two_shared_views),
        ROOM_TEST(the_presenter_shows_another_plane_in_a_pane_and_followers_of_the_first_stay),
        ROOM_TEST(a_plane_tells_only_oblique_views_apart),
        ROOM_TEST(who_takes_over_shares_each_plane),
        ROOM_TEST(who_leaves_keeps_the_plane_where_it_is),
        ROOM_TEST(shared_views_of_planes_that_nobody_sees_do_not_add_up),
    };
    return cmocka_run_group_tests_name("room_obliques", tests, NULL, NULL);
}
