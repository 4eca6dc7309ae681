/* The scene that all of a room share, and what a plan that comes late or changes does to it. */
#include "tests/unit/room_set_up.h"

static void a_change_of_the_scene_reaches_all_and_raises_the_revision_by_one(void **state)
{
    uint32_t before, after;
    (void)state;
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, false);
    settle_two();
    (void)room_scene(fake.room, &before);
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"input\":3,\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.1}}}}");
    (void)room_scene(fake.room, &after);
    assert_int_equal(after, before + 1);
    assert_int_equal(fake.told_revision, after);
    cJSON *to_ben = fake_heard(&ben, "scene"), *to_ann = fake_heard(&ann, "scene");
    assert_int_equal(json_number(to_ben, "revision", 0), after);
    assert_int_equal(json_number(to_ben, "input", 0), 0);
    assert_int_equal(json_number(to_ann, "input", 0), 3);
    cJSON_Delete(to_ben);
    cJSON_Delete(to_ann);
    assert_int_equal(fake_outstanding(&fake), 2); /* both pictures */
}

static void a_bad_patch_is_refused_whole_and_only_its_sender_hears_it(void **state)
{
    uint32_t before, after;
    (void)state;
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, false);
    settle_two();
    size_t texts = ben.n_texts, requests = fake.n_requests;
    (void)room_scene(fake.room, &before);
    fake_say(
        &fake, &ann,
        "{\"type\":\"scene.patch\",\"input\":4,\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.9},\"liver\":{\"visible\":true}}}}");
    assert_string_equal(refused(&ann), "422 /regions/liver");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":2}}}}");
    assert_string_equal(refused(&ann), "422 /regions/scalp/opacity");
    fake_say(&fake, &ann, "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"size_px\":[8,8]}}");
    assert_string_equal(refused(&ann), "422 /size_px/0");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":[]}");
    fake_say(&fake, &ann, "not json");
    assert_string_equal(refused(&ann), "400 ");
    const cJSON *scene = room_scene(fake.room, &after);
    assert_int_equal(after, before);
    assert_close(json_number(cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "regions"), "scalp"), "opacity", 0), 0.4,
                 1e-12);
    fake_pass(&fake, 1000);
    assert_int_equal(ben.n_texts, texts);
    assert_int_equal(fake.n_requests, requests);
    struct room_counters counters = { 0 };
    room_count(fake.room, &counters);
    assert_int_equal(counters.messages_refused, 5);
}

/* The author of a mark of the room's scene; "none" where there is no such mark. */
static const char *author_of(const char *kind, const char *id)
{
    uint32_t revision;
    const cJSON *scene = room_scene(fake.room, &revision);
    const cJSON *mark = cJSON_GetObjectItem(cJSON_GetObjectItem(scene, kind), id);
    return mark ? json_text(mark, "author") : "none";
}

static void who_follows_adds_marks_under_ids_and_a_name_of_their_own(void **state)
{
    static const char measure[] = "{\"kind\":\"distance\",\"author\":\"Somebody\",\"points\":[{\"at_mm\":[0,0,0]},"
                                  "{\"at_mm\":[1,0,0]}]}";
    (void)state;
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, true);
    settle_two();
    fake_say(&fake, &ben, "{\"type\":\"scene.patch\",\"input\":7,\"patch\":{\"measures\":{\"m1-m2\":%s}}}", measure);
    assert_string_equal(author_of("measures", "m1-m2"), "Reviewer 2"); /* not as the page has it */
    fake_say(&fake, &ben, "{\"type\":\"scene.patch\",\"patch\":{\"probes\":{\"pin-1-m2\":{\"at_mm\":[1,2,3]}}}}");
    assert_string_equal(author_of("probes", "pin-1-m2"), "Reviewer 2");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m2\":{}}}}");
    assert_string_equal(author_of("measures", "m2"), "Reviewer 1");
    cJSON *told = fake_heard(&ben, "scene");
    assert_string_equal(json_text(cJSON_GetObjectItem(cJSON_GetObjectItem(cJSON_GetObjectItem(told, "patch"),
                                                                          "measures"),
                                                      "m2"),
                                  "author"),
                        "Reviewer 1");
    cJSON_Delete(told);

    /* the presenter changes all of them, and the author stays; a mark that comes back keeps its author */
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1-m2\":{\"name\":\"Margin\"}}}}");
    assert_string_equal(author_of("measures", "m1-m2"), "Reviewer 2");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1-m2\":null}}}");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1-m2\":%s}}}", measure);
    assert_string_equal(author_of("measures", "m1-m2"), "Somebody");
    fake_say(&fake, &ben, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1-m2\":null}}}");
    assert_string_equal(author_of("measures", "m1-m2"), "none");
    /* so does one that nobody had signed, as when a saved view is shown */
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"patch\":{\"probes\":{\"old\":{\"author\":\"\",\"at_mm\":[1,2,3]}}}}");
    assert_string_equal(author_of("probes", "old"), "");
}

