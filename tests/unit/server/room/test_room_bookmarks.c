/* Bookmarks of a room: what the room adds to them, and rooms that begin with one. */
#include "server/wire/bookmark.h"
#include "tests/unit/room_set_up.h"

static void put(struct fake_page *page, const char *id, int version, const char *body, unsigned input)
{
    fake_say(&fake, page,
             "{\"type\":\"item.put\",\"item\":\"%s\",\"version\":%d,\"kind\":\"bookmark\",\"body\":%s,\"input\":%u}",
             id, version, body, input);
}

/* The body in the newest message item; the caller's. */
static cJSON *last_body(const struct fake_page *page)
{
    cJSON *said = fake_heard(page, "item");
    cJSON *body = cJSON_DetachItemFromObject(cJSON_GetObjectItem(said, "item"), "body");
    cJSON_Delete(said);
    assert_non_null(body);
    return body;
}

static const cJSON *at(const cJSON *json, const char *path)
{
    char name[64];
    while (json && *path) {
        size_t n = strcspn(path, ".");
        memcpy(name, path, n);
        name[n] = 0;
        json = cJSON_GetObjectItemCaseSensitive(json, name);
        path += n + (path[n] == '.');
    }
    return json;
}

static void a_bookmark_without_scene_keeps_what_differs_from_the_plans_own(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.1}}}}");
    put(&ann, "", 0, "{\"name\":\"thin\"}", 3);
    cJSON *body = last_body(&ann);
    assert_string_equal(json_text(body, "format"), BOOKMARK_FORMAT);
    assert_int_equal(json_number(body, "version", 0), BOOKMARK_VERSION);
    assert_string_equal(json_text(body, "plan"), "head");
    assert_int_equal(strlen(json_text(body, "token")), BOOKMARK_TOKEN_CHARS);
    const cJSON *scene = cJSON_GetObjectItem(body, "scene");
    assert_int_equal(cJSON_GetArraySize(scene), 1);
    assert_int_equal(cJSON_GetArraySize(at(scene, "regions")), 1);
    assert_close(at(scene, "regions.scalp.opacity")->valuedouble, 0.1, 1e-12);
    assert_int_equal(cJSON_GetArraySize(at(scene, "regions.scalp")), 1);
    cJSON_Delete(body);
}

static void the_scene_of_who_looks_alone_is_the_rooms_with_their_override(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, false);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.1}}}}");
    put(&ben, "", 0, "{\"name\":\"b\",\"override\":{\"regions\":{\"brain\":{\"visible\":false}}}}", 4);
    cJSON *body = last_body(&ben);
    assert_null(cJSON_GetObjectItem(body, "override"));
    assert_true(cJSON_IsFalse(at(body, "scene.regions.brain.visible")));
    assert_close(at(body, "scene.regions.scalp.opacity")->valuedouble, 0.1, 1e-12);
    cJSON_Delete(body);
    put(&ben, "", 0, "{\"name\":\"b\",\"override\":{\"regions\":{\"liver\":{}}}}", 5);
    assert_string_equal(refused(&ben), "422 /body/override/regions/liver");
    put(&ben, "", 0, "{\"name\":\"b\",\"override\":[]}", 6);
    assert_string_equal(refused(&ben), "422 /body/override");
    put(&ben, "", 0, "{\"name\":\"b\",\"scene\":{},\"override\":{}}", 7);
    assert_string_equal(refused(&ben), "422 /body/override");
}

