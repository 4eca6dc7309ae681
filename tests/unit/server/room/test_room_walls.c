/* Walls: members with views of their own size that follow the presenter, places of their own, and what they are told.
 */
#include <math.h>

#include "tests/unit/room_set_up.h"

static struct fake_page wall;
static struct fake_room again;

static int end(void **state)
{
    const int failed = room_end(state);
    fake_page_end(&wall);
    return failed;
}
#define WALL_TEST(name) cmocka_unit_test_setup_teardown(name, room_start, end)

static void hang(struct fake_page *page)
{
    fake_say(&fake, page, "{\"type\":\"hello\",\"protocol\":2,\"wall\":true}");
}

static void show(struct fake_page *page, int view, const char *kind, int width, int height)
{
    fake_say(&fake, page,
             "{\"type\":\"view.open\",\"view\":%d,\"document\":{\"kind\":\"%s\",\"size_px\":[%d,%d],"
             "\"pixel_ratio\":1.4},\"follow\":true}",
             view, kind, width, height);
}

/* The newest request for a wall, answered or not; NULL: none. */
static struct fake_request *for_wall(void)
{
    for (size_t i = fake.n_requests; i-- > 0;)
        if (fake.requests[i].is_of_wall)
            return &fake.requests[i];
    return NULL;
}

static double field(const struct fake_request *request, const char *object, const char *name)
{
    const cJSON *of = object ? cJSON_GetObjectItem(request->view, object) : request->view;
    return json_number(of, name, NAN);
}

static int side(const struct fake_request *request, int i)
{
    return cJSON_GetArrayItem(cJSON_GetObjectItem(request->view, "size_px"), i)->valueint;
}

/* Draws and shows everything that is requested, of all pages and views. */
static void settle_all(void)
{
    for (int turn = 0; turn < 12; turn++) {
        for (struct fake_request *request; (request = fake_oldest(&fake));)
            fake_draw(&fake, request);
        struct fake_page *const pages[] = { &ann, &ben, &wall };
        for (size_t i = 0; i < sizeof pages / sizeof pages[0]; i++) {
            uint32_t newest[ROOM_MAX_VIEWS + 1] = { 0 };
            for (size_t frame = 0; frame < pages[i]->n_frames; frame++)
                newest[pages[i]->frames[frame].view] = pages[i]->frames[frame].sequence;
            for (int view = 1; view <= ROOM_MAX_VIEWS; view++)
                if (newest[view])
                    fake_say(&fake, pages[i], "{\"type\":\"frame.shown\",\"view\":%d,\"sequence\":%u}", view,
                             newest[view]);
        }
        fake_pass(&fake, 200);
    }
    assert_int_equal(fake_outstanding(&fake), 0);
}

static void a_wall_is_sent_pictures_of_its_own_size_that_follow_the_presenter(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    settle_all();
    hang(&wall);
    show(&wall, 1, "3d", 837, 434);
    settle_all();
    const struct fake_request *request = for_wall();
    assert_non_null(request);
    assert_int_equal(side(request, 0), 837);
    assert_int_equal(side(request, 1), 434);
    assert_near(field(request, NULL, "pixel_ratio"), 1.4, 1e-9);
    assert_int_equal(wall.frames[wall.n_frames - 1].width_px, 837);

    fake_turn(&fake, &ann, 8, 21);
    const double x = fake_camera_x(fake_oldest(&fake));
    settle_all();
    assert_near(fake_camera_x(for_wall()), x, 1e-9);
    const struct fake_request *own = NULL;
    for (size_t i = 0; i < fake.n_requests; i++)
        if (!fake.requests[i].is_of_wall)
            own = &fake.requests[i];
    assert_int_equal(side(own, 0), 800); /* Ann's pictures are what they were */
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        assert_false(own->is_reduced[i]);
}

static void all_that_the_presenter_sees_is_on_a_wall_of_another_shape(void **state)
{
    (void)state;
    hang(&wall);
    fake_hello(&fake, &ann);
    fake_say(&fake, &ann,
             "{\"type\":\"view.open\",\"view\":2,\"document\":{\"kind\":\"axial\",\"size_px\":[400,800],"
             "\"camera\":{\"height_mm\":100}},\"follow\":true}"); /* 100 x 200 mm */
    show(&wall, 2, "axial", 900, 400);
    assert_near(field(for_wall(), "camera", "height_mm"), 200, 1e-9);
    fake_say(&fake, &wall, "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"size_px\":[300,600]}}"); /* like Ann's */
    settle_all();
    assert_near(field(for_wall(), "camera", "height_mm"), 100, 1e-9);
    assert_int_equal(side(for_wall(), 1), 600);
    fake_say(&fake, &wall, "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"camera\":{\"height_mm\":5}}}");
    assert_string_equal(refused(&wall), "409 ");
    fake_say(&fake, &wall, "{\"type\":\"follow\",\"follow\":false}");
    assert_string_equal(refused(&wall), "409 ");
    fake_say(&fake, &wall, "{\"type\":\"view.open\",\"view\":3,\"document\":{\"kind\":\"axial\"}}");
    cJSON *view = fake_heard(&wall, "view");
    assert_true(json_flag(view, "follow", false)); /* also where it does not ask for that */
    cJSON_Delete(view);
}

