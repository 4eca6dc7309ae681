/* Notes, replies and bookmarks of a room: who may write them, their versions, limits, and what is kept of them. */
#include "tests/unit/room_set_up.h"

#include "core/base/mem.h"
#include "server/room/items/note_body.h"
#include "server/wire/message.h"

/* Ann presents, Ben and Cem do not; all have said hello. */
static void enter(void)
{
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, false);
    fake_join(&fake, &cem, false);
}

static void put(struct fake_page *page, const char *id, int version, const char *body, unsigned input)
{
    fake_say(&fake, page,
             "{\"type\":\"item.put\",\"item\":\"%s\",\"version\":%d,\"kind\":\"note\",\"body\":%s,\"input\":%u}", id,
             version, body, input);
}

/* The id of the item that this page heard of last. Good until the next call. */
static const char *last_id(const struct fake_page *page)
{
    static char id[64];
    (void)snprintf(id, sizeof id, "%s", heard(page, "item", "id"));
    return id;
}

/* A field of the row in the newest message item; NULL: it was deleted. To be deleted by the caller. */
static cJSON *last_row(const struct fake_page *page)
{
    cJSON *said = fake_heard(page, "item");
    cJSON *row = cJSON_DetachItemFromObjectCaseSensitive(said, "item");
    cJSON_Delete(said);
    return row;
}

static size_t n_notes(void)
{
    cJSON *rows = room_items(fake.room, WIRE_ITEM_KIND_NOTE);
    size_t n = (size_t)cJSON_GetArraySize(rows);
    cJSON_Delete(rows);
    return n;
}

static const char edge[] = "{\"text\":\"The edge?\",\"anchor\":{\"point_mm\":[1,-2,3.5],\"region\":\"brain\"}}";

static void a_note_reaches_all_with_its_author_and_only_its_sender_gets_the_input(void **state)
{
    (void)state;
    enter();
    put(&ben, "", 0, edge, 9);
    cJSON *to_ben = fake_heard(&ben, "item"), *to_ann = fake_heard(&ann, "item");
    assert_int_equal(json_number(to_ben, "input", 0), 9);
    assert_int_equal(json_number(to_ann, "input", 7), 0);
    assert_string_equal(json_text(to_ann, "by"), "m2");
    const cJSON *row = cJSON_GetObjectItem(to_ann, "item"), *body = cJSON_GetObjectItem(row, "body");
    assert_string_equal(json_text(row, "id"), json_text(to_ann, "id"));
    assert_string_equal(json_text(row, "kind"), "note");
    assert_string_equal(json_text(row, "author"), "m2");
    assert_int_equal(json_number(row, "version", 0), 1);
    assert_int_equal(strlen(json_text(row, "author_color")), 7);
    assert_true(json_number(row, "created_ms", 0) > 1.7e12); /* after 2023 */
    assert_string_equal(json_text(body, "text"), "The edge?");
    assert_false(json_flag(body, "resolved", true));
    assert_string_equal(json_text(body, "parent"), "");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(body, "mentions")), 0);
    cJSON_Delete(to_ben);
    cJSON_Delete(to_ann);
    /* who comes later is sent it too */
    fake_pass(&fake, 10);
    struct fake_page late = { 0 };
    room_connection_closed(fake.room, &cem, fake.now_us);
    fake_hello(&fake, &late);
    cJSON *welcome = fake_heard(&late, "welcome");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(welcome, "items")), 1);
    cJSON_Delete(welcome);
    room_connection_closed(fake.room, &late, fake.now_us);
    fake_page_end(&late);
}

static void only_its_author_and_who_has_the_role_of_presenter_change_a_note(void **state)
{
    (void)state;
    enter();
    put(&ben, "", 0, edge, 1);
    const char *id = last_id(&ann);
    put(&cem, id, 1, "{\"text\":\"mine\"}", 2);
    assert_string_equal(refused(&cem), "403 /item");
    fake_say(&fake, &cem, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id);
    assert_string_equal(refused(&cem), "403 /item");
    put(&ben, id, 1, "{\"text\":\"The rim?\"}", 3);
    put(&ann, id, 2, "{\"text\":\"The rim.\",\"resolved\":true}", 4);
    cJSON *row = last_row(&cem);
    assert_int_equal(json_number(row, "version", 0), 3);
    assert_string_equal(json_text(row, "author"), "m2");
    assert_string_equal(json_text(row, "author_name"), "Reviewer 2");
    assert_string_equal(json_text(row, "changed_name"), "Reviewer 1");
    assert_true(json_flag(cJSON_GetObjectItem(row, "body"), "resolved", false));
    cJSON_Delete(row);
    fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"%s\",\"version\":3}", id);
    assert_int_equal(n_notes(), 0);
    put(&ben, id, 3, edge, 5);
    assert_string_equal(refused(&ben), "404 /item");
}

