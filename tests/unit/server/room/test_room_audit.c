/* Audit of a room: its rows, acts gathered into one row, and refusals while nothing can be recorded. Ann enters first,
 * with the role of presenter. */
#include "server/auth/digest.h"
#include "tests/unit/room_set_up.h"

/* The newest row but `back`, as "action member result detail before after". */
static const char *row(size_t back)
{
    assert_true(back < fake.n_audited);
    return fake.audit[(fake.n_audited - 1 - back) % 16];
}

static void scene(struct fake_page *page, const char *patch)
{
    fake_say(&fake, page, "{\"type\":\"scene.patch\",\"patch\":%s}", patch);
}

static void who_enters_and_leaves_is_recorded(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    assert_int_equal(fake.n_audited, 2);
    assert_string_equal(fake.audit[0], "open m1 done {\"as\":\"new\"} -1 1");
    assert_string_equal(fake.audit[1], "control m1 done {\"act\":\"taken\",\"member\":\"m1\"} -1 -1");
    room_connection_closed(fake.room, &ann, fake.now_us);
    assert_string_equal(row(0), "leave m1 done {} -1 -1");
    char token[33];
    struct problem problem = { 0 };
    assert_true(room_link_create(fake.room, WIRE_MEMBER_ROLE_OBSERVER, 60, false, fake.now_us, token, &problem));
    fake_say(&fake, &ben, "{\"type\":\"hello\",\"protocol\":2,\"link\":\"%s\"}", token);
    assert_string_equal(row(0), "open m2 done {\"as\":\"link\"} -1 1");
    assert_true(strncmp(row(1), "link m2 done {\"link\":\"", 22) == 0);
    assert_non_null(strstr(row(1), "\"role\":\"observer\",\"one_use\":false}"));
    assert_null(strstr(row(1), token));
    fake_say(&fake, &cem, "{\"type\":\"hello\",\"protocol\":2,\"name\":\"Cem\",\"link\":\"0123\"}");
    assert_true(
        strncmp(row(0), "refused  refused {\"what\":\"hello\",\"name\":\"Cem\",\"why\":\"the link is not", 60) == 0);
}

static void a_gesture_is_one_row_with_the_revisions_around_it(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    const size_t before = fake.n_audited;
    for (int i = 0; i < 40; i++) {
        char patch[64];
        (void)snprintf(patch, sizeof patch, "{\"dose\":{\"blood_ppm\":%d}}", 20 + i);
        scene(&ann, patch);
        fake_pass(&fake, 30);
    }
    assert_int_equal(fake.n_audited, before);
    fake_pass(&fake, ROOM_AUDIT_QUIET_MS);
    assert_int_equal(fake.n_audited, before + 1);
    assert_true(strncmp(row(0), "weights m1 done {\"blood_ppm\":59,\"times\":40,\"since_ms\":", 54) == 0);
    assert_non_null(strstr(row(0), "} 1 41"));
    scene(&ann, "{\"dose\":{\"weights\":{\"brain\":{\"cbe\":1.3}}}}");
    fake_pass(&fake, ROOM_AUDIT_QUIET_MS);
    assert_non_null(strstr(row(0), "weights m1 done {\"weights\":{\"brain\":{"));
    assert_non_null(strstr(row(0), "\"cbe\":1.3"));
    assert_non_null(strstr(row(0), " 41 42"));
    scene(&ann, "{\"regions\":{\"brain\":{\"opacity\":0.5}}}"); /* what is only looked at is not */
    fake_pass(&fake, 2 * ROOM_AUDIT_AT_MOST_MS);
    assert_int_equal(fake.n_audited, before + 2);
}

static void a_gesture_without_end_is_a_row_from_time_to_time(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    const size_t before = fake.n_audited;
    for (int i = 0; i < 100; i++) { /* 70 s */
        char patch[64];
        (void)snprintf(patch, sizeof patch, "{\"dose\":{\"blood_ppm\":%d}}", 20 + i);
        scene(&ann, patch);
        fake_pass(&fake, 700);
    }
    assert_int_equal(fake.n_audited, before + 2);
    room_audit_flush(fake.room, fake.now_us);
    assert_int_equal(fake.n_audited, before + 3);
    assert_non_null(strstr(row(0), "\"blood_ppm\":119"));
    assert_non_null(strstr(row(0), " 101"));
}

