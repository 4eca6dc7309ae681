/* Notes, decisions and signatures of people who have signed in, of guests, and of the machine's person. */
#include "core/base/clock.h"
#include "server/room/log/recorded_parts.h"
#include "server/room/state/room_state.h"
#include "server/wire/message.h"
#include "tests/unit/room_set_up.h"

static struct identity pat, rae, oli, gus, script;

static bool role_of(const struct identity *who, enum wire_member_role *role)
{
    *role = strcmp(who->user, "pat") == 0   ? WIRE_MEMBER_ROLE_PLANNER
            : strcmp(who->user, "rae") == 0 ? WIRE_MEMBER_ROLE_REVIEWER
                                            : WIRE_MEMBER_ROLE_OBSERVER;
    return true;
}

static struct identity person(const char *user, const char *name)
{
    struct identity who = { .source = IDENTITY_PASSWORD, .proved_ms = clock_wall_ms() - 1000 };
    (void)snprintf(who.user, sizeof who.user, "%s", user);
    (void)snprintf(who.name, sizeof who.name, "%s", name);
    return who;
}

static void hello(struct fake_page *page, const struct identity *who, const char *more)
{
    page->identity = who;
    fake_say(&fake, page, "{\"type\":\"hello\",\"protocol\":2%s}", more);
    assert_int_equal(fake_n_heard(page, "welcome"), 1);
}

/* Pat the planner, Rae the reviewer, and Gus, a guest who may write notes, are in a room that is open. */
static int start(void **state)
{
    struct problem problem = { 0 };
    char token[33], more[100];
    const struct room_link wanted = {
        .role = WIRE_MEMBER_ROLE_REVIEWER, .expires_s = 3600, .allows_guests = true, .maker = "pat", .name = ""
    };
    (void)state;
    pat = person("pat", "Pat Lee");
    rae = person("rae", "Rae");
    oli = person("oli", "Oli");
    script = person("rae", "Rae");
    script.source = IDENTITY_TOKEN;
    gus = (struct identity){ .source = IDENTITY_NOBODY };
    fake_room_start_with(&fake, &(struct room_limits){ .max_members = 8, .admits_guests = true });
    fake_sign_in(&fake, role_of);
    room_set_owner(fake.room, "pat");
    cJSON *patch = json_read("{\"is_open\":true}", 16, NULL);
    assert_true(room_people_patch(fake.room, patch, &pat, NULL, "", fake.now_us, &problem));
    cJSON_Delete(patch);
    fake_plan_ready(&fake, true);
    room_plan_revision(fake.room, "6a09e667bb67ae853c6ef372a54ff53a510e527f9b05688c1f83d9ab5be0cd19");
    assert_true(room_link_make(fake.room, &wanted, fake.now_us, token, &problem));
    hello(&ann, &pat, "");
    hello(&ben, &rae, "");
    (void)snprintf(more, sizeof more, ",\"link\":\"%s\",\"name\":\"Gus\"", token);
    hello(&cem, &gus, more);
    return 0;
}
#define SIGNING_TEST(name) cmocka_unit_test_setup_teardown(name, start, room_end)

static void put(struct fake_page *page, const char *kind, const char *body)
{
    fake_say(&fake, page, "{\"type\":\"item.put\",\"kind\":\"%s\",\"body\":%s}", kind, body);
}

/* The newest item that this page was told of, to be deleted. */
static cJSON *newest(const struct fake_page *page)
{
    cJSON *message = fake_heard(page, "item");
    assert_non_null(message);
    cJSON *item = cJSON_DetachItemFromObjectCaseSensitive(message, "item");
    cJSON_Delete(message);
    return item;
}

/* The code of the newest problem, "" for none. */
static const char *code(const struct fake_page *page)
{
    static char text[40];
    cJSON *message = fake_heard(page, "problem");
    const char *found = json_text(cJSON_GetObjectItem(message, "problem"), "code");
    (void)snprintf(text, sizeof text, "%s", found ? found : "");
    cJSON_Delete(message);
    return text;
}