static void a_change_of_an_older_version_is_refused_and_nothing_is_lost(void **state)
{
    (void)state;
    enter();
    put(&ben, "", 0, edge, 1);
    const char *id = last_id(&ann);
    put(&ann, id, 1, "{\"text\":\"from Ann\"}", 2);
    put(&ben, id, 1, "{\"text\":\"from Ben\"}", 3);
    assert_string_equal(refused(&ben), "409 /version");
    cJSON *problem = fake_heard(&ben, "problem");
    assert_int_equal(json_number(problem, "input", 0), 3);
    cJSON_Delete(problem);
    fake_say(&fake, &ben, "{\"type\":\"item.delete\",\"item\":\"%s\",\"version\":1}", id);
    assert_string_equal(refused(&ben), "409 /version");
    put(&ben, id, 0, "{\"text\":\"from Ben\"}", 3);
    assert_string_equal(refused(&ben), "422 /version");
    cJSON *row = last_row(&cem);
    assert_string_equal(json_text(cJSON_GetObjectItem(row, "body"), "text"), "from Ann");
    cJSON_Delete(row);
}

static void two_who_reply_at_once_both_keep_their_words(void **state)
{
    char reply[128], id[64];
    (void)state;
    enter();
    put(&ann, "", 0, edge, 1);
    (void)snprintf(id, sizeof id, "%s", last_id(&ann));
    (void)snprintf(reply, sizeof reply, "{\"text\":\"yes\",\"parent\":\"%s\"}", id);
    put(&ben, "", 0, reply, 2);
    (void)snprintf(reply, sizeof reply, "{\"text\":\"no\",\"parent\":\"%s\"}", id);
    put(&cem, "", 0, reply, 2);
    assert_int_equal(fake_n_heard(&ann, "problem") + fake_n_heard(&ben, "problem") + fake_n_heard(&cem, "problem"), 0);
    assert_int_equal(n_notes(), 3);
    char of_cem[64];
    (void)snprintf(of_cem, sizeof of_cem, "%s", last_id(&ann));
    /* a reply stays with its note, is none to a reply, and needs a note */
    put(&cem, of_cem, 1, "{\"text\":\"no\"}", 3);
    assert_string_equal(refused(&cem), "422 /body/parent");
    (void)snprintf(reply, sizeof reply, "{\"text\":\"why\",\"parent\":\"%s\"}", of_cem);
    put(&ben, "", 0, reply, 4);
    assert_string_equal(refused(&ben), "422 /body/parent");
    put(&ben, "", 0, "{\"text\":\"why\",\"parent\":\"i-0\"}", 5);
    assert_string_equal(refused(&ben), "422 /body/parent");
    /* with the note its replies go, and each is told */
    size_t before = fake_n_heard(&ben, "item");
    fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"%s\",\"input\":6}", id);
    assert_int_equal(n_notes(), 0);
    assert_int_equal(fake_n_heard(&ben, "item"), before + 3);
    assert_string_equal(last_id(&ben), id); /* the note itself comes last */
}

