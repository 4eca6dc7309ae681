/* The audit on disk: its chain, what a tampered one says, that SQLite refuses changes, rows without a room and beside a
 * room that cannot be written. The hashes were computed by Python's hashlib:
 *   h = '0' * 64; for text in texts: h = hashlib.sha256((h + text).encode()).hexdigest() */
#include <sqlite3.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/store/verify.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/store_files.h"
#include "tests/unit/store_world.h"

static struct store_world world;

static const char *const rows[] = {
    "{\"time_ms\":1767225600000,\"room\":\"7q4k-m2wz\",\"action\":\"open\"}",
    "{\"time_ms\":1767225601000,\"room\":\"7q4k-m2wz\",\"action\":\"export\",\"detail\":{\"what\":\"snapshot\"}}",
    "{\"time_ms\":1767225602000,\"room\":\"aaaa-bbbb\",\"action\":\"open\",\"name\":\"Özlem\"}",
};
static const char *const hashes[] = {
    "72c59cca8f469fe638d796fb8ce90b0c48419ddc46926a31d0020515984b0cf2",
    "48a80153dc55ea901c66d1e1d8f85006bf5aa22cf49fbab58a784ff9316251c1",
    "43a959deac40d343607df0476f6c634d6b10f70d86ed5ec8e9db9a07dfd31f9f",
};

static void add_audit(struct store_room *room, size_t first, size_t n)
{
    room->audit = mem_array(n, sizeof room->audit[0], 100, NULL);
    for (size_t i = 0; i < n; i++)
        room->audit[room->n_audit++] = mem_copy_text(rows[first + i]);
}

/* Two rows with a room, and one without. */
static int set_up(void **state)
{
    (void)state;
    world = (struct store_world){ 0 };
    store_world_open(&world);
    struct store_answer *answer = store_world_await(&world, STORE_OPENED);
    assert_int_equal(answer->audit_n, 0);
    assert_int_equal(strspn(answer->audit_hash, "0"), 64);
    store_answer_free(answer);
    struct store_room *room = store_made_room("7q4k-m2wz", 1, 10, 1), *none = mem_new(sizeof *none);
    add_audit(room, 0, 2);
    add_audit(none, 2, 1);
    assert_true(store_write(world.store, room, 1));
    answer = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(answer->n_audit, 2);
    assert_int_equal(answer->audit_n, 2);
    assert_string_equal(answer->audit_hash, hashes[1]);
    store_answer_free(answer);
    assert_true(store_write(world.store, none, 2));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    store_world_end(&world);
    return 0;
}

static void rows_are_a_chain_of_hashes(void **state)
{
    (void)state;
    struct audit_facts facts;
    struct error err = { 0 };
    assert_true(store_verify_audit(world.path, NULL, &facts, &err)); /* while the store has it open */
    assert_int_equal(facts.n_rows, 3);
    assert_int_equal(facts.first_ms, 1767225600000);
    assert_int_equal(facts.last_ms, 1767225602000);
    assert_string_equal(facts.head, hashes[2]);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM rooms"), 1);
    for (size_t i = 0; i < 3; i++)
        assert_true(store_verify_audit(world.path, hashes[i], &facts, &err));
    store_world_close(&world);
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->audit_n, 3);
    assert_string_equal(opened->audit_hash, hashes[2]);
    store_answer_free(opened);
}

static void a_room_that_cannot_be_written_leaves_its_rows(void **state)
{
    (void)state;
    struct audit_facts facts;
    struct error err = { 0 };
    struct store_room *twice = store_made_room("aaaa-bbbb", 1, 10, 2);
    memcpy(twice->members[1].id, twice->members[0].id, sizeof twice->members[0].id);
    add_audit(twice, 0, 1);
    assert_true(store_write(world.store, twice, 3));
    struct store_answer *answer = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(answer->error.code, ERROR_STATE);
    assert_int_equal(answer->n_audit, 1);
    assert_int_equal(answer->audit_n, 4);
    store_answer_free(answer);
    assert_null(store_world_read(&world, "aaaa-bbbb"));
    assert_true(store_verify_audit(world.path, NULL, &facts, &err));
    assert_int_equal(facts.n_rows, 4);
}

static void a_deleted_room_leaves_its_rows(void **state)
{
    (void)state;
    assert_true(store_delete(world.store, "7q4k-m2wz", 3));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM rooms"), 0);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM audit"), 3);
}