static size_t n_of(enum wire_item_kind kind)
{
    cJSON *rows = room_items(fake.room, kind);
    const size_t n = (size_t)cJSON_GetArraySize(rows);
    cJSON_Delete(rows);
    return n;
}

static const char signature[] = "{\"name\":\"The Pope\",\"meaning\":\"approved\"}";

/* ---- signatures ------------------------------------------------------------------------------------------------- */

static void a_signature_is_of_the_person_signed_in_whatever_name_is_given(void **state)
{
    (void)state;
    put(&ben, "signature", signature);
    cJSON *item = newest(&ann), *body = cJSON_GetObjectItem(item, "body");
    assert_string_equal(json_text(body, "name"), "Rae");
    assert_string_equal(json_text(body, "user"), "rae");
    assert_true(json_flag(body, "signed_in", false));
    assert_true((int64_t)json_number(body, "proved_ms", 0) == rae.proved_ms);
    assert_string_equal(json_text(item, "author_user"), "rae");
    cJSON_Delete(item);
    put(&ann, "signature", "{\"meaning\":\"seen\"}"); /* needs none */
    item = newest(&ben);
    assert_string_equal(json_text(cJSON_GetObjectItem(item, "body"), "name"), "Pat Lee");
    cJSON_Delete(item);
}

static void who_proved_too_long_ago_confirms_first(void **state)
{
    const int64_t limit_ms = 5 * 60 * 1000;
    (void)state;
    rae.proved_ms = clock_wall_ms() - limit_ms - 1;
    put(&ben, "signature", signature);
    assert_string_equal(code(&ben), "confirm");
    rae.proved_ms = clock_wall_ms() + limit_ms + 60000; /* a clock that was set back proves nothing */
    put(&ben, "signature", signature);
    assert_int_equal(fake_n_heard(&ben, "problem"), 2);
    rae.proved_ms = clock_wall_ms() - limit_ms + 20000;
    put(&ben, "signature", signature);
    assert_int_equal(fake_n_heard(&ben, "problem"), 2);
    assert_int_equal(n_of(WIRE_ITEM_KIND_SIGNATURE), 1);
}

static void a_proxy_that_does_not_tell_the_time_signs_never(void **state)
{
    (void)state;
    rae.source = IDENTITY_PROXY;
    rae.proved_ms = 0;
    put(&ben, "signature", signature);
    assert_string_equal(code(&ben), "unproved");
    assert_int_equal(n_of(WIRE_ITEM_KIND_SIGNATURE), 0);
}

static void a_guest_neither_decides_nor_signs_nor_ticks_the_checklist(void **state)
{
    static const char check[] = "{\"entry\":\"beam\",\"text\":\"Who it is\",\"state\":\"ok\"}";
    (void)state;
    put(&cem, "check", check);
    assert_string_equal(code(&cem), "role");
    assert_int_equal(n_of(WIRE_ITEM_KIND_CHECK), 0);
    put(&ben, "check", check);
    assert_int_equal(n_of(WIRE_ITEM_KIND_CHECK), 1);
    cJSON *item = newest(&ben);
    fake_say(&fake, &cem, "{\"type\":\"item.delete\",\"item\":\"%s\",\"version\":1}", json_text(item, "id"));
    fake_say(&fake, &cem, "{\"type\":\"item.put\",\"kind\":\"check\",\"item\":\"%s\",\"version\":1,\"body\":%s}",
             json_text(item, "id"), check);
    cJSON_Delete(item);
    assert_int_equal(fake_n_heard(&cem, "problem"), 3);
    assert_int_equal(n_of(WIRE_ITEM_KIND_CHECK), 1);
    put(&cem, "signature", signature);
    assert_string_equal(code(&cem), "role");
    put(&cem, "decision", "{\"decision\":\"accept\"}");
    assert_int_equal(fake_n_heard(&cem, "problem"), 5);
    assert_int_equal(n_of(WIRE_ITEM_KIND_SIGNATURE) + n_of(WIRE_ITEM_KIND_DECISION), 0);
}