static void a_token_is_given_once_and_stays(void **state)
{
    char token[64], id[64], text[256];
    (void)state;
    fake_join(&fake, &ann, false);
    put(&ann, "", 0, "{\"name\":\"one\",\"token\":\"mine\"}", 1);
    assert_string_equal(refused(&ann), "422 /body/token");
    put(&ann, "", 0, "{\"name\":\"one\"}", 2);
    (void)snprintf(id, sizeof id, "%s", heard(&ann, "item", "id"));
    cJSON *body = last_body(&ann);
    (void)snprintf(token, sizeof token, "%s", json_text(body, "token"));
    cJSON_Delete(body);
    (void)snprintf(text, sizeof text,
                   "{\"format\":\"beamroom-bookmark\",\"version\":1,\"name\":\"two\",\"views\":[],\"token\":\"%s\"}",
                   token);
    put(&ann, id, 1, text, 3);
    body = last_body(&ann);
    assert_string_equal(json_text(body, "token"), token);
    assert_string_equal(json_text(body, "name"), "two");
    cJSON_Delete(body);
    put(&ann, id, 2, "{\"format\":\"beamroom-bookmark\",\"version\":1,\"name\":\"two\",\"views\":[],\"token\":\"x\"}",
        4);
    assert_string_equal(refused(&ann), "422 /body/token");

    uint32_t version;
    cJSON *found = room_bookmark_of_token(fake.room, token), *by_id = room_bookmark(fake.room, id, &version);
    assert_non_null(found);
    assert_non_null(by_id);
    assert_int_equal(version, 2);
    cJSON_Delete(found);
    cJSON_Delete(by_id);
    assert_null(room_bookmark_of_token(fake.room, "qwe2rty3u4p5asd6fgh7"));
    fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id);
    assert_null(room_bookmark_of_token(fake.room, token));
    assert_null(room_bookmark(fake.room, id, &version));
}

static void a_bookmark_of_another_plan_or_form_is_refused(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    put(&ann, "", 0, "{\"name\":\"x\",\"plan\":\"foot\"}", 1);
    assert_string_equal(refused(&ann), "422 /body/plan");
    put(&ann, "", 0, "{}", 2);
    assert_string_equal(refused(&ann), "422 /body/name");
    put(&ann, "", 0, "{\"name\":\"x\",\"views\":[7]}", 3);
    assert_string_equal(refused(&ann), "422 /body/views/0");
}

/* A room from a bookmark of a later version: scene and camera are there, what is lost is said. */
static void a_room_begins_with_a_bookmark_and_says_what_of_it_is_lost(void **state)
{
    static const char text[] =
        "{\"format\":\"beamroom-bookmark\",\"version\":2,\"name\":\"later\",\"plan\":\"head\",\"glow\":1,"
        "\"scene\":{\"regions\":{\"scalp\":{\"opacity\":0.7},\"liver\":{}}},"
        "\"views\":[{\"view\":1,\"document\":{\"kind\":\"3d\",\"camera\":{\"position_mm\":[321,0,0],\"target_mm\":[0,0,0],"
        "\"up\":[0,0,1]}}}],\"layout\":{\"layout\":\"2x1\"}}";
    struct fake_room own;
    struct fake_page page = { 0 }, second = { 0 };
    struct problem problem = { 0 };
    (void)state;
    cJSON *bookmark = cJSON_Parse(text);
    fake_room_start(&own, 3);
    assert_true(room_begin_with(own.room, bookmark, &problem));
    cJSON_Delete(bookmark);
    cJSON *saved = room_beginning(own.room);
    assert_string_equal(json_text(saved, "name"), "later");
    assert_null(cJSON_GetObjectItem(saved, "report"));
    cJSON_Delete(saved);

    fake_hello(&own, &page); /* while the plan is being loaded */
    fake_say(
        &own, &page,
        "{\"type\":\"view.open\",\"view\":1,\"document\":{\"kind\":\"3d\",\"size_px\":[800,600]},\"follow\":true}");
    cJSON *view = fake_heard(&page, "view");
    assert_close(cJSON_GetArrayItem(at(view, "document.camera.position_mm"), 0)->valuedouble, 321, 1e-9);
    cJSON_Delete(view);
    fake_plan_ready(&own, true);
    assert_close(at(room_scene(own.room, NULL), "regions.scalp.opacity")->valuedouble, 0.7, 1e-12);
    saved = room_beginning(own.room);
    assert_int_equal(json_number(saved, "n_report", 0), 3); /* version, glow, liver */
    assert_string_equal(json_text(cJSON_GetArrayItem(cJSON_GetObjectItem(saved, "report"), 2), "detail"),
                        "the plan has no region \"liver\"");
    assert_null(cJSON_GetObjectItem(saved, "scene"));
    cJSON_Delete(saved);

    /* it is no more than a beginning: after a restart of the renderer what people have made of it stays */
    fake_say(&own, &page, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.2}}}}");
    fake_plan_ready(&own, true);
    assert_close(at(room_scene(own.room, NULL), "regions.scalp.opacity")->valuedouble, 0.2, 1e-12);
    fake_hello(&own, &second);
    fake_say(&own, &second,
             "{\"type\":\"view.open\",\"view\":1,\"document\":{\"kind\":\"3d\",\"size_px\":[80,60]},\"follow\":true}");
    view = fake_heard(&second, "view");
    assert_close(cJSON_GetArrayItem(at(view, "document.camera.position_mm"), 0)->valuedouble, 321, 1e-9);
    cJSON_Delete(view);
    fake_room_end(&own);
    fake_page_end(&page);
    fake_page_end(&second);
}