/* SQLite's message for a statement. */
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

static void the_database_refuses_changes_and_deletion(void **state)
{
    (void)state;
    assert_string_equal(refusal("UPDATE audit SET row = '{}' WHERE n = 2"), "the audit is never changed");
    assert_string_equal(refusal("DELETE FROM audit WHERE n = 3"), "the audit is never deleted");
    assert_string_equal(refusal("INSERT OR REPLACE INTO audit VALUES(2, '{}', '')"),
                        "rows of the audit are added at its end");
    assert_string_equal(refusal("INSERT INTO audit VALUES(9, '{}', '')"), "rows of the audit are added at its end");
}

/* The check's message after the database was changed behind its back; head as in store_verify_audit. */
static const char *after(const char *sql, const char *head)
{
    static struct error err;
    struct audit_facts facts;
    store_world_close(&world);
    store_file_run(world.path, "DROP TRIGGER audit_update; DROP TRIGGER audit_delete; DROP TRIGGER audit_order");
    store_file_run(world.path, sql);
    err = (struct error){ 0 };
    const bool is_good = store_verify_audit(world.path, head, &facts, &err);
    assert_true(is_good == (err.code == ERROR_NONE));
    return err.text;
}

static void a_changed_row_is_named(void **state)
{
    (void)state;
    const char *said = after("UPDATE audit SET row = replace(row, 'snapshot', 'surfaces') WHERE n = 2", NULL);
    assert_non_null(strstr(said, "row 2 does not fit"));
    assert_non_null(strstr(said, hashes[1]));
}

static void a_row_removed_in_the_middle_is_named(void **state)
{
    (void)state;
    assert_string_equal(after("DELETE FROM audit WHERE n = 2", NULL), "row 2 is missing: row 3 follows row 1");
}

static void a_removed_row_whose_gap_was_closed_is_named(void **state)
{
    (void)state;
    assert_string_equal(after("DELETE FROM audit WHERE n = 2; UPDATE audit SET n = 2 WHERE n = 3", NULL),
                        "row 2 has the text of row 3: the order was changed");
}

static void the_first_row_removed_is_named(void **state)
{
    (void)state;
    assert_string_equal(after("DELETE FROM audit WHERE n = 1", NULL), "row 1 is missing: row 2 follows row 0");
}

static void a_changed_order_is_named(void **state)
{
    (void)state;
    assert_string_equal(after("UPDATE audit SET n = -n; UPDATE audit SET n = 5 + n WHERE n < -1;"
                              " UPDATE audit SET n = 1 WHERE n = -1",
                              NULL),
                        "row 2 has the text of row 3: the order was changed");
}

static void a_rewritten_hash_is_named(void **state)
{
    (void)state;
    const char *said = after("UPDATE audit SET hash = replace(hash, '4', '5') WHERE n = 2", NULL);
    assert_non_null(strstr(said, "row 2 does not fit"));
}

static void a_row_rewritten_with_a_hash_that_fits_breaks_the_next(void **state)
{
    (void)state;
    /* hashlib.sha256((hashes[0] + '{"n":2,"time_ms":1767225601000,"room":"7q4k-m2wz"}').encode()).hexdigest() */
    const char *said =
        after("UPDATE audit SET row = '{\"n\":2,\"time_ms\":1767225601000,\"room\":\"7q4k-m2wz\"}', hash ="
              " '525c5cf1077f81d96aa0f4e5cff8ebb661802d9b37f2ce7595c40dc8e49a05fc' WHERE n = 2",
              NULL);
    assert_non_null(strstr(said, "row 3 does not fit"));
}

/* The newest row stands in the database itself; who removes that, too, is told by the file beside it; who removes both,
 * by a hash that was given away. */
static void a_cut_tail_is_found_without_a_hash(void **state)
{
    (void)state;
    char beside[320];
    struct audit_facts facts;
    struct error err = { 0 };
    assert_string_equal(after("DELETE FROM audit WHERE n = 3", NULL), "rows 3 to 3 were removed at the end");
    store_file_run(world.path,
                   "DROP TRIGGER audit_head_order; UPDATE audit_head SET n = 2, hash = (SELECT hash FROM audit"
                   " WHERE n = 2)");
    assert_false(store_verify_audit(world.path, NULL, &facts, &err));
    assert_string_equal(err.text, "rows 3 to 3 were removed at the end: the file beside the database knows them");
    (void)snprintf(beside, sizeof beside, "%s-audit", world.path);
    assert_int_equal(remove(beside), 0);
    err = (struct error){ 0 };
    assert_true(store_verify_audit(world.path, NULL, &facts, &err));
    assert_true(store_verify_audit(world.path, hashes[1], &facts, &err));
    assert_false(store_verify_audit(world.path, hashes[2], &facts, &err));
    assert_non_null(strstr(err.text, "none of the 2 rows has the hash given"));
}