static void a_note_that_is_none_is_refused_with_its_place(void **state)
{
    static const char *const bad[][2] = {
        { "{}", "422 /body/text" },
        { "[]", "422 /body" },
        { "{\"text\":5}", "422 /body/text" },
        { "{\"text\":\" \\n\"}", "422 /body/text" },
        { "{\"text\":\"a\\u0007\"}", "422 /body/text" },
        { "{\"text\":\"a\",\"color\":\"red\"}", "422 /body/color" },
        { "{\"text\":\"a\",\"text\":\"b\"}", "422 /body/text" },
        { "{\"text\":\"a\",\"resolved\":1}", "422 /body/resolved" },
        { "{\"text\":\"a\",\"anchor\":5}", "422 /body/anchor" },
        { "{\"text\":\"a\",\"anchor\":{}}", "422 /body/anchor" },
        { "{\"text\":\"a\",\"anchor\":{\"region\":\"liver\"}}", "422 /body/anchor/region" },
        { "{\"text\":\"a\",\"anchor\":{\"region\":\"../x\"}}", "422 /body/anchor/region" },
        { "{\"text\":\"a\",\"anchor\":{\"point_mm\":[1,2]}}", "422 /body/anchor/point_mm" },
        { "{\"text\":\"a\",\"anchor\":{\"point_mm\":[1,2,100001]}}", "422 /body/anchor/point_mm" },
        { "{\"text\":\"a\",\"anchor\":{\"point_mm\":[1,2,\"3\"]}}", "422 /body/anchor/point_mm" },
        { "{\"text\":\"a\",\"mentions\":{}}", "422 /body/mentions" },
        { "{\"text\":\"a\",\"mentions\":[5]}", "422 /body/mentions/0" },
        { "{\"text\":\"a\",\"mentions\":[{\"member\":\"m1\",\"name\":\"Ann\"},{\"member\":\"m2\"}]}",
          "422 /body/mentions/1/name" },
        { "{\"text\":\"a\",\"mentions\":[{\"member\":\"M\",\"name\":\"Ann\"}]}", "422 /body/mentions/0/member" },
        { "{\"text\":\"a\",\"parent\":7}", "422 /body/parent" },
        { "{\"text\":\"a\",\"parent\":\"A\"}", "422 /body/parent" },
    };
    (void)state;
    enter();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        put(&ben, "", 0, bad[i][0], (unsigned)i + 1);
        assert_string_equal(refused(&ben), bad[i][1]);
    }
    assert_int_equal(n_notes(), 0);
    assert_int_equal(fake.n_kept, 0);
    put(&ben, "", 0, "{\"text\":\"about all\",\"anchor\":null}", 1);
    assert_int_equal(n_notes(), 1);
    fake_say(&fake, &ben, "{\"type\":\"item.put\",\"item\":\"%s\",\"version\":1,\"kind\":\"bookmark\",\"body\":{}}",
             last_id(&ben));
    assert_string_equal(refused(&ben), "422 /kind");
}

/* A note of n characters: at the limit it is taken, one more is refused. */
static void put_of_length(size_t n, const char *character)
{
    size_t bytes = strlen(character), at = 0;
    char *text = mem_new(n * bytes + 1);
    for (size_t i = 0; i < n; i++, at += bytes)
        memcpy(text + at, character, bytes);
    char *body = mem_new(n * bytes + 32);
    (void)snprintf(body, n * bytes + 32, "{\"text\":\"%s\"}", text);
    put(&ben, "", 0, body, 1);
    free(body);
    free(text);
}

static void limits_of_a_note_are_in_characters_and_of_mentions_in_number(void **state)
{
    char body[4096] = "{\"text\":\"a\",\"mentions\":[";
    (void)state;
    enter();
    put_of_length(NOTE_MAX_TEXT, "a");
    put_of_length(NOTE_MAX_TEXT, "\xf0\x9f\xa7\xa0"); /* four bytes each */
    assert_int_equal(n_notes(), 2);
    put_of_length(NOTE_MAX_TEXT + 1, "a");
    assert_string_equal(refused(&ben), "422 /body/text");
    for (int i = 0; i < NOTE_MAX_MENTIONS + 1; i++)
        (void)snprintf(body + strlen(body), sizeof body - strlen(body), "%s{\"member\":\"m%d\",\"name\":\"N\"}",
                       i ? "," : "", i + 1);
    (void)snprintf(body + strlen(body), sizeof body - strlen(body), "]}");
    put(&ben, "", 0, body, 1);
    assert_string_equal(refused(&ben), "422 /body/mentions");
}