static void a_reviewer_decides_and_an_observer_does_not(void **state)
{
    (void)state;
    put(&ben, "decision", "{\"decision\":\"accept\"}");
    assert_int_equal(fake_n_heard(&ben, "problem"), 0);
    hello(&dee, &oli, "");
    put(&dee, "decision", "{\"decision\":\"reject\"}");
    assert_string_equal(code(&dee), "role");
    assert_int_equal(n_of(WIRE_ITEM_KIND_DECISION), 1);
}

static void without_sign_in_a_signature_says_so(void **state)
{
    (void)state;
    fake_page_end(&dee);
    fake_hello(&fake, &dee); /* the machine's person */
    put(&dee, "signature", signature);
    cJSON *item = newest(&dee), *body = cJSON_GetObjectItem(item, "body");
    assert_string_equal(json_text(body, "name"), "The Pope");
    assert_false(json_flag(body, "signed_in", true));
    assert_null(json_text(body, "user"));
    assert_null(json_text(item, "author_user"));
    cJSON_Delete(item);
    fake.room->is_open_to_everybody = true;
    put(&dee, "signature", signature);
    assert_string_equal(code(&dee), "open");
}

struct outcome {
    bool is_done;
    struct problem problem;
};

static void done(void *context, const char *row, bool was_sent_before, const struct problem *problem)
{
    struct outcome *outcome = context;
    (void)row;
    (void)was_sent_before;
    outcome->is_done = !problem;
    outcome->problem = problem ? *problem : (struct problem){ 0 };
}

static struct outcome call(const struct identity *who, const char *member, const char *text)
{
    struct outcome outcome = { 0 };
    struct message message;
    struct problem problem = { 0 };
    assert_true(message_read(text, strlen(text), true, &message, &problem));
    const struct room_act act = {
        .member = member, .identity = who, .address = "", .message = &message, .done = done, .context = &outcome
    };
    room_act(fake.room, &act, fake.now_us);
    message_finish(&message);
    return outcome;
}

static void a_script_writes_under_its_users_name_and_signs_nothing(void **state)
{
    char seat[100];
    (void)state;
    script.scopes = IDENTITY_SCOPE_READ;
    assert_false(call(&script, NULL, "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"x\"}}").is_done);
    hello(&dee, &script, "");
    put(&dee, "note", "{\"text\":\"x\"}");
    assert_string_equal(code(&dee), "role");
    assert_int_equal(n_of(WIRE_ITEM_KIND_NOTE), 0);
    script.scopes = IDENTITY_SCOPE_READ | IDENTITY_SCOPE_PLAN;
    assert_true(call(&script, NULL, "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"x\"}}").is_done);
    cJSON *item = newest(&ann);
    assert_string_equal(json_text(item, "author_name"), "Rae");
    assert_string_equal(json_text(item, "author_user"), "rae");
    cJSON_Delete(item);
    (void)snprintf(seat, sizeof seat, "m2 %s", heard(&ben, "welcome", "secret"));
    const struct outcome signs =
        call(&script, seat, "{\"type\":\"item.put\",\"kind\":\"signature\",\"body\":{\"meaning\":\"seen\"}}");
    assert_false(signs.is_done);
    assert_string_equal(signs.problem.code, "unproved");
    assert_true(
        call(&rae, seat, "{\"type\":\"item.put\",\"kind\":\"signature\",\"body\":{\"meaning\":\"seen\"}}").is_done);
}

/* ---- notes ------------------------------------------------------------------------------------------------------ */