/* Such marks come with a picture from another room that the presenter shows. */
static void nobody_who_comes_gets_the_number_that_a_mark_ends_with(void **state)
{
    (void)state;
    fake_join(&fake, &ann, false);
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"probes\":{\"pin-1-m2\":{\"at_mm\":[1,2,3]}}}}");
    fake_join(&fake, &ben, true);
    assert_string_equal(heard(&ben, "welcome", "member"), "m3");
    fake_say(&fake, &ben, "{\"type\":\"scene.patch\",\"patch\":{\"probes\":{\"pin-1-m2\":null}}}");
    assert_string_equal(refused(&ben), "403 /probes/pin-1-m2");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"probes\":{\"pin-1-m2\":null}}}");
    fake_join(&fake, &cem, true);
    assert_string_equal(heard(&cem, "welcome", "member"), "m4"); /* numbers are never given twice */
}

static void who_follows_changes_nothing_but_their_own_marks(void **state)
{
    static const char *const bad[][2] = {
        { "{\"measures\":{\"m1\":{}}}", "403 /measures/m1" },
        { "{\"measures\":{\"m1\":null}}", "403 /measures/m1" },
        { "{\"measures\":{\"m1-m2\":{},\"m1-m1\":{}}}", "403 /measures/m1-m1" },
        { "{\"measures\":{\"-m2\":{}}}", "403 /measures/-m2" },
        { "{\"measures\":{\"xm2\":{}}}", "403 /measures/xm2" },
        { "{\"measures\":{\"m1-m22\":{}}}", "403 /measures/m1-m22" },
        { "{\"measures\":{\"m1-m2\":{}},\"axes\":{\"visible\":true}}", "403 " },
        { "{\"measures\":null}", "403 " },
        { "{\"probes\":[]}", "403 " },
        { "{}", "403 " },
        { "{\"constraints\":{\"limit-1-m2\":{\"metric\":\"D95%\",\"limit\":-1}}}",
          "422 /constraints/limit-1-m2/limit" },
        { "{\"constraints\":{\"limit-1-m2\":5}}", "422 /constraints/limit-1-m2" },
    };
    uint32_t before, after;
    (void)state;
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, true);
    settle_two();
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"measures\":{\"m1\":{}}}}");
    (void)room_scene(fake.room, &before);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        fake_say(&fake, &ben, "{\"type\":\"scene.patch\",\"patch\":%s}", bad[i][0]);
        assert_string_equal(refused(&ben), bad[i][1]);
    }
    (void)room_scene(fake.room, &after);
    assert_int_equal(after, before);
}

static void a_message_over_64_kib_is_refused(void **state)
{
    static char text[WIRE_MAX_CLIENT_BYTES + 2];
    (void)state;
    fake_hello(&fake, &ann);
    memset(text, ' ', sizeof text);
    memcpy(text, "{\"type\":\"ping\",\"time_ms\":1}", 27);
    room_text_came(fake.room, &ann, text, WIRE_MAX_CLIENT_BYTES, fake.now_us);
    assert_int_equal(fake_n_heard(&ann, "pong"), 1);
    room_text_came(fake.room, &ann, text, WIRE_MAX_CLIENT_BYTES + 1, fake.now_us);
    assert_string_equal(refused(&ann), "413 ");
}

static void before_the_plan_is_loaded_views_wait_and_the_scene_cannot_change(void **state)
{
    struct fake_room early;
    (void)state;
    fake_room_start(&early, 3);
    struct fake_page page = { 0 };
    fake_join(&early, &page, false);
    room_renderer_state(early.room, WIRE_RENDERER_STATE_LOADING, "reading the image", 40, NULL, early.now_us);
    assert_string_equal(heard(&page, "renderer", "phase"), "reading the image");
    fake_say(&early, &page, "{\"type\":\"scene.patch\",\"patch\":{}}");
    assert_string_equal(refused(&page), "503 ");
    fake_pass(&early, 5000);
    assert_int_equal(early.n_requests, 0);
    fake_plan_ready(&early, true);
    assert_int_equal(fake_n_heard(&page, "plan"), 1);
    assert_int_equal(early.n_requests, 1);
    fake_room_end(&early);
    fake_page_end(&page);
}

/* True if the newest view document sent to the page has no override. */
static bool override_is_gone(const struct fake_page *page)
{
    cJSON *said = fake_heard(page, "view");
    const cJSON *override = cJSON_GetObjectItem(cJSON_GetObjectItem(said, "document"), "override");
    bool is_gone = said && (!override || cJSON_IsNull(override) || !override->child);
    cJSON_Delete(said);
    return is_gone;
}