/* Ben would be m2 here; in the room of the bookmark somebody else was. */
static void marks_of_a_bookmark_from_another_room_are_nobodys_but_the_presenters(void **state)
{
    static const char text[] =
        "{\"format\":\"beamroom-bookmark\",\"version\":1,\"name\":\"measured\",\"plan\":\"head\",\"scene\":{"
        "\"measures\":{\"m1-m2\":{\"author\":\"Eve\",\"points\":[{\"at_mm\":[0,0,0]},{\"at_mm\":[1,0,0]}]}},"
        "\"probes\":{\"pin-1-m4\":{\"at_mm\":[1,2,3]},\"pin-2-m500001\":{\"at_mm\":[1,2,3]},"
        "\"pin-m\":{\"at_mm\":[1,2,3]},\"pin-m07\":{\"at_mm\":[1,2,3]},\"pin-m4294967297\":{\"at_mm\":[1,2,3]}}}}";
    struct fake_room own;
    struct fake_page first = { 0 }, second = { 0 };
    struct problem problem = { 0 };
    (void)state;
    cJSON *bookmark = cJSON_Parse(text);
    fake_room_start(&own, 3);
    assert_true(room_begin_with(own.room, bookmark, &problem));
    cJSON_Delete(bookmark);
    assert_false(room_was_used(own.room));
    fake_hello(&own, &first); /* while the plan is being loaded */
    assert_string_equal(heard(&first, "welcome", "member"), "m5");
    fake_plan_ready(&own, true);
    fake_hello(&own, &second);
    assert_string_equal(heard(&second, "welcome", "member"), "m6");
    fake_say(&own, &second, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1-m2\":null}}}");
    assert_string_equal(refused(&second), "403 /measures/m1-m2");
    fake_say(&own, &second, "{\"type\":\"scene.patch\",\"patch\":{\"probes\":{\"pin-1-m4\":{\"name\":\"x\"}}}}");
    assert_string_equal(refused(&second), "403 /probes/pin-1-m4");
    fake_say(&own, &first, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1-m2\":null}}}");
    assert_null(at(room_scene(own.room, NULL), "measures.m1-m2"));
    fake_room_end(&own);
    fake_page_end(&first);
    fake_page_end(&second);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_bookmark_without_scene_keeps_what_differs_from_the_plans_own),
        ROOM_TEST(the_scene_of_who_looks_alone_is_the_rooms_with_their_override),
        ROOM_TEST(a_token_is_given_once_and_stays),
        ROOM_TEST(a_bookmark_of_another_plan_or_form_is_refused),
        ROOM_TEST(a_room_begins_with_a_bookmark_and_says_what_of_it_is_lost),
        ROOM_TEST(marks_of_a_bookmark_from_another_room_are_nobodys_but_the_presenters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