/* The id of the note that this page has just written. */
static const char *note_of(struct fake_page *page)
{
    static char id[16];
    put(page, "note", "{\"text\":\"look at the stem\"}");
    cJSON *item = newest(page);
    (void)snprintf(id, sizeof id, "%s", json_text(item, "id"));
    cJSON_Delete(item);
    return id;
}

static void a_note_is_changed_by_its_writer_alone(void **state)
{
    char id[16];
    (void)state;
    (void)snprintf(id, sizeof id, "%s", note_of(&ben));
    fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id); /* a planner */
    assert_string_equal(refused(&ann), "403 /item");
    hello(&dee, &rae, ""); /* another seat of the same person */
    fake_say(&fake, &dee,
             "{\"type\":\"item.put\",\"kind\":\"note\",\"item\":\"%s\",\"version\":1,\"body\":{\"text\":\"y\"}}", id);
    assert_int_equal(fake_n_heard(&dee, "problem"), 0);
    fake_say(&fake, &dee, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id);
    assert_int_equal(n_of(WIRE_ITEM_KIND_NOTE), 0);
}

static void a_guests_note_is_marked_and_its_own(void **state)
{
    char id[16];
    (void)state;
    (void)snprintf(id, sizeof id, "%s", note_of(&cem));
    cJSON *item = newest(&ann);
    assert_true(json_flag(item, "is_guest", false));
    assert_null(json_text(item, "author_user"));
    cJSON_Delete(item);
    fake_say(&fake, &ben, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id);
    assert_string_equal(refused(&ben), "403 /item");
    fake_say(&fake, &cem, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id);
    assert_int_equal(n_of(WIRE_ITEM_KIND_NOTE), 0);
}

static void a_planner_hides_a_note_and_its_text_stays(void **state)
{
    char id[16];
    (void)state;
    (void)snprintf(id, sizeof id, "%s", note_of(&ben));
    fake_say(&fake, &ben, "{\"type\":\"item.hide\",\"item\":\"%s\"}", id);
    assert_string_equal(code(&ben), "role");
    fake_say(&fake, &ann, "{\"type\":\"item.hide\",\"item\":\"%s\",\"input\":7}", id);
    cJSON *item = newest(&ben);
    assert_string_equal(json_text(item, "hidden_by"), "Pat Lee");
    assert_string_equal(json_text(item, "changed_name"), "Rae");
    assert_string_equal(json_text(cJSON_GetObjectItem(item, "body"), "text"), "look at the stem");
    assert_int_equal(json_number(item, "version", 0), 2);
    cJSON_Delete(item);
    assert_non_null(strstr(fake.audit[(fake.n_audited - 1) % 16], "\"hidden\":true"));
    cJSON *record = room_record(fake.room);
    const cJSON *row = cJSON_GetArrayItem(cJSON_GetObjectItem(record, "notes"), 0);
    assert_string_equal(json_text(row, "text"), "look at the stem");
    assert_string_equal(json_text(row, "hidden_by"), "Pat Lee");
    cJSON_Delete(record);
    fake_say(&fake, &ann, "{\"type\":\"item.hide\",\"item\":\"%s\",\"hidden\":false}", id);
    item = newest(&ben);
    assert_null(json_text(item, "hidden_by"));
    cJSON_Delete(item);
    put(&ann, "signature", "{\"meaning\":\"seen\"}");
    item = newest(&ann);
    fake_say(&fake, &ann, "{\"type\":\"item.hide\",\"item\":\"%s\"}", json_text(item, "id"));
    assert_string_equal(refused(&ann), "404 /item");
    cJSON_Delete(item);
}