static void drafts_are_made_changed_and_reset(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    const size_t before = fake.n_audited;
    scene(&ann, "{\"beam\":{\"draft\":{\"enabled\":true,\"line\":{\"target_mm\":[0,0,10]}}}}");
    assert_true(strncmp(row(0), "draft-made m1 done {", 20) == 0);
    assert_non_null(strstr(row(0), "\"target_mm\":[0,0,10]"));
    assert_non_null(strstr(row(0), " 1 2"));
    for (int i = 0; i < 10; i++) {
        char patch[96];
        (void)snprintf(patch, sizeof patch, "{\"beam\":{\"draft\":{\"line\":{\"target_mm\":[%d,0,10]}}}}", i + 1);
        scene(&ann, patch);
    }
    assert_int_equal(fake.n_audited, before + 1);
    scene(&ann, "{\"beam\":{\"draft\":{\"enabled\":false}}}"); /* first what came before */
    assert_int_equal(fake.n_audited, before + 3);
    assert_true(strncmp(row(1), "draft-changed m1 done {", 23) == 0);
    assert_non_null(strstr(row(1), "\"times\":10,\"since_ms\":"));
    assert_non_null(strstr(row(1), "} 2 12"));
    assert_string_equal(row(0), "draft-reset m1 done {} 12 13");
}

static void what_lacks_the_right_is_recorded_once_and_then_counted(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    const size_t before = fake.n_audited;
    for (int i = 0; i < 50; i++)
        scene(&ben, "{}");
    assert_int_equal(fake.n_audited, before + 1);
    assert_true(strncmp(row(0), "refused m2 refused {\"what\":\"scene.patch\",\"why\":\"", 48) == 0);
    fake_pass(&fake, ROOM_AUDIT_QUIET_MS);
    assert_int_equal(fake.n_audited, before + 2);
    assert_non_null(strstr(row(0), "\"times\":49,\"since_ms\":"));
    fake_say(&fake, &ben, "{\"type\":\"control.lock\",\"locked\":true}"); /* the role */
    assert_true(strncmp(row(0), "refused m2 refused {\"what\":\"control.lock\"", 40) == 0);
    fake_say(&fake, &ben, "{\"type\":\"view.close\",\"view\":9}"); /* wrong, not forbidden */
    assert_true(strncmp(row(0), "refused m2 refused {\"what\":\"control.lock\"", 40) == 0);
}

static void control_and_calls_are_recorded(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake_say(&fake, &ann, "{\"type\":\"control.give\",\"member\":\"m2\"}");
    assert_string_equal(row(0), "control m1 done {\"act\":\"given\",\"member\":\"m2\"} -1 -1");
    char caller[80];
    (void)snprintf(caller, sizeof caller, "m2 %s", heard(&ben, "welcome", "secret"));
    room_audit_call(fake.room, NULL, caller, "192.0.2.7", "export", NULL, false, fake.now_us);
    assert_string_equal(row(0), "export m2 done {} -1 1");
    room_audit_call(fake.room, NULL, "m2 00000000000000000000000000000000", "", "export", NULL, false, fake.now_us);
    assert_string_equal(row(0), "export  done {} -1 1");
}

/* Two links are made between two others within the second in which equal acts are gathered. */
static void acts_that_differ_are_rows_of_their_own(void **state)
{
    static const char *const roles[] = { "observer", "presenter", "observer", "observer" };
    (void)state;
    const size_t before = fake.n_audited;
    for (size_t i = 0; i < 4; i++) {
        cJSON *detail = cJSON_CreateObject();
        cJSON_AddStringToObject(detail, "role", roles[i]);
        room_audit_call(fake.room, NULL, NULL, i == 3 ? "192.0.2.8" : "192.0.2.7", "link-made", detail, false,
                        fake.now_us);
    }
    room_audit_flush(fake.room, fake.now_us);
    assert_int_equal(fake.n_audited, before + 4);
    assert_non_null(strstr(row(2), "{\"role\":\"presenter\"}"));
    assert_string_equal(fake.addresses[(before + 0) % 16], "192.0.2.7");
    fake_hello(&fake, &ann);
    const size_t at = fake.n_audited;
    scene(&ann, "{\"dose\":{\"blood_ppm\":30}}"); /* two fields, each in turn */
    scene(&ann, "{\"dose\":{\"factor\":2}}");
    scene(&ann, "{\"dose\":{\"blood_ppm\":31}}");
    room_audit_flush(fake.room, fake.now_us);
    assert_int_equal(fake.n_audited, at + 2);
    assert_non_null(strstr(row(1), "{\"blood_ppm\":31,\"times\":2"));
    assert_true(strncmp(row(0), "weights m1 done {\"factor\":2} ", 29) == 0);
}

