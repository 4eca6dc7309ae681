/* Records of decisions and signatures on disk: they are written with their item or not at all, outlive the room, and a
 * database of the version before, with a decision, a signature and a recording, gets them. The hashes were computed by
 * Python's hashlib. */
#include <sqlite3.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/store/verify.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/store_files.h"
#include "tests/unit/store_world.h"

static struct store_world world;

static int set_up(void **state)
{
    (void)state;
    store_world_begin(&world);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    store_world_end(&world);
    return 0;
}

/* The write of a decision with its record. */
static struct store_room *decision(const char *room_id, const char *id)
{
    struct store_room *room = mem_new(sizeof *room);
    *room = (struct store_room){ .is_prompt = true, .n_items = 1, .n_records = 1, .n_audit = 1 };
    (void)snprintf(room->id, sizeof room->id, "%s", room_id);
    (void)snprintf(room->plan, sizeof room->plan, "head");
    room->items = mem_array(1, sizeof room->items[0], 1 << 20, NULL);
    room->items[0] = (struct store_item){ .kind = "decision", .author = "m1", .version = 1 };
    (void)snprintf(room->items[0].id, sizeof room->items[0].id, "%s", id);
    room->items[0].body = mem_copy_text("{\"id\":\"i-1\"}");
    room->records = mem_array(1, sizeof room->records[0], 1 << 20, NULL);
    room->records[0] = (struct store_record){ .kind = "decision", .author_name = "Ann", .time_ms = 7 };
    memcpy(room->records[0].room, room->id, sizeof room->id);
    memcpy(room->records[0].id, room->items[0].id, sizeof room->items[0].id);
    room->records[0].item = mem_copy_text("{\"id\":\"i-1\"}");
    room->records[0].body = mem_copy_text("{\"scene\":1}");
    room->audit = mem_array(1, sizeof room->audit[0], 1 << 20, NULL);
    room->audit[0] = mem_copy_text("{\"time_ms\":1,\"action\":\"decision\"}");
    return room;
}

static void write(struct store_room *room, enum error_code expected)
{
    assert_true(store_write(world.store, room, 5));
    struct store_answer *answer = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(answer->error.code, expected);
    assert_int_equal(answer->n_audit, 1);
    store_answer_free(answer);
}

static void a_record_is_written_with_its_item_and_outlives_the_room(void **state)
{
    (void)state;
    write(decision("7q4k-m2wz", "i-1"), ERROR_NONE); /* of a room that was never written */
    struct store_room *room = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(room->n_items, 1);
    store_room_free(room);
    assert_true(store_delete(world.store, "7q4k-m2wz", 6));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM items"), 0);
    assert_true(store_read_records(world.store, "", "", 7));
    struct store_answer *list = store_world_await(&world, STORE_RECORDS);
    assert_int_equal(list->n_records, 1);
    assert_string_equal(list->records[0].id, "i-1");
    assert_null(list->records[0].body);
    store_answer_free(list);
    assert_true(store_read_records(world.store, "i-1", "", 8));
    struct store_answer *one = store_world_await(&world, STORE_RECORDS);
    assert_string_equal(one->records[0].body, "{\"scene\":1}");
    /* hashlib.sha256(b'{"scene":1}').hexdigest() */
    assert_string_equal(one->records[0].hash, "ed95557e5e74b2039de6c31045e8679922cee52b6f479ef762f61d919a8a15de");
    store_answer_free(one);
    assert_true(store_read_records(world.store, "i-2", "", 9));
    struct store_answer *none = store_world_await(&world, STORE_RECORDS);
    assert_int_equal(none->error.code, ERROR_NOT_FOUND);
    store_answer_free(none);
}

/* The second has the id of the first, which can never be written: neither its item nor its row for the audit is. */
static void what_cannot_be_written_leaves_nothing(void **state)
{
    (void)state;
    write(decision("7q4k-m2wz", "i-1"), ERROR_NONE);
    write(decision("7q4k-m2wz", "i-1"), ERROR_STATE);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM audit"), 1);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM records"), 1);
}

static void records_are_listed_from_the_newest_on(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        char id[16];
        (void)snprintf(id, sizeof id, "i-%d", i);
        write(decision("7q4k-m2wz", id), ERROR_NONE);
    }
    assert_true(store_read_records(world.store, "", "i-2", 7));
    struct store_answer *list = store_world_await(&world, STORE_RECORDS);
    assert_int_equal(list->n_records, 2);
    assert_string_equal(list->records[0].id, "i-1");
    assert_string_equal(list->records[1].id, "i-0");
    store_answer_free(list);
}

static const char *refusal(const char *sql)
{
    static char text[200];
    sqlite3 *db = NULL;
    char *message = NULL;
    assert_int_equal(sqlite3_open(world.path, &db), SQLITE_OK);
    (void)sqlite3_exec(db, sql, NULL, NULL, &message);
    (void)snprintf(text, sizeof text, "%s", message ? message : "");
    sqlite3_free(message);
    (void)sqlite3_close(db);
    return text;
}