static void walls_of_one_size_share_their_pictures_and_the_last_one_takes_them_away(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    hang(&wall);
    hang(&dee);
    show(&wall, 1, "3d", 837, 434);
    show(&dee, 4, "3d", 837, 434);
    settle_all();
    size_t n_requests = fake.n_requests;
    fake_turn(&fake, &ann, 8, 21);
    fake_pass(&fake, 20);
    assert_int_equal(fake.n_requests, n_requests + 2); /* Ann's, and one for both walls */
    room_connection_closed(fake.room, &wall, fake.now_us);
    fake_page_end(&wall);
    fake_say(&fake, &dee, "{\"type\":\"view.close\",\"view\":4}");
    settle_all();
    n_requests = fake.n_requests;
    fake_turn(&fake, &ann, 16, 22);
    settle_all();
    for (size_t i = n_requests; i < fake.n_requests; i++)
        assert_false(fake.requests[i].is_of_wall);
}

static void a_wall_asks_for_one_picture_at_a_time_and_not_for_each_move(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    hang(&wall);
    show(&wall, 1, "3d", 837, 434);
    settle_all();
    size_t n_of_wall = 0, n_of_ann = 0;
    const size_t first = fake.n_requests;
    for (int i = 0; i < 100; i++) { /* a second of moves, each drawn at once */
        fake_turn(&fake, &ann, i + 1, 30 + (unsigned)i);
        for (struct fake_request *request; (request = fake_oldest(&fake));)
            fake_draw(&fake, request);
        fake_shown(&fake, &ann);
        if (wall.n_frames)
            fake_shown(&fake, &wall);
        fake_pass(&fake, 10);
    }
    for (size_t i = first; i < fake.n_requests; i++)
        *(fake.requests[i].is_of_wall ? &n_of_wall : &n_of_ann) += 1;
    assert_in_range(n_of_wall, 15, 21); /* 50 ms between two */
    assert_true(n_of_ann >= 90);
}

static void walls_take_no_place_of_a_person_and_presence_of_none(void **state)
{
    static struct fake_page walls[ROOM_MAX_WALLS_IN + 1];
    (void)state;
    for (int i = 0; i < ROOM_MAX_WALLS_IN; i++)
        hang(&walls[i]);
    assert_int_equal(room_n_connected(fake.room), 0);
    fake_hello(&fake, &ann); /* the room is for three */
    fake_hello(&fake, &ben);
    fake_hello(&fake, &cem);
    assert_false(ann.is_closed || ben.is_closed || cem.is_closed);
    assert_int_equal(room_n_connected(fake.room), 3);
    fake_hello(&fake, &dee);
    assert_true(dee.is_closed);
    hang(&walls[ROOM_MAX_WALLS_IN]);
    assert_true(walls[ROOM_MAX_WALLS_IN].is_closed);
    for (int i = 0; i < ROOM_MAX_WALLS_IN; i++)
        assert_false(walls[i].is_closed);
    cJSON *members = fake_heard(&ann, "members"), *list = cJSON_GetObjectItem(members, "members");
    const cJSON *row;
    int n_walls = 0;
    cJSON_ArrayForEach(row, list)
    {
        const bool is_wall = strcmp(json_text(row, "role"), "wall") == 0;
        n_walls += is_wall;
        if (json_flag(row, "presenting", false))
            assert_false(is_wall);
    }
    assert_int_equal(n_walls, ROOM_MAX_WALLS_IN);
    assert_int_equal(cJSON_GetArraySize(list), ROOM_MAX_WALLS_IN + 3);
    cJSON_Delete(members);
    cJSON *record = room_record(fake.room);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(record, "present")), 3);
    cJSON_Delete(record);
    room_destroy(fake.room);
    for (int i = 0; i <= ROOM_MAX_WALLS_IN; i++)
        fake_page_end(&walls[i]);
    fake_room_start(&fake, 3);
}

static const char *active_kind(const struct fake_page *page)
{
    static char text[32];
    cJSON *message = fake_heard(page, "wall");
    const char *kind = json_text(cJSON_GetObjectItem(message, "active"), "kind");
    (void)snprintf(text, sizeof text, "%s", kind ? kind : "");
    cJSON_Delete(message);
    return text;
}