/* The hash is that of the row as item_changed gave it. */
static void what_is_put_and_deleted_stands_there_with_its_hash(void **state)
{
    (void)state;
    char hex[DIGEST_TEXT];
    fake_hello(&fake, &ann);
    fake_say(&fake, &ann, "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"Edge?\"}}");
    assert_true(strncmp(row(0), "note m1 done {\"item\":\"i-", 24) == 0);
    digest_text(fake.kept[(fake.n_kept - 1) % 8], hex);
    assert_non_null(strstr(row(0), hex));
    fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"%s\"}", heard(&ann, "item", "id"));
    assert_non_null(strstr(row(0), "\"version\":1,\"deleted\":true} "));
}

static void a_long_detail_is_left_out_and_said(void **state)
{
    (void)state;
    char text[ROOM_MAX_AUDIT_DETAIL + 1];
    cJSON *detail = cJSON_CreateObject();
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = 0;
    cJSON_AddStringToObject(detail, "text", text);
    room_audit_call(fake.room, NULL, NULL, "", "export", detail, false, fake.now_us);
    /* 1024 and {"text":""}; hashlib.sha256(b'{"text":"' + b'x' * 1024 + b'"}').hexdigest() */
    assert_string_equal(row(0), "export  done {\"left_out_bytes\":1035,\"sha256\":"
                                "\"14383360d0a651d8fa415ec15f601ef6b818a0affdd5d8a9e602df732f53328a\"} -1 1");
}

static void without_place_nothing_that_is_recorded_happens(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake.audit_is_full = true;
    fake_hello(&fake, &cem);
    assert_true(cem.is_closed);
    assert_non_null(strstr(heard(&cem, "bye", "reason"), "takes no more records"));
    scene(&ann, "{\"dose\":{\"blood_ppm\":20}}");
    assert_string_equal(refused(&ann), "507 ");
    scene(&ann, "{\"beam\":{\"draft\":{\"enabled\":true,\"line\":{\"target_mm\":[0,0,10]}}}}");
    assert_int_equal(fake_n_heard(&ann, "problem"), 2);
    fake_say(&fake, &ann, "{\"type\":\"control.give\",\"member\":\"m2\"}");
    assert_int_equal(fake_n_heard(&ann, "problem"), 3);
    uint32_t revision;
    (void)room_scene(fake.room, &revision);
    assert_int_equal(revision, 1);
    scene(&ann, "{\"regions\":{\"brain\":{\"opacity\":0.5}}}"); /* people go on looking */
    (void)room_scene(fake.room, &revision);
    assert_int_equal(revision, 2);
    fake.audit_is_full = false;
    scene(&ann, "{\"dose\":{\"blood_ppm\":20}}");
    (void)room_scene(fake.room, &revision);
    assert_int_equal(revision, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(who_enters_and_leaves_is_recorded),
        ROOM_TEST(a_gesture_is_one_row_with_the_revisions_around_it),
        ROOM_TEST(a_gesture_without_end_is_a_row_from_time_to_time),
        ROOM_TEST(drafts_are_made_changed_and_reset),
        ROOM_TEST(what_lacks_the_right_is_recorded_once_and_then_counted),
        ROOM_TEST(control_and_calls_are_recorded),
        ROOM_TEST(acts_that_differ_are_rows_of_their_own),
        ROOM_TEST(what_is_put_and_deleted_stands_there_with_its_hash),
        ROOM_TEST(a_long_detail_is_left_out_and_said),
        ROOM_TEST(without_place_nothing_that_is_recorded_happens),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