static void an_emptied_or_removed_audit_is_named(void **state)
{
    (void)state;
    struct audit_facts facts;
    struct error err = { 0 };
    assert_string_equal(after("DELETE FROM audit", NULL), "rows 1 to 3 were removed at the end");
    store_file_run(world.path, "DROP TABLE audit_head");
    assert_false(store_verify_audit(world.path, NULL, &facts, &err));
    assert_non_null(strstr(err.text, "(audit_head) were removed"));
    store_file_run(world.path, "DROP TABLE audit");
    err = (struct error){ 0 };
    assert_false(store_verify_audit(world.path, NULL, &facts, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_string_equal(err.text, "the table of the audit was removed");
}

/* A daemon that starts with such a database goes on, and the loss itself is a row. */
static void a_lost_end_is_recorded_when_the_database_is_opened(void **state)
{
    (void)state;
    (void)after(
        "DELETE FROM audit WHERE n = 3; DROP TRIGGER audit_head_order; UPDATE audit_head SET n = 2, hash = (SELECT"
        " hash FROM audit WHERE n = 2)",
        NULL);
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->audit_n, 3);
    store_answer_free(opened);
    assert_int_equal(store_file_number(world.path,
                                       "SELECT row LIKE '%\"action\":\"head-missing\"%\"rows\":3%' FROM audit"
                                       " WHERE n = 3"),
                     1);
    struct audit_facts facts;
    struct error err = { 0 };
    assert_true(store_verify_audit(world.path, NULL, &facts, &err));
}

static void a_database_of_the_version_before_gets_an_audit(void **state)
{
    (void)state;
    struct audit_facts facts;
    struct error err = { 0 };
    store_world_close(&world);
    folder_remove(world.folder);
    world.folder[0] = 0;
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, "tests/data/store/version3.sql");
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->n_rooms, 2);
    assert_int_equal(opened->audit_n, 0);
    store_answer_free(opened);
    struct store_room *room = store_made_room("7q4k-m2wz", 43, 10, 1);
    add_audit(room, 0, 3);
    store_world_write(&world, room);
    assert_true(store_verify_audit(world.path, hashes[2], &facts, &err));
    assert_int_equal(facts.n_rows, 3);
    struct store_room *other = store_world_read(&world, "aaaa-bbbb");
    assert_string_equal(other->plan, "neck");
    store_room_free(other);
}

static void a_database_without_audit_or_none_is_said(void **state)
{
    (void)state;
    struct audit_facts facts;
    struct error err = { 0 };
    store_world_close(&world);
    folder_remove(world.folder);
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, "tests/data/store/version3.sql");
    assert_false(store_verify_audit(world.path, NULL, &facts, &err));
    assert_non_null(strstr(err.text, "the database has no audit"));
    assert_false(store_verify_audit("/nowhere/at.db", NULL, &facts, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
}

int main(void)
{
    log_start("test_store_audit", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(rows_are_a_chain_of_hashes),
        TEST(a_room_that_cannot_be_written_leaves_its_rows),
        TEST(a_deleted_room_leaves_its_rows),
        TEST(the_database_refuses_changes_and_deletion),
        TEST(a_changed_row_is_named),
        TEST(a_row_removed_in_the_middle_is_named),
        TEST(a_removed_row_whose_gap_was_closed_is_named),
        TEST(the_first_row_removed_is_named),
        TEST(a_changed_order_is_named),
        TEST(a_rewritten_hash_is_named),
        TEST(a_row_rewritten_with_a_hash_that_fits_breaks_the_next),
        TEST(a_cut_tail_is_found_without_a_hash),
        TEST(an_emptied_or_removed_audit_is_named),
        TEST(a_lost_end_is_recorded_when_the_database_is_opened),
        TEST(a_database_of_the_version_before_gets_an_audit),
        TEST(a_database_without_audit_or_none_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