static void a_room_keeps_a_limited_number_of_items_and_bytes(void **state)
{
    static char large[60001];
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    for (int i = 0; i < ROOM_MAX_ITEMS; i++) {
        char row[400];
        struct problem problem = { 0 };
        int n = snprintf(
            row, sizeof row,
            "{\"id\":\"i-%d\",\"kind\":\"note\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\","
            "\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1,\"body\":{\"text\":\"n\"}}",
            i);
        assert_true(room_restore_item(fake.room, row, (size_t)n, &problem));
    }
    put(&ann, "", 0, edge, 1);
    assert_string_equal(refused(&ann), "429 ");
    put(&ann, "i-7", 1, edge, 1); /* a change needs no further place */
    assert_int_equal(fake_n_heard(&ann, "item"), 1);
    for (int i = 0; i < ROOM_MAX_ITEMS; i++)
        fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"i-%d\"}", i);
    assert_int_equal(n_notes(), 0);
    memset(large, 'a', sizeof large - 1);
    int n_taken = 0;
    while (n_taken < 100 && fake_n_heard(&ann, "problem") == 1) {
        fake_say(&fake, &ann,
                 "{\"type\":\"item.put\",\"kind\":\"bookmark\",\"body\":{\"name\":\"n\",\"later\":\"%s\"}}", large);
        n_taken += fake_n_heard(&ann, "problem") == 1;
    }
    assert_int_equal(n_taken, ROOM_MAX_ITEMS_BYTES / (60000 + 500)); /* 500: about the rest of a row */
    assert_string_equal(refused(&ann), "429 ");
    fake_say(&fake, &ann,
             "{\"type\":\"item.put\",\"kind\":\"bookmark\",\"body\":{\"name\":\"n\",\"later\":\"%s%.3000s\"}}", large,
             large);
    assert_string_equal(refused(&ann), "413 /body");
}

static void what_is_kept_is_given_back_and_ids_are_not_given_twice(void **state)
{
    struct fake_room again;
    struct fake_page page = { 0 };
    struct problem problem = { 0 };
    (void)state;
    enter();
    put(&cem, "", 0, edge, 1);
    put(&ben, "", 0, "{\"text\":\"gone\"}", 1);
    fake_say(&fake, &ben, "{\"type\":\"item.delete\",\"item\":\"%s\"}", last_id(&ben));
    assert_int_equal(fake.n_kept, 3);
    assert_string_equal(fake.kept[2], "");
    fake_room_start(&again, 3);
    const char *row = fake.kept[0];
    assert_true(room_restore_item(again.room, row, strlen(row), &problem));
    assert_false(room_restore_item(again.room, row, strlen(row), &problem)); /* it is there already */
    assert_int_equal(again.n_kept, 0);
    cJSON *rows = room_items(again.room, WIRE_ITEM_KIND_NOTE);
    char *text = json_print(cJSON_GetArrayItem(rows, 0));
    assert_string_equal(text, row);
    free(text);
    cJSON_Delete(rows);
    fake_hello(&again, &page); /* the author was m3: the first who comes is another member */
    assert_string_equal(heard(&page, "welcome", "member"), "m4");
    fake_room_end(&again);
    fake_page_end(&page);
}

static void a_damaged_row_is_refused_and_leaves_nothing(void **state)
{
    static const char *const bad[] = {
        "",
        "null",
        "[]",
        "{}",
        "{\"id\":\"i-1\"",
        "{\"id\":\"i-1\",\"kind\":\"drawing\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1,\"body\":{\"text\":\"n\"}}",
        "{\"id\":\"i-1\",\"kind\":\"note\",\"version\":0,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1,\"body\":{\"text\":\"n\"}}",
        "{\"id\":\"I 1\",\"kind\":\"note\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1,\"body\":{\"text\":\"n\"}}",
        "{\"id\":\"i-12345678901234567890\",\"kind\":\"note\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1,\"body\":{\"text\":\"n\"}}",
        "{\"id\":\"i-1\",\"kind\":\"note\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":-1,\"changed_ms\":1,\"body\":{\"text\":\"n\"}}",
        "{\"id\":\"i-1\",\"kind\":\"note\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1,\"body\":{}}",
        "{\"id\":\"i-1\",\"kind\":\"note\",\"version\":1,\"author\":\"m1\",\"author_name\":\"A\",\"author_color\":\"#4a90d9\",\"changed_name\":\"A\",\"created_ms\":1,\"changed_ms\":1}",
    };
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct problem problem = { 0 };
        assert_false(room_restore_item(fake.room, bad[i], strlen(bad[i]), &problem));
        assert_true(problem.type != PROBLEM_NONE && problem.detail[0]);
    }
    assert_int_equal(n_notes(), 0);
}