static void a_recording_tells_users_and_guests(void **state)
{
    (void)state;
    cJSON *members = recorded_members(fake.room);
    const cJSON *rae_is = cJSON_GetObjectItem(members, "m2"), *gus_is = cJSON_GetObjectItem(members, "m3");
    assert_string_equal(json_text(rae_is, "user"), "rae");
    assert_null(cJSON_GetObjectItem(rae_is, "is_guest"));
    assert_true(json_flag(gus_is, "is_guest", false));
    assert_null(json_text(gus_is, "user"));
    cJSON_Delete(members);
    cJSON *record = room_record(fake.room);
    const cJSON *present = cJSON_GetObjectItem(record, "present");
    assert_string_equal(json_text(cJSON_GetArrayItem(present, 1), "user"), "rae");
    assert_true(json_flag(cJSON_GetArrayItem(present, 2), "is_guest", false));
    cJSON_Delete(record);
}

/* ---- on disk ---------------------------------------------------------------------------------------------------- */

static void rows_come_back_as_they_were_kept(void **state)
{
    static const enum wire_item_kind kinds[] = { WIRE_ITEM_KIND_NOTE, WIRE_ITEM_KIND_SIGNATURE };
    char *rows[2], id[16];
    struct problem problem = { 0 };
    (void)state;
    (void)snprintf(id, sizeof id, "%s", note_of(&cem));
    fake_say(&fake, &ann, "{\"type\":\"item.hide\",\"item\":\"%s\"}", id);
    put(&ben, "signature", signature);
    for (int i = 0; i < 2; i++) {
        cJSON *list = room_items(fake.room, kinds[i]);
        rows[i] = json_write(cJSON_GetArrayItem(list, 0));
        cJSON_Delete(list);
    }
    (void)room_end(NULL);
    (void)start(NULL);
    for (int i = 0; i < 2; i++) {
        assert_true(room_restore_item(fake.room, rows[i], strlen(rows[i]), &problem));
        cJSON *list = room_items(fake.room, kinds[i]);
        char *again = json_write(cJSON_GetArrayItem(list, 0));
        assert_string_equal(again, rows[i]); /* to the byte: the audit has its hash */
        free(again);
        free(rows[i]);
        cJSON_Delete(list);
    }
}

static void a_signature_from_before_there_was_sign_in_stays_as_it_is(void **state)
{
    static const char kept[] =
        "{\"id\":\"i-0000000001\",\"kind\":\"signature\",\"version\":1,\"author\":\"m1\",\"author_name\":\"Ann\","
        "\"author_color\":\"#56b4e9\",\"changed_name\":\"Ann\",\"created_ms\":1,\"changed_ms\":1,\"body\":{\"name\":\"A. "
        "Example\",\"meaning\":\"seen\",\"corrects\":\"\",\"plan_revision\":\"\",\"role\":\"presenter\"}}";
    struct problem problem = { 0 };
    (void)state;
    assert_true(room_restore_item(fake.room, kept, sizeof kept - 1, &problem));
    cJSON *list = room_items(fake.room, WIRE_ITEM_KIND_SIGNATURE);
    char *again = json_write(cJSON_GetArrayItem(list, 0));
    assert_string_equal(again, kept);
    free(again);
    cJSON_Delete(list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SIGNING_TEST(a_signature_is_of_the_person_signed_in_whatever_name_is_given),
        SIGNING_TEST(who_proved_too_long_ago_confirms_first),
        SIGNING_TEST(a_proxy_that_does_not_tell_the_time_signs_never),
        SIGNING_TEST(a_guest_neither_decides_nor_signs_nor_ticks_the_checklist),
        SIGNING_TEST(a_reviewer_decides_and_an_observer_does_not),
        SIGNING_TEST(without_sign_in_a_signature_says_so),
        SIGNING_TEST(a_script_writes_under_its_users_name_and_signs_nothing),
        SIGNING_TEST(a_note_is_changed_by_its_writer_alone),
        SIGNING_TEST(a_guests_note_is_marked_and_its_own),
        SIGNING_TEST(a_planner_hides_a_note_and_its_text_stays),
        SIGNING_TEST(a_recording_tells_users_and_guests),
        SIGNING_TEST(rows_come_back_as_they_were_kept),
        SIGNING_TEST(a_signature_from_before_there_was_sign_in_stays_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