static void a_wall_is_told_at_once_in_which_view_the_presenter_changed_something(void **state)
{
    (void)state;
    fake_join(&fake, &ann, true);
    static const char *const kinds[] = { "axial", "sagittal", "coronal" };
    for (int i = 0; i < 3; i++)
        show(&ann, i + 2, kinds[i], 400, 300);
    hang(&wall);
    show(&wall, 1, "3d", 837, 434);
    assert_string_equal(active_kind(&wall), "3d");
    fake_say(&fake, &ann, "{\"type\":\"view.active\",\"view\":2}"); /* chosen: nothing of it has changed yet */
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":7}}}},"
             "\"view\":4}");
    assert_string_equal(active_kind(&wall), "coronal");
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":3,\"patch\":{\"camera\":{\"height_mm\":90}}}");
    assert_string_equal(active_kind(&wall), "sagittal");
    fake_say(&fake, &ann,
             "{\"type\":\"view.patch\",\"view\":2,\"patch\":{\"camera\":{\"height_mm\":90}},\"acted\":false}");
    assert_string_equal(active_kind(&wall), "sagittal"); /* it went along */
    fake_say(&fake, &ann, "{\"type\":\"view.close\",\"view\":3}");
    assert_string_equal(active_kind(&wall), "axial"); /* the one that is active */
    cJSON *message = fake_heard(&wall, "wall");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(message, "views")), 3);
    cJSON_Delete(message);
}

static void the_presenter_chooses_what_walls_show_and_it_is_kept(void **state)
{
    struct store_room kept;
    (void)state;
    fake_join(&fake, &ann, true);
    fake_join(&fake, &ben, true);
    hang(&wall);
    show(&wall, 1, "3d", 837, 434);
    assert_string_equal(heard(&wall, "wall", "layout"), "four");
    fake_say(&fake, &ben, "{\"type\":\"wall.layout\",\"layout\":\"presenter\"}");
    assert_string_equal(refused(&ben), "403 ");
    fake_say(&fake, &wall, "{\"type\":\"wall.layout\",\"layout\":\"presenter\"}");
    assert_string_equal(refused(&wall), "403 ");
    fake_say(&fake, &ann, "{\"type\":\"wall.layout\",\"layout\":\"worked-in\"}");
    assert_string_equal(heard(&wall, "wall", "layout"), "worked-in");
    assert_string_equal(heard(&ben, "wall", "layout"), "worked-in");
    assert_true(room_keep(fake.room, ROOM_ALL_PARTS, &kept));
    assert_int_equal(kept.n_members, 2); /* a wall has no seat to come back to */
    fake_room_start(&again, 3);
    room_restore(again.room, &kept, again.now_us);
    room_kept_finish(&kept);
    static struct fake_page eve;
    fake_say(&again, &eve, "{\"type\":\"hello\",\"protocol\":2,\"wall\":true}");
    assert_string_equal(heard(&eve, "wall", "layout"), "worked-in");
    fake_room_end(&again);
    fake_page_end(&eve);
}

static void who_removes_a_wall_ends_it_and_its_link_and_nobody_else(void **state)
{
    char token[33];
    struct problem problem = { 0 };
    (void)state;
    fake_join(&fake, &ann, true);
    assert_true(room_link_create(fake.room, WIRE_MEMBER_ROLE_WALL, 3600, false, fake.now_us, token, &problem));
    fake_say(&fake, &wall, "{\"type\":\"hello\",\"protocol\":2,\"wall\":true,\"link\":\"%s\"}", token);
    hang(&dee);
    fake_say(&fake, &ann, "{\"type\":\"member.remove\",\"member\":\"m2\"}");
    assert_string_equal(heard(&wall, "bye", "code"), "removed");
    assert_true(wall.is_closed && !dee.is_closed && !ann.is_closed);
    fake_page_end(&wall);
    fake_say(&fake, &wall, "{\"type\":\"hello\",\"protocol\":2,\"wall\":true,\"link\":\"%s\"}", token);
    assert_true(wall.is_closed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        WALL_TEST(a_wall_is_sent_pictures_of_its_own_size_that_follow_the_presenter),
        WALL_TEST(all_that_the_presenter_sees_is_on_a_wall_of_another_shape),
        WALL_TEST(walls_of_one_size_share_their_pictures_and_the_last_one_takes_them_away),
        WALL_TEST(a_wall_asks_for_one_picture_at_a_time_and_not_for_each_move),
        WALL_TEST(walls_take_no_place_of_a_person_and_presence_of_none),
        WALL_TEST(a_wall_is_told_at_once_in_which_view_the_presenter_changed_something),
        WALL_TEST(the_presenter_chooses_what_walls_show_and_it_is_kept),
        WALL_TEST(who_removes_a_wall_ends_it_and_its_link_and_nobody_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