static void an_override_said_too_early_is_taken_out_and_told_when_the_plan_has_no_such_region(void **state)
{
    struct fake_room early;
    (void)state;
    fake_room_start(&early, 3);
    struct fake_page page = { 0 };
    fake_hello(&early, &page);
    fake_say(
        &early, &page,
        "{\"type\":\"view.open\",\"view\":1,\"document\":{\"override\":{\"regions\":{\"liver\":{\"visible\":false}}}}}");
    fake_say(
        &early, &page,
        "{\"type\":\"view.open\",\"view\":2,\"document\":{\"override\":{\"regions\":{\"brain\":{\"visible\":false}}}}}");
    assert_int_equal(fake_n_heard(&page, "problem"), 0);
    fake_plan_ready(&early, true);
    assert_string_equal(refused(&page), "422 /override/regions/liver");
    assert_int_equal(fake_n_heard(&page, "problem"), 1);
    assert_true(override_is_gone(&page));
    /* view 1 shows the room's scene and can be moved, view 2 keeps its own */
    assert_int_equal(early.n_requests, 2);
    assert_true((early.requests[0].scene == NULL) != (early.requests[1].scene == NULL));
    fake_draw(&early, &early.requests[0]);
    fake_draw(&early, &early.requests[1]);
    fake_turn(&early, &page, 3, 7);
    assert_int_equal(fake_n_heard(&page, "problem"), 1);
    assert_null(fake_newest(&early)->scene);
    fake_room_end(&early);
    fake_page_end(&page);
}

static void after_a_restart_with_another_plan_nothing_names_what_is_gone(void **state)
{
    uint32_t before, after;
    (void)state;
    fake_join(&fake, &ann, false);
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"override\":{\"regions\":{\"scalp\":{\"visible\":false}}}}}");
    fake_say(
        &fake, &ann,
        "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"opacity\":0.3}},\"check\":{\"region\":\"scalp\"}}}");
    settle_one();
    room_renderer_state(fake.room, WIRE_RENDERER_STATE_RESTARTING, NULL, 0, NULL, fake.now_us);
    /* during a restart patches are checked against the old plan */
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"check\":{\"region\":\"liver\"}}}");
    assert_string_equal(refused(&ann), "422 /check/region");
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.7}}}}");
    (void)room_scene(fake.room, &before);
    fake_other_plan_ready(&fake);
    const cJSON *scene = room_scene(fake.room, &after), *regions = cJSON_GetObjectItem(scene, "regions");
    assert_int_equal(after, before + 1); /* the scene differs, so its ETag must */
    assert_null(cJSON_GetObjectItem(regions, "scalp"));
    assert_close(json_number(cJSON_GetObjectItem(regions, "brain"), "opacity", 0), 0.3, 1e-12);
    assert_string_equal(json_text(cJSON_GetObjectItem(scene, "check"), "region"), "");
    assert_string_equal(refused(&ann), "422 /override/regions/scalp");
    assert_true(override_is_gone(&ann));
    assert_null(fake_newest(&fake)->scene); /* drawn with the room's scene */
}

static void a_plan_that_cannot_be_loaded_says_why(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    fake_hello(&fake, &ann);
    problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "", "labels.nii.gz ends after 12 of 8388608 bytes");
    room_renderer_state(fake.room, WIRE_RENDERER_STATE_FAILED, NULL, 0, &problem, fake.now_us);
    cJSON *said = fake_heard(&ann, "renderer");
    assert_string_equal(json_text(said, "state"), "failed");
    assert_string_equal(json_text(cJSON_GetObjectItem(said, "problem"), "detail"), problem.detail);
    cJSON_Delete(said);
    fake_hello(&fake, &ben); /* also sent to a later member */
    assert_string_equal(heard(&ben, "renderer", "state"), "failed");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_change_of_the_scene_reaches_all_and_raises_the_revision_by_one),
        ROOM_TEST(a_bad_patch_is_refused_whole_and_only_its_sender_hears_it),
        ROOM_TEST(who_follows_adds_marks_under_ids_and_a_name_of_their_own),
        ROOM_TEST(nobody_who_comes_gets_the_number_that_a_mark_ends_with),
        ROOM_TEST(who_follows_changes_nothing_but_their_own_marks),
        ROOM_TEST(a_message_over_64_kib_is_refused),
        ROOM_TEST(before_the_plan_is_loaded_views_wait_and_the_scene_cannot_change),
        ROOM_TEST(an_override_said_too_early_is_taken_out_and_told_when_the_plan_has_no_such_region),
        ROOM_TEST(after_a_restart_with_another_plan_nothing_names_what_is_gone),
        ROOM_TEST(a_plan_that_cannot_be_loaded_says_why),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