/* Pictures come back by their place with one record alone, and are never changed. */
static void pictures_are_kept_with_their_record(void **state)
{
    (void)state;
    struct store_room *room = decision("7q4k-m2wz", "i-1");
    room->records[0].figures[0] = (struct store_figure){ (uint8_t *)mem_copy_text("axial"), 5 };
    room->records[0].figures[3] = (struct store_figure){ (uint8_t *)mem_copy_text("space"), 5 };
    write(room, ERROR_NONE);
    write(decision("7q4k-m2wz", "i-2"), ERROR_NONE);
    assert_true(store_delete(world.store, "7q4k-m2wz", 6));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    assert_true(store_read_records(world.store, "i-1", "", 7));
    struct store_answer *one = store_world_await(&world, STORE_RECORDS);
    assert_int_equal(one->records[0].figures[0].n_bytes, 5);
    assert_memory_equal(one->records[0].figures[0].bytes, "axial", 5);
    assert_null(one->records[0].figures[1].bytes);
    assert_memory_equal(one->records[0].figures[3].bytes, "space", 5);
    store_answer_free(one);
    assert_true(store_read_records(world.store, "i-2", "", 8));
    one = store_world_await(&world, STORE_RECORDS);
    assert_null(one->records[0].figures[0].bytes);
    store_answer_free(one);
    /* hashlib.sha256(b'axial').hexdigest() */
    assert_int_equal(store_file_number(world.path,
                                       "SELECT count(*) FROM record_figures WHERE place = 0 AND hash ="
                                       " '7671186edb83b48c9a9db7896d59e9f1a138d4949f60ab926593c0224df29328'"),
                     1);
    assert_string_equal(refusal("UPDATE record_figures SET bytes = x'00'"), "a record is never changed");
    assert_string_equal(refusal("DELETE FROM record_figures"), "a record is never deleted");
}

static void the_database_refuses_to_change_or_delete_a_record(void **state)
{
    (void)state;
    write(decision("7q4k-m2wz", "i-1"), ERROR_NONE);
    assert_string_equal(refusal("UPDATE records SET body = '{}'"), "a record is never changed");
    assert_string_equal(refusal("DELETE FROM records"), "a record is never deleted");
    assert_string_equal(refusal("UPDATE audit_head SET n = 0"), "the audit only grows");
    assert_string_equal(refusal("DELETE FROM audit_head"), "the audit is never deleted");
}

static struct store_answer *open_version_5(void)
{
    store_world_close(&world);
    folder_remove(world.folder);
    world.folder[0] = 0;
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, "tests/data/store/version5.sql");
    store_world_open(&world);
    return store_world_await(&world, STORE_OPENED);
}

/* The last of three parts is removed: the others are read, a time behind them is an error, and the check names it. */
static void a_recording_without_its_end_says_so(void **state)
{
    (void)state;
    struct audit_facts facts;
    struct error err = { 0 };
    store_answer_free(open_version_5());
    store_file_run(world.path, "DELETE FROM recording_batches WHERE place = 2");
    assert_true(store_read_part(world.store, "8nvg-ytgm", "rec-ecbd595060", 0, 8));
    struct store_answer *part = store_world_await(&world, STORE_PART);
    assert_int_equal(part->part->n, 2);
    assert_int_equal(part->part->next_ms, 101); /* the second part begins at 100 ms */
    store_answer_free(part);
    assert_true(store_read_part(world.store, "8nvg-ytgm", "rec-ecbd595060", 1500, 9));
    part = store_world_await(&world, STORE_PART);
    assert_null(part->part);
    assert_string_equal(part->error.text, "what was recorded after 100 ms is missing, up to the next whole state");
    store_answer_free(part);
    assert_false(store_verify_audit(world.path, NULL, &facts, &err));
    assert_string_equal(err.text,
                        "recording rec-ecbd595060 of room 8nvg-ytgm has 2 of its 3 parts: the others were removed");
}

static void a_database_of_version_5_keeps_its_recording_and_gets_records(void **state)
{
    (void)state;
    struct store_answer *opened = open_version_5();
    assert_int_equal(opened->n_rooms, 1);
    assert_int_equal(opened->audit_n, 7);
    store_answer_free(opened);
    assert_int_equal(store_file_number(world.path, "SELECT n FROM audit_head"), 7);
    assert_true(store_read_records(world.store, "", "", 7));
    struct store_answer *list = store_world_await(&world, STORE_RECORDS);
    assert_int_equal(list->n_records, 2);
    assert_string_equal(list->records[0].kind, "signature");
    assert_string_equal(list->records[1].kind, "decision");
    assert_string_equal(list->records[1].plan, "phantom");
    store_answer_free(list);
    assert_true(store_read_part(world.store, "8nvg-ytgm", "rec-ecbd595060", 0, 8));
    struct store_answer *part = store_world_await(&world, STORE_PART);
    assert_non_null(part->part);
    assert_int_equal(part->part->n, 3);
    store_answer_free(part);
    write(decision("8nvg-ytgm", "i-1"), ERROR_NONE);
    assert_int_equal(store_file_number(world.path, "SELECT n FROM audit_head"), 8);
}

int main(void)
{
    log_start("test_store_records", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_record_is_written_with_its_item_and_outlives_the_room),
        TEST(what_cannot_be_written_leaves_nothing),
        TEST(records_are_listed_from_the_newest_on),
        TEST(pictures_are_kept_with_their_record),
        TEST(the_database_refuses_to_change_or_delete_a_record),
        TEST(a_recording_without_its_end_says_so),
        TEST(a_database_of_version_5_keeps_its_recording_and_gets_records),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