static struct {
    int n;
    bool has_row, was_sent_before;
    enum problem_type problem;
    char author_name[64];
} answer; /* to the newest act */

static void act_done(void *context, const char *row, bool was_sent_before, const struct problem *problem)
{
    (void)context;
    cJSON *json = row ? json_read(row, strlen(row), NULL) : NULL;
    answer.n++;
    answer.has_row = row != NULL;
    answer.was_sent_before = was_sent_before;
    answer.problem = problem ? problem->type : PROBLEM_NONE;
    (void)snprintf(answer.author_name, sizeof answer.author_name, "%s", json ? json_text(json, "author_name") : "");
    cJSON_Delete(json);
}

static void act(const char *text, const char *key)
{
    struct message message;
    struct problem problem = { 0 };
    assert_true(message_read(text, strlen(text), true, &message, &problem));
    const struct room_act script = {
        .name = "Script", .address = "192.0.2.7", .key = key, .message = &message, .done = act_done
    };
    room_act(fake.room, &script, fake.now_us);
    message_finish(&message);
}

static uint64_t written;

static bool keep_later(void *context, struct room *room, uint64_t number, const struct room_item_write *write,
                       struct problem *problem)
{
    (void)context;
    (void)room;
    (void)problem;
    assert_string_equal(write->author, "");
    written = number;
    return true;
}

static void a_call_writes_as_a_message_does_and_is_answered_once_it_counts(void **state)
{
    static const char note[] = "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"Edge?\"}}";
    const struct problem full = { .type = PROBLEM_STORAGE };
    (void)state;
    enter();
    memset(&answer, 0, sizeof answer);
    act(note, "k-1");
    assert_int_equal(answer.n, 1);
    assert_true(answer.has_row && !answer.was_sent_before);
    assert_string_equal(answer.author_name, "Script");
    assert_string_equal(heard(&ann, "item", "by"), "");
    act(note, "k-1");
    assert_true(answer.has_row && answer.was_sent_before);
    assert_int_equal(n_notes(), 1);
    act("{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"Other\"}}", "k-1");
    assert_int_equal(answer.problem, PROBLEM_CONFLICT);
    act("{\"type\":\"control.take\"}", NULL);
    assert_int_equal(answer.problem, PROBLEM_FORBIDDEN);
    act("{\"type\":\"item.put\",\"kind\":\"signature\",\"body\":{}}", NULL);
    assert_int_equal(answer.problem, PROBLEM_FORBIDDEN);

    fake.room->callbacks.item_first = keep_later;
    answer.n = 0;
    act(note, "k-2");
    assert_int_equal(answer.n, 0); /* it is being written */
    act(note, "k-2");
    assert_int_equal(answer.n, 1);
    assert_int_equal(answer.problem, PROBLEM_BUSY);
    assert_int_equal(n_notes(), 1);
    room_item_written(fake.room, written, NULL, fake.now_us);
    assert_int_equal(answer.n, 2);
    assert_true(answer.has_row && answer.problem == PROBLEM_NONE);
    assert_int_equal(n_notes(), 2);
    act(note, "k-3");
    room_item_written(fake.room, written, &full, fake.now_us);
    assert_int_equal(answer.problem, PROBLEM_STORAGE);
    assert_int_equal(n_notes(), 2);
    act(note, "k-4"); /* and the room ends */
    assert_int_equal(answer.n, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_note_reaches_all_with_its_author_and_only_its_sender_gets_the_input),
        ROOM_TEST(only_its_author_and_who_has_the_role_of_presenter_change_a_note),
        ROOM_TEST(a_change_of_an_older_version_is_refused_and_nothing_is_lost),
        ROOM_TEST(two_who_reply_at_once_both_keep_their_words),
        ROOM_TEST(a_note_that_is_none_is_refused_with_its_place),
        ROOM_TEST(limits_of_a_note_are_in_characters_and_of_mentions_in_number),
        ROOM_TEST(a_room_keeps_a_limited_number_of_items_and_bytes),
        ROOM_TEST(what_is_kept_is_given_back_and_ids_are_not_given_twice),
        ROOM_TEST(a_damaged_row_is_refused_and_leaves_nothing),
        ROOM_TEST(a_call_writes_as_a_message_does_and_is_answered_once_it_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
